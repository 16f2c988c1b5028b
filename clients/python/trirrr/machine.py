"""The machine of a scene: kinematics, torques, verdicts, plans and runs, over arrays.

Poses are x, y in m and alpha in rad. Velocities and accelerations are their derivatives by time. Arrays have the shape (..., 3):
a single state (3,), states (n, 3), a grid (rows, columns, 3). Results have the same leading shape. All numbers are SI units.
"""

from __future__ import annotations

import os
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from .board import Carried
from .errors import MotionError, PlanError, Problem, SceneError
from .table import Array, Table

try:
    from ._native import NativeMachine
except ImportError as error:
    raise ImportError(
        "the native core of trirrr is not built: pip install ./clients/python, with Rust from https://rustup.rs"
    ) from error

Triple = tuple[float, float, float]

#: What becomes of states without a motion: an exception, or NaN in their place.
Invalid = Literal["raise", "nan"]

_REST: Triple = (0.0, 0.0, 0.0)


def scene_values(file: str, settings: list[str]) -> tuple[str | None, int, bytes, bytes]:
    """The scene in ``file``, with ``settings`` in place of its values, as it goes over the line of a board.

    The board that the scene names, its key, its ``SceneHeader`` as it is sent, and its values. ``SceneError`` says what is wrong with it.
    """
    return NativeMachine(file, None, settings).values()


class Motors(NamedTuple):
    """Motion of the three motors, each of shape (..., 3)."""

    #: Directions of the proximal links in (-pi, pi], rad.
    angles: Array
    #: rad/s.
    rates: Array
    #: rad/s^2.
    accelerations: Array
    #: N m, counter-clockwise positive.
    torques: Array


class Distances(NamedTuple):
    """Distances from the singularities, from 0 to 1."""

    #: Of each leg from being stretched or folded, shape (..., 3).
    serial: Array
    #: Of the platform from being loose, shape (...).
    parallel: Array


class Assemblies(NamedTuple):
    """All poses that fit motor angles, sorted by alpha. At most six; the places of the others are NaN."""

    #: Shape (..., 6, 3).
    poses: Array
    #: Distance of each pose from the parallel singularity, shape (..., 6).
    parallel: Array
    #: Signs of the elbows, +1 or -1, shape (..., 6, 3); 0 for a leg that is straight, and where there is no pose.
    elbows: NDArray[np.int8]
    #: Number of poses, shape (...).
    counts: NDArray[np.int64]
    #: True if the list is known to hold all poses, shape (...).
    complete: NDArray[np.bool_]


@dataclass(frozen=True)
class Leg:
    """Geometry of a leg, in m and rad."""

    base_m: tuple[float, float]
    proximal_m: float
    distal_m: float
    joint_radius_m: float
    joint_angle_rad: float


@dataclass(frozen=True)
class Verdict:
    """Verdict of the machine's service on a move. True if the move is admitted."""

    #: Reason of a refusal, with place, value and limit; ``None`` of a move that is admitted.
    reason: str | None
    #: Duration that is proven to be long enough, if one was found, s.
    enough_s: float | None

    def __bool__(self) -> bool:
        return self.reason is None


class Setpoints(NamedTuple):
    """Setpoints of a job, one a tick."""

    #: Shape (n,), s.
    t: Array
    #: Shape (n, 3), as the two others.
    poses: Array
    velocities: Array
    accelerations: Array


@dataclass(frozen=True)
class Plan:
    """Least-time plan of a path."""

    #: Duration of the moves, in whole ticks, s.
    duration_s: float
    #: Duration of the plan that the moves follow, s.
    planned_s: float
    #: No motion along the path within the limits is faster, s.
    lower_bound_s: float
    #: The state at the end of each move, after a row for the start: ``moves.csv`` of ``trirrr plan``.
    moves: Table


