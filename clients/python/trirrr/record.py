"""Telemetry as a table in the columns of ``ticks.csv``, SI units."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

from . import kinematics, postcard
from .postcard import Numbers, Value

#: The columns that ``trirrr run`` writes.
COLUMNS = (
    ["t", "x", "y", "alpha", "vx", "vy", "valpha", "ax", "ay", "aalpha"]
    + [f"{name}_{leg}" for name in ("th1", "dth1", "ddth1") for leg in (1, 2, 3)]
    + [f"{name}{leg}" for name in ("tau", "P") for leg in (1, 2, 3)]
    + ["detA"]
    + [f"{name}_{leg}" for name in ("th2", "dth2", "ddth2") for leg in (1, 2, 3)]
    + [f"{name}{leg}" for name in ("D", "serial") for leg in (1, 2, 3)]
    + ["parallel", "tool"]
)

#: Columns that the table of a machine without torques does not have.
_DYNAMIC = {f"{name}{leg}" for name in ("tau", "P") for leg in (1, 2, 3)}

#: States in which a sample belongs to a job.
_OF_A_JOB = {"Running", "Slowing", "Stopping", "Holding"}


def columns(torque: bool) -> list[str]:
    """Columns of the table of a machine that computes torques, or of one that does not."""
    return [name for name in COLUMNS if torque or name not in _DYNAMIC]


def as_columns(rows: list[list[float]], torque: bool) -> dict[str, list[float]]:
    """The columns of ``rows`` by name."""
    return {name: [row[COLUMNS.index(name)] for row in rows] for name in columns(torque)}


class Recorder:
    """Collects the samples of one job."""

    def __init__(self) -> None:
        self.samples: list[Any] = []

    def hear(self, message: Value) -> None:
        """Takes a message; keeps it if it is a sample of the job."""
        if message.name == "Telemetry" and message.content.state.name in _OF_A_JOB:
            self.samples.append(message.content)

    @property
    def missing(self) -> int:
        """Samples of the job that did not arrive, if one was asked for every tick."""
        ticks = [sample.tick for sample in self.samples]
        return sum((later - earlier) % (1 << 32) - 1 for earlier, later in zip(ticks, ticks[1:]))

    def rows(self, identity: Any, legs: list[Any], numbers: Numbers) -> list[list[float]]:
        """One row per sample. ``legs``: the scene's sections ``Leg``."""
        if not self.samples:
            return []
        first = self.samples[0]
        start = first.tick - first.at
        return [_row(sample, start, identity, legs, numbers) for sample in self.samples]

    def write(self, path: str, rows: list[list[float]], torque: bool) -> None:
        """Writes ``rows`` under their names; every number reads back as itself."""
        names = columns(torque)
        kept = [COLUMNS.index(name) for name in names]
        with Path(path).open("w", newline="") as file:
            writer = csv.writer(file, lineterminator="\n")
            writer.writerow(names)
            writer.writerows([repr(row[index]) for index in kept] for row in rows)


def _row(sample: Any, start: int, identity: Any, legs: list[Any], numbers: Numbers) -> list[float]:
    length, time, mass = identity.length_m, identity.time_s, identity.mass_kg
    rate = 1 / time
    torque = mass * (length * rate) * (length * rate)

    def rounded(value: float) -> float:
        """As the machine computes it."""
        data = postcard.dumps(numbers.number, value, numbers)
        return float(postcard.loads(numbers.number, data, numbers))

    def scaled(values: Any, linear: float, angular: float) -> list[float]:
        return [values[0] * linear, values[1] * linear, values[2] * angular]

    pose = scaled(sample.setpoint.pose, length, 1.0)
    velocity = scaled(sample.setpoint.velocity, length * rate, rate)
    acceleration = scaled(sample.setpoint.acceleration, length * rate * rate, rate * rate)
    angles = list(sample.angles)
    rates = [value * rate for value in sample.rates]
    accelerations = [value * (rate * rate) for value in sample.accelerations]
    torques = [value * torque for value in sample.torques]
    powers = [
        rounded(motor * turning) * (torque * rate)
        for motor, turning in zip(sample.torques, sample.rates)
    ]
    closure = kinematics.close(legs, pose, velocity, acceleration, angles, rates, accelerations)
    of_legs = [
        [getattr(leg, name) for leg in closure.legs]
        for name in ("angle", "rate", "acceleration", "cross", "serial")
    ]
    return [
        (sample.tick - start) % (1 << 32) / identity.tick_rate_hz,
        *pose,
        *velocity,
        *acceleration,
        *angles,
        *rates,
        *accelerations,
        *torques,
        *powers,
        closure.det_a,
        *(value for group in of_legs for value in group),
        closure.parallel,
        sample.tool,
    ]
