"""Jobs: moves from a scene file (TOML) or a table (CSV), in SI units."""

from __future__ import annotations

import csv
import math
import tomllib
import zlib
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

from .errors import TrirrrError
from .messages import NAME_CAPACITY, Command, JobLabel, Move, OutputSwitch, QuinticMove
from .numbers import Pose
from .postcard import U32, Numbers, dumps

#: A duration may be this far from a whole number of ticks, for it is written in decimals.
_TOLERANCE_TICKS = 1e-6

Vector = tuple[float, float, float]
_REST: Vector = (0.0, 0.0, 0.0)


#: Relative difference of values that a machine has taken into its units and back.
_ROUNDING = 1e-9


class JobError(TrirrrError, ValueError):
    """The file is no job; file, place and reason."""


@dataclass(frozen=True)
class Body:
    """A platform with a tool on it. Vectors are from the tool point, and that from the reference point of the bare platform."""

    mass_kg: float
    inertia_kgm2: float
    com_m: tuple[float, float]
    tool_point_m: tuple[float, float]

    def is_near(self, other: Any) -> bool:
        """True if ``other`` is the same body, but for what a machine's units round."""

        def values(of: Any) -> list[float]:
            return [of.mass_kg, of.inertia_kgm2, *of.com_m, *of.tool_point_m]

        return all(abs(a - b) <= _ROUNDING * max(abs(a), abs(b), 1e-3) for a, b in zip(values(self), values(other)))


@dataclass(frozen=True)
class Step:
    """One move in SI units. ``duration_s`` ``None``: at constant acceleration along its line."""

    start: Vector
    end: Vector
    start_velocity: Vector
    end_velocity: Vector
    duration_s: float | None
    power: float = 0.0
    speed_m_s: float = 0.0
    place: str = ""
    #: At both ends of a quintic, (ax, ay, alphaddot); ``None`` for a cubic.
    accelerations: tuple[Vector, Vector] | None = None
    #: Spare outputs that go on and off in the tick in which the move begins, a bit for each.
    switched: tuple[int, int] = (0, 0)

    def ticks(self, rate_hz: float) -> int:
        """Duration in ticks. ``JobError`` where it is no whole number."""
        if self.duration_s is None:
            return self._ticks_at_constant_acceleration(rate_hz)
        exact = self.duration_s * rate_hz
        whole = round(exact)
        if whole < 1 or abs(exact - whole) > _TOLERANCE_TICKS:
            raise JobError(f"{self.place}: duration of {exact!r} ticks at {rate_hz:g} Hz, must be whole")
        return whole

    def _ticks_at_constant_acceleration(self, rate_hz: float) -> int:
        way = [b - a for a, b in zip(self.start, self.end)]
        velocity = [a + b for a, b in zip(self.start_velocity, self.end_velocity)]
        # In the plane; a move that only turns, by its angle.
        parts = (0, 1) if way[0] or way[1] else (2,)
        squared = sum(way[part] ** 2 for part in parts)
        along = sum(way[part] * velocity[part] for part in parts)
        if not squared or along <= 0:
            raise JobError(f"{self.place}: needs a duration")
        return max(1, math.ceil(2 * squared / along * rate_hz - _TOLERANCE_TICKS))


