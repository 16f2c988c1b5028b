"""What telemetry does not carry: the distal links, det A, the distances to both singularities.

Everything follows from the platform's motion and the motors' angles by closing each leg's triangle;
no inverse kinematics is solved.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Distal:
    """The distal link of one leg: angle, rate, acceleration; r1 x r2; serial distance."""

    angle: float
    rate: float
    acceleration: float
    cross: float
    serial: float


@dataclass(frozen=True)
class Closure:
    """The three distal links, det A and the parallel distance."""

    legs: tuple[Distal, Distal, Distal]
    det_a: float
    parallel: float


def _cross(a: Sequence[float], b: Sequence[float]) -> float:
    return a[0] * b[1] - a[1] * b[0]


def close(
    legs: list[Any],
    pose: Sequence[float],
    velocity: Sequence[float],
    acceleration: Sequence[float],
    angles: Sequence[float],
    rates: Sequence[float],
    accelerations: Sequence[float],
) -> Closure:
    """Closes the legs (sections ``Leg`` of the scene), everything in SI."""
    x, y, alpha = pose
    vx, vy, spin = velocity
    ax, ay, spin_rate = acceleration
    distal, joints, links = [], [], []
    for leg, th, dth, ddth in zip(legs, angles, rates, accelerations):
        # Platform joint C from the reference point, and r1 = A -> B.
        direction = alpha + leg.joint_angle_rad
        c = (leg.joint_radius_m * math.cos(direction), leg.joint_radius_m * math.sin(direction))
        r1 = (leg.proximal_m * math.cos(th), leg.proximal_m * math.sin(th))
        r2 = (x + c[0] - leg.base_m[0] - r1[0], y + c[1] - leg.base_m[1] - r1[1])
        v = (vx - spin * c[1] + dth * r1[1], vy + spin * c[0] - dth * r1[0])
        a = (
            ax - spin_rate * c[1] - spin**2 * c[0] + ddth * r1[1] + dth**2 * r1[0],
            ay + spin_rate * c[0] - spin**2 * c[1] - ddth * r1[0] + dth**2 * r1[1],
        )
        squared = leg.distal_m**2
        cross = _cross(r1, r2)
        distal.append(
            Distal(
                math.atan2(r2[1], r2[0]),
                _cross(r2, v) / squared,
                _cross(r2, a) / squared,
                cross,
                abs(cross) / (leg.proximal_m * leg.distal_m),
            )
        )
        joints.append(c)
        links.append(r2)
    # Rows [r2x, r2y, c x r2].
    m = [_cross(c, r2) for c, r2 in zip(joints, links)]
    det_a = sum(m[i] * _cross(links[(i + 1) % 3], links[(i + 2) % 3]) for i in range(3))
    half_perimeter = sum(math.dist(joints[i], joints[i - 1]) for i in range(3)) / 2
    greatest = half_perimeter * math.prod(leg.distal_m for leg in legs)
    parallel = abs(det_a) / greatest if greatest > 0 else 0.0
    one, two, three = distal
    return Closure((one, two, three), det_a, parallel)