@dataclass(frozen=True)
class Run:
    """A job that was played."""

    #: Reason why the job or its plant did not come to the end; ``None`` of a run that is complete.
    reason: str | None
    #: One row a tick: ``ticks.csv`` of ``trirrr run``.
    ticks: Table
    #: ``plant.csv`` of ``trirrr run``; ``None`` without a plant.
    plant: Table | None
    #: Doubts about the simulation of the plant.
    warnings: tuple[str, ...]

    @property
    def is_complete(self) -> bool:
        """True if the job, and the plant if there is one, came to the end."""
        return self.reason is None


class Machine:
    """The machine of a scene, with the loads, limits and job of the scene."""

    def __init__(self, native: NativeMachine) -> None:
        self._native = native
        facts = native.facts()
        #: Name of the scene.
        self.name: str = facts["name"]
        #: Description in the words of the author.
        self.description: str = facts["description"]
        #: Key by which a board and a host know that they have the same scene.
        self.key: int = facts["key"]
        #: Number type of the machine: f64, f32, fixed or micromath. Arrays are computed in f64.
        self.number: str = facts["number"]
        #: True if the scene computes torques.
        self.has_torques: bool = facts["torque"]
        #: True if the scene describes a plant.
        self.has_plant: bool = facts["has_plant"]
        #: True if the job is a path, whose moves were planned.
        self.has_path: bool = facts["has_path"]
        self.tick_rate_hz: float = facts["tick_rate_hz"]
        #: Pose at the start of the job.
        self.start: Triple = tuple(facts["start"])
        #: Working mode: signs of the elbows, +1 to the left of the line from base to platform joint.
        self.elbows: tuple[int, int, int] = tuple(facts["elbows"])
        #: Number of moves of the job, and its duration.
        self.move_count: int = facts["moves"]
        self.duration_s: float = facts["duration_s"]
        #: Sentence on limits that the scene lacks, or ``None``.
        self.warning: str | None = facts["warning"]
        self.legs: tuple[Leg, ...] = tuple(
            Leg((base[0], base[1]), lengths[0], lengths[1], radius, angle)
            for base, lengths, radius, angle in facts["legs"]
        )

        #: Platform with each tool of the scene, by the tool's name, for ``Board.mount``.
        self.tools: dict[str, Carried] = {
            name: Carried(mass, inertia, (com[0], com[1]), (point[0], point[1]))
            for name, (mass, inertia, (com, point)) in facts["tools"].items()
        }

    @classmethod
    def from_scene(cls, path: str | os.PathLike[str], settings: Sequence[str] = ()) -> Machine:
        """Reads and checks the scene in the file ``path``.

        ``settings`` such as ``"limits.rate_rad_s=3"`` replace values of the file. ``SceneError`` has everything that is wrong.
        """
        return cls(NativeMachine(os.fspath(path), None, list(settings)))

    @classmethod
    def from_text(
        cls, text: str, file: str = "scene.toml", settings: Sequence[str] = ()
    ) -> Machine:
        """Reads and checks the scene in ``text``. ``file`` is named in errors, and a machine file is looked for beside it."""
        return cls(NativeMachine(file, text, list(settings)))

    def __repr__(self) -> str:
        return f"<Machine of scene {self.name}: {self.move_count} moves, {self.duration_s} s>"

    def motors(
        self,
        pose: ArrayLike,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        *,
        invalid: Invalid = "raise",
    ) -> Motors:
        """Angles, rates, accelerations and torques of the motors, all at once. Without ``velocity`` and ``acceleration``: at rest.

        ``MotionError`` names states that are out of reach or singular; with ``invalid="nan"`` their rows are NaN. ``ValueError`` of a
        scene that computes no torques.
        """
        if not self.has_torques:
            raise ValueError(f"scene {self.name} computes no torques: it says torque = false")
        return self._motors(pose, velocity, acceleration, True, invalid)

    def torques(
        self,
        pose: ArrayLike,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        *,
        invalid: Invalid = "raise",
    ) -> Array:
        """Torques of the motors, N m, counter-clockwise positive. See ``motors``."""
        return self.motors(pose, velocity, acceleration, invalid=invalid).torques

    def angles(self, pose: ArrayLike, *, invalid: Invalid = "raise") -> Array:
        """Inverse kinematics: angles of the motors in (-pi, pi], rad. See ``motors``."""
        return self._motors(pose, None, None, False, invalid).angles

    def rates(self, pose: ArrayLike, velocity: ArrayLike, *, invalid: Invalid = "raise") -> Array:
        """Rates of the motors, rad/s. See ``motors``."""
        return self._motors(pose, velocity, None, False, invalid).rates

    def accelerations(
        self,
        pose: ArrayLike,
        velocity: ArrayLike,
        acceleration: ArrayLike,
        *,
        invalid: Invalid = "raise",
    ) -> Array:
        """Accelerations of the motors, rad/s^2. See ``motors``."""
        return self._motors(pose, velocity, acceleration, False, invalid).accelerations

    def distances(self, pose: ArrayLike, *, invalid: Invalid = "raise") -> Distances:
        """Distances from both kinds of singularity, 0 at the singularity, at most 1."""
        (rows,), shape = _states(pose)
        found, failed = self._native.distances(rows)
        _refuse(failed, shape, invalid)
        return Distances(found[:, :3].reshape(*shape, 3), found[:, 3].reshape(shape))

    def reactions(
        self,
        pose: ArrayLike,
        velocity: ArrayLike | None = None,
        acceleration: ArrayLike | None = None,
        *,
        invalid: Invalid = "raise",
    ) -> Array:
        """Forces in the nine joints, N, shape (..., 3, 3, 2): leg; joint A, B, C; x, y in the fixed frame.

        Each acts on the outer of the two bodies: at A the base pulls at the proximal link, at B the proximal at the distal link, at C
        the distal link at the platform. Without friction.
        """
        (poses, velocities, accelerations), shape = _states(pose, velocity, acceleration)
        found, failed = self._native.reactions(poses, velocities, accelerations)
        _refuse(failed, shape, invalid)
        return found.reshape(*shape, 3, 3, 2)

    def forward(self, angles: ArrayLike, *, invalid: Invalid = "raise") -> Assemblies:
        """Forward kinematics: all poses that fit the motor angles. Angles that fit no pose have a count of 0.

        ``MotionError`` of angles at which infinitely many poses fit.
        """
        (rows,), shape = _states(angles)
        poses, parallel, elbows, counts, complete, failed = self._native.forward(rows)
        _refuse(failed, shape, invalid)
        return Assemblies(
            poses.reshape(*shape, 6, 3),
            parallel.reshape(*shape, 6),
            elbows.reshape(*shape, 6, 3),
            counts.reshape(shape),
            complete.reshape(shape),
        )

    def working_modes(self, pose: Triple) -> dict[tuple[int, int, int], Triple]:
        """The motor angles of all eight working modes at ``pose``, by the signs of the elbows."""
        found = self._native.working_modes(pose)
        return {(a, b, c): (angles[0], angles[1], angles[2]) for (a, b, c), angles in found}

    def admit(
        self,
        to: Triple,
        duration_s: float,
        *,
        start: Triple | None = None,
        start_velocity: Triple = _REST,
        end_velocity: Triple = _REST,
        accelerations: tuple[Triple, Triple] | None = None,
    ) -> Verdict:
        """The verdict of the machine's service on a move: every instant is proven to keep the limits, or the move is refused.

        ``start``: pose at the start of the move, that of the job if left out. ``accelerations`` at both ends make the move a quintic;
        without them it is a cubic. The duration is rounded to whole ticks.
        """
        poses = (self.start if start is None else start, to)
        velocities = (start_velocity, end_velocity)
        return Verdict(*self._native.admit(poses, velocities, accelerations, duration_s))

    def setpoints(self) -> Setpoints:
        """The setpoints of the job, one a tick, as ideal motion: arguments for ``motors``."""
        t, (poses, velocities, accelerations) = self._native.setpoints()
        return Setpoints(t, poses, velocities, accelerations)

    def plan(self, gap: float | None = None) -> Plan:
        """Plans the path of the job in the least time. ``gap``: greatest part by which the plan may take longer than its lower bound;
        that of ``trirrr plan`` if left out.

        ``PlanError`` of a job without a path, or of a path that the machine cannot follow.
        """
        if gap is not None and not 1e-5 <= gap <= 1.0:
            raise ValueError(f"gap = {gap}: expected a number from 0.00001 to 1")
        found = self._native.plan(gap)
        moves = Table(found["columns"], found["moves"])
        return Plan(found["duration_s"], found["planned_s"], found["lower_bound_s"], moves)

    def run(self, plant: bool | None = None) -> Run:
        """Plays the job on the machine's service in this process, as fast as the computer can.

        ``plant``: simulate the real machine that follows; if left out, wherever the scene describes one. ``Run.reason`` says why a
        run is not complete.
        """
        if plant and not self.has_plant:
            raise ValueError(f"scene {self.name} has no plant: add [plant], or leave plant out")
        found = self._native.run(self.has_plant if plant is None else plant)
        rows = found.get("plant")
        return Run(
            reason=found["reason"] or found.get("plant_reason"),
            ticks=Table(found["columns"], found["ticks"]),
            plant=None if rows is None else Table(found["plant_columns"], rows),
            warnings=tuple(found.get("plant_warnings", ())),
        )

    def _motors(
        self,
        pose: ArrayLike,
        velocity: ArrayLike | None,
        acceleration: ArrayLike | None,
        torque: bool,
        invalid: Invalid,
    ) -> Motors:
        (poses, velocities, accelerations), shape = _states(pose, velocity, acceleration)
        found, failed = self._native.motors(poses, velocities, accelerations, torque)
        _refuse(failed, shape, invalid)
        return Motors(*(each.reshape(*shape, 3) for each in found))