@dataclass(frozen=True)
class Job:
    """What to play, and on which machine."""

    steps: list[Step]
    #: Key of the scene, 0 for any.
    scene: int = 0
    #: Name of the machine's number type, where the file says it.
    number: str | None = None
    #: The machine computes torques; a table does not say.
    torque: bool = True
    #: Geometry of the legs where the file has it: the parsed ``[[machine.leg]]`` tables.
    legs: list[dict[str, Any]] = field(default_factory=list)
    #: Name that the machine tells to whoever asks what it plays.
    name: str = ""
    #: The platform with each tool of the scene, by the tool's name, and the tool that the job is for; nothing of a scene without tools.
    tools: dict[str, Body] = field(default_factory=dict)
    mounted: str | None = None

    def label(self, moves: list[Any], numbers: Numbers) -> Any:
        """What the machine keeps of the job that consists of ``moves``."""
        check = 0
        for move in moves:
            kind = Move if isinstance(move, Move.record) else QuinticMove
            check = zlib.crc32(dumps(kind, move, numbers), check)
        for index, (on, off) in enumerate(step.switched for step in self.steps):
            if on or off:
                data = dumps(U32, check, numbers) + dumps(U32, index, numbers) + bytes((on, off))
                check = zlib.crc32(data)
        name = self.name.encode("ascii", "replace")[:NAME_CAPACITY].ljust(NAME_CAPACITY, b"\0")
        return JobLabel(name=tuple(name), items=len(moves), check=check)

    def moves(self, identity: Any) -> list[Any]:
        """The moves for the machine that ``identity`` describes, numbered from 0: ``Move`` or ``QuinticMove``."""
        length, time = identity.length_m, identity.time_s

        def pose(values: Vector) -> Pose:
            return Pose(values[0] / length, values[1] / length, values[2])

        def velocity(values: Vector) -> Vector:
            speed = length / time
            return (values[0] / speed, values[1] / speed, values[2] * time)

        def acceleration(values: Vector) -> Vector:
            linear = length / time**2
            return (values[0] / linear, values[1] / linear, values[2] * time**2)

        def move(number: int, step: Step) -> Any:
            common = Move(
                number=number,
                from_=pose(step.start),
                to=pose(step.end),
                start_velocity=velocity(step.start_velocity),
                end_velocity=velocity(step.end_velocity),
                ticks=step.ticks(identity.tick_rate_hz),
                tool_power=step.power,
                tool_speed=step.speed_m_s * time / length,
            )
            if step.accelerations is None:
                return common
            start, end = map(acceleration, step.accelerations)
            return QuinticMove(common=common, start_acceleration=start, end_acceleration=end)

        return [move(number, step) for number, step in enumerate(self.steps)]


def common(move: Any) -> Any:
    """The part of ``move`` that a quintic has in common with a cubic."""
    return getattr(move, "common", move)


def offer(move: Any, number: int) -> Any:
    """The command that offers ``move`` under ``number``."""
    if hasattr(move, "common"):
        return Command.Quintic(replace(move, common=replace(move.common, number=number)))
    return Command.Move(replace(move, number=number))


def switch(step: Step, number: int) -> Any:
    """The command that lets the spare outputs of ``step`` change as the move ``number`` begins; ``None`` where none do."""
    on, off = step.switched
    return Command.OutputsAt(OutputSwitch(number=number, on=on, off=off)) if on or off else None


def read(path: str, moves: str | None = None) -> Job:
    """The job in a scene file (``.toml``) or a table (``.csv``). ``moves`` is the table of a scene's job along a
    path. ``JobError`` says what is wrong."""
    data = _bytes(path)
    if not path.endswith(".csv"):
        return _from_scene(path, data, moves)
    if moves is not None:
        raise JobError(f"{path}: a table of moves itself: `moves` goes with a scene")
    return _from_table(path, data)


