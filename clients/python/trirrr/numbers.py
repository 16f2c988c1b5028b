"""Number types of machines, and poses and setpoints in them."""

from __future__ import annotations

import math
from typing import NamedTuple

from .postcard import ANGLE, F32, F64, I32, I64, N, Numbers, Scaled, Tuple, array


class Pose(NamedTuple):
    """Place and angle of the platform."""

    x: float
    y: float
    alpha: float


class Setpoint(NamedTuple):
    """Pose, velocity (vx, vy, alphadot) and acceleration."""

    pose: Pose
    velocity: tuple[float, float, float]
    acceleration: tuple[float, float, float]


POSE = Tuple("Pose", [N, N, ANGLE], Pose._make)
SETPOINT = Tuple("Setpoint", [POSE, array(N, 3), array(N, 3)], Setpoint._make)

#: Every kind of machine, by the name of its number type in scenes.
NUMBERS = {
    "f64": Numbers("f64", F64, F64),
    "f32": Numbers("f32", F32, F32),
    "micromath": Numbers("micromath", Scaled("Coarse", F32), Scaled("Coarse", F32)),
    "fixed": Numbers(
        "fixed",
        Scaled("Fixed", I32, 2.0**-29),
        Scaled("Turns", I64, math.tau / 2**32),
    ),
}