def check(path: str | os.PathLike[str], settings: Sequence[str] = ()) -> list[Problem]:
    """Everything that is wrong with the scene in ``path``, as ``trirrr check`` says it; empty of a good scene.

    ``SceneError`` of a file that cannot be read.
    """
    try:
        Machine.from_scene(path, settings)
    except SceneError as error:
        if not error.problems:
            raise
        return error.problems
    return []


def _states(*parts: ArrayLike | None) -> tuple[list[Array], tuple[int, ...]]:
    """Contiguous arrays of shape (n, 3) of ``parts``, which broadcast; zeros for those that are left out. And the leading shape."""
    given = [np.asarray(part, dtype=np.float64) for part in parts if part is not None]
    for part in given:
        if part.ndim == 0 or part.shape[-1] != 3:
            raise ValueError(f"expected an array of shape (..., 3), found {part.shape}")
    shape = np.broadcast_shapes(*(part.shape for part in given))
    each = iter(given)
    full = [np.zeros(shape) if part is None else np.broadcast_to(next(each), shape) for part in parts]
    return [np.ascontiguousarray(part).reshape(-1, 3) for part in full], shape[:-1]


def _refuse(failed: list[tuple[int, str]], shape: tuple[int, ...], invalid: Invalid) -> None:
    """``MotionError`` where a state has no motion, unless NaN is asked for."""
    if invalid not in ("raise", "nan"):
        raise ValueError(f"invalid = {invalid!r}: expected 'raise' or 'nan'")
    if not failed or invalid == "nan":
        return
    row, reason = failed[0]
    if not shape:
        raise MotionError(reason, failed)
    place = ", ".join(str(int(index)) for index in np.unravel_index(row, shape))
    count = int(np.prod(shape))
    raise MotionError(
        f"{len(failed)} of {count} states have no motion; state [{place}]: {reason}. "
        "invalid='nan' puts NaN in their place",
        failed,
    )


__all__ = [
    "Assemblies",
    "Distances",
    "Leg",
    "Machine",
    "MotionError",
    "Motors",
    "Plan",
    "PlanError",
    "Problem",
    "Run",
    "SceneError",
    "Setpoints",
    "Verdict",
    "check",
]