def pins(path: str) -> tuple[list[str], list[str]]:
    """Names of the spare outputs and inputs in a scene file, in their order. ``JobError`` says what is wrong."""
    try:
        io = tomllib.loads(_bytes(path).decode()).get("io", {})
        outputs, inputs = ([str(each["name"]) for each in io.get(key, [])] for key in ("outputs", "inputs"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise JobError(f"{path}: {error}") from None
    except (KeyError, TypeError, AttributeError) as error:
        raise JobError(f"{path}: io: {error}") from None
    return outputs, inputs


def _bytes(path: str) -> bytes:
    try:
        return Path(path).read_bytes()
    except OSError as error:
        raise JobError(f"{path}: {error.strerror}") from None


def scene_key(text: bytes) -> int:
    """Key of a scene file: FNV-1a, 32 bits, never 0."""
    key = 0x811C_9DC5
    for byte in text:
        key = (key ^ byte) * 0x0100_0193 % (1 << 32)
    return key or 1


def _from_scene(path: str, data: bytes, moves: str | None) -> Job:
    try:
        scene = tomllib.loads(data.decode())
        if isinstance(scene.get("machine"), str):
            # The machine stands in a file beside the scene, whose values go before those of the machine.
            file = Path(path).parent / scene.pop("machine")
            machine = _bytes(str(file))
            data += b"" if data.endswith(b"\n") else b"\n"
            data += machine
            taken = tomllib.loads(machine.decode())
            own = ("name", "description", "job")
            scene = {**{key: taken[key] for key in taken if key not in own}, **scene}
        job = scene["job"]
        start = _pose(job["start"])
        is_path = job.get("timing") == "shortest"
        if is_path and moves is None:
            raise JobError(f"{path}: a job along a path: give the moves.csv that `trirrr plan` writes as `moves`")
        if moves is not None and not is_path:
            raise JobError(f"{path}: the job has moves of its own: `moves` goes with a job along a path")
        if is_path and any("outputs" in each for each in job.get("path", [])):
            raise JobError(f"{path}: outputs change along its path, and a table of moves has none: `trirrr stream` plays it")
        outputs = [str(each["name"]) for each in scene.get("io", {}).get("outputs", [])]
        steps = _from_table(moves, _bytes(moves)).steps if moves is not None else []
        velocity = acceleration = _REST
        for index, each in enumerate([] if is_path else job["move"], 1):
            end = _pose(each["to"])
            end_velocity = _vector(each.get("end_velocity", {}), "vx_m_s", "vy_m_s", "valpha_rad_s")
            accelerations: tuple[Vector, Vector] | None = None
            if each.get("curve", "cubic") == "quintic":
                given = each.get("end_acceleration", {})
                accelerations = (acceleration, _vector(given, "ax_m_s2", "ay_m_s2", "aalpha_rad_s2"))
            duration = each.get("duration_s")
            tool = each.get("tool")
            steps.append(
                Step(
                    start,
                    end,
                    velocity,
                    end_velocity,
                    None if duration is None else float(duration),
                    float(tool["power"]) if tool else 0.0,
                    float(tool.get("speed_m_s", 0.0)) if tool else 0.0,
                    f"{path}: job.move[{index}]",
                    accelerations,
                    _switched(f"{path}: job.move[{index}]", each.get("outputs", {}), outputs),
                )
            )
            start, velocity = end, end_velocity
            acceleration = accelerations[1] if accelerations else _REST
        tools, mounted = _tools(scene)
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise JobError(f"{path}: {error}") from None
    except KeyError as error:
        raise JobError(f"{path}: {error.args[0]} is missing in the job") from None
    except JobError:
        raise
    except (TypeError, AttributeError, ValueError) as error:
        raise JobError(f"{path}: job: {error}") from None
    legs = scene.get("machine", {}).get("leg", [])
    torque = bool(scene.get("torque", True))
    return Job(
        steps, scene_key(data), scene.get("number", "f64"), torque, legs, scene.get("name", ""), tools, mounted
    )


def _switched(place: str, given: dict[str, Any], outputs: list[str]) -> tuple[int, int]:
    """Bits of the outputs that ``given`` switches on, and of those that it switches off."""
    bits = [0, 0]
    for name, on in given.items():
        if name not in outputs:
            raise JobError(f"{place}.outputs.{name}: the scene has no such spare output; its outputs are {', '.join(outputs) or 'none'}")
        if not isinstance(on, bool):
            raise JobError(f"{place}.outputs.{name} = {on!r}: expected true or false")
        bits[0 if on else 1] |= 1 << outputs.index(name)
    return bits[0], bits[1]


def _tools(scene: dict[str, Any]) -> tuple[dict[str, Body], str | None]:
    """The platform of a scene with each of its ``[[tools]]``, and the name of the tool that is mounted."""
    given = scene.get("tools", [])
    if not given:
        return {}, None
    platform = scene["platform"]
    bare = (_number(platform, "mass_kg"), _number(platform, "inertia_kgm2"), _pair(platform, "com_m", (0.0, 0.0)))
    tools = {str(tool["name"]): _carrying(bare, tool) for tool in given}
    return tools, str(scene.get("mounted", given[0]["name"]))


def _carrying(bare: tuple[float, float, tuple[float, float]], tool: dict[str, Any]) -> Body:
    """The platform ``bare`` and a tool on it as one body, about the tool point."""
    point = _pair(tool, "point_m", (0.0, 0.0))
    parts = [bare, (_number(tool, "mass_kg"), _number(tool, "inertia_kgm2", 0.0), _pair(tool, "com_m", point))]
    mass = sum(part[0] for part in parts)
    # Bodies without a mass have no centre of their own.
    x, y = ((sum(part[0] * part[2][axis] for part in parts) / mass if mass else bare[2][axis]) for axis in (0, 1))
    inertia = sum(own + part * ((cx - x) ** 2 + (cy - y) ** 2) for part, own, (cx, cy) in parts)
    return Body(mass, inertia if mass else bare[1], (x - point[0], y - point[1]), point)


#: Ends of keys with a unit of SI, of the same in another unit, and the value of the other one in SI.
_UNITS: tuple[tuple[str, str, Callable[[float], float]], ...] = (
    ("_rad_s", "_rpm", lambda rate: rate * math.pi / 30),
    ("_rad", "_deg", math.radians),
    ("_m", "_mm", lambda length: length / 1000),
)


def _number(table: dict[str, Any], key: str, default: float | None = None) -> float:
    """The value of ``key`` in SI units, under this name or that in another unit. ``KeyError`` where there is none and no default."""
    for end, other, convert in _UNITS:
        name = key.removesuffix(end) + other
        if key.endswith(end) and name in table:
            if key in table:
                raise ValueError(f"{key} and {name} are both given")
            return float(convert(float(table[name])))
    return float(table[key] if default is None else table.get(key, default))


def _pair(table: dict[str, Any], key: str, default: tuple[float, float]) -> tuple[float, float]:
    """Two numbers in SI units, as ``_number``."""
    names = [name for name in (key, key.removesuffix("_m") + "_mm") if name in table]
    if not names:
        return default
    x, y = (_number({names[0]: value}, key) for value in table[names[0]])
    return (x, y)


def _vector(table: dict[str, Any], *keys: str) -> Vector:
    """Three values, 0 where they are left out."""
    a, b, c = (_number(table, key, 0.0) for key in keys)
    return (a, b, c)


def _pose(table: dict[str, Any]) -> Vector:
    return (_number(table, "x_m"), _number(table, "y_m"), _number(table, "alpha_rad"))


#: Columns of a table: end pose, then duration, then what is 0 where it is left out.
_NEEDED = ("x", "y", "alpha", "duration")
_OPTIONAL = ("vx", "vy", "valpha", "power", "speed")
#: With these the moves are quintics.
_QUINTIC = ("ax", "ay", "aalpha")
#: For readers only: the piece of a path that a move belongs to.
_IGNORED = ("piece",)


def _from_table(path: str, data: bytes) -> Job:
    try:
        rows = csv.DictReader(data.decode().splitlines())
    except UnicodeDecodeError as error:
        raise JobError(f"{path}: {error}") from None
    names = rows.fieldnames or []
    unknown = [name for name in names if name not in _NEEDED + _OPTIONAL + _QUINTIC + _IGNORED]
    is_quintic = any(name in names for name in _QUINTIC)
    missing = [name for name in _NEEDED if name not in names]
    if missing or unknown:
        hint = "; separate columns by commas, and write decimal points" if ";" in "".join(names) else ""
        raise JobError(f"{path}: columns missing: {missing}, unknown: {unknown}{hint}")
    steps: list[Step] = []
    before: tuple[Vector, Vector, Vector] | None = None
    for row in rows:
        place = f"{path}: line {rows.line_num}"

        def number(name: str) -> float:
            text = row.get(name) or ("" if name in _NEEDED else "0")
            try:
                value = float(text)
            except ValueError:
                raise JobError(f"{place}: {name} = {text!r} is no number") from None
            if not math.isfinite(value):
                raise JobError(f"{place}: {name} = {text} is not finite")
            return value

        end = (number("x"), number("y"), number("alpha"))
        velocity = (number("vx"), number("vy"), number("valpha"))
        acceleration = (number("ax"), number("ay"), number("aalpha"))
        duration = number("duration")
        if before is None:
            if duration != 0 or velocity != _REST or acceleration != _REST:
                raise JobError(f"{place}: the first row is where the machine stands: duration 0, at rest")
        else:
            start, start_velocity, start_acceleration = before
            accelerations = (start_acceleration, acceleration) if is_quintic else None
            steps.append(
                Step(
                    start,
                    end,
                    start_velocity,
                    velocity,
                    duration,
                    number("power"),
                    number("speed"),
                    place,
                    accelerations,
                )
            )
        before = (end, velocity, acceleration)
    if not steps:
        raise JobError(f"{path}: a job needs a start and at least one move")
    if steps[-1].end_velocity != _REST:
        raise JobError(f"{steps[-1].place}: the last move must end at rest")
    return Job(steps)
