"""Faults and violations in words and SI units."""

from __future__ import annotations

from typing import Any

#: What is bounded, of which part (counted from 1), and the powers of the machine's units of
#: length, time and mass that its values are in, with the SI unit.
_BOUNDED = {
    "Reach": ("span", "leg", (1, 0, 0), " m"),
    "SerialDistance": ("distance from the serial singularity", "leg", (0, 0, 0), ""),
    "ParallelDistance": ("distance from the parallel singularity", "leg", (0, 0, 0), ""),
    "Rate": ("rate", "motor", (0, -1, 0), " rad/s"),
    "Acceleration": ("acceleration", "motor", (0, -2, 0), " rad/s^2"),
    "Torque": ("torque", "motor", (2, -2, 1), " N m"),
    "Power": ("power", "motor", (2, -3, 1), " W"),
    "Range": ("range of the number type", "leg", (0, 0, 0), ""),
    "Jerk": ("jerk", "motor", (0, -3, 0), " rad/s^3"),
    "AccelerationJump": ("jump of the acceleration", "motor", (0, -2, 0), " rad/s^2"),
}

_CODES = {
    "Unreachable": "leg {number} is out of reach",
    "SerialSingular": "leg {number} is stretched or folded",
    "ParallelSingular": "parallel singular: the torques are not defined",
    "OutOfRange": "a result was out of the range of the number type",
    "Overrun": "a tick took {value:.4g} of its period",
    "Board": "the board reports its code {value:.4g}",
    # Angles are radians in any units.
    "HomingNotFound": "homing: motor {number} has not found its switch or stop within {limit:.4g} rad",
    "HomingNotReleased": "homing: the switch of motor {number} is still closed {limit:.4g} rad back from it",
    "HomingClosedAtStart": "homing: the switch of motor {number} was closed at the start, and is still "
    "closed {limit:.4g} rad away",
    "FollowingError": "joint {number} is {value:.4g} rad from its command, the most allowed is {limit:.4g} rad",
    # A machine that detects contacts computes in SI units.
    "Contact": "contact: a force of {value:.4g} N at the tool, the most allowed is {limit:.4g} N",
    "ContactMoment": "contact: a moment of {value:.4g} N m at the tool, the most allowed is {limit:.4g} N m",
    "EmergencyStop": "the emergency stop was pressed, or its wire is broken: release it, then acknowledge the fault",
    "LimitSwitch": "motor {number} has reached its limit switch, or the wire of that is broken: acknowledge the fault, then a "
    "recovery leads off it",
}

_NOT_ENABLED = {
    "Drive": "drive {number} is {state}, its code is {error}",
    "Moves": "joint {number} moved by {value:.4g} rad, the most allowed is {limit:.4g} rad",
    "NoPose": "the joints stand at no pose of the scene: move the platform by hand, or look at zero_rad of the drives",
    "ManyPoses": "the joints stand at more than one pose of the scene: move the platform towards its start",
    "Singular": "too near to a singularity: {value:.4g}, the least allowed is {limit:.4g}",
    "Restarted": "restarted or silent while the machine stayed on: {drives}; {joints}, or whole turns of the rotor elsewhere. "
    "Compare with the machine. Where the angles are true, acknowledge them by ClearFault (clear_fault(), --recover); else turn the "
    "joints there by hand with the drives off, and restart the board at the start of the job",
}

_DRIVE = {
    "StepRate": "drive {number} would have to step {value:.4g} times as fast as it can",
    "Range": "a command to drive {number} is beyond what its frames can hold",
    "BusBusy": "the bus did not carry the command to drive {number} in a tick",
    "BusOff": "the bus failed: too many errors on it",
    "Reported": "drive {number} reports its code {value:.4g}",
    "Silent": "drive {number} was silent for {value:.4g} of its timeout",
    "NotOn": "drive {number} is not on, though it should be",
    "Stalled": "drive {number} signals that its motor stalls",
    "Restarted": "drive {number} has restarted, and may have lost turns of its rotor",
}


_REFUSED = {
    "HelloFirst": "the machine has had no hello since it was switched on",
    "Protocol": "the machine speaks version {expected} of the protocol, this client another",
    "Schema": "the machine's messages have another layout (schema key {expected:#010x}): it was built for another number "
    "type, or from another version",
    "Scene": "the machine was built for another scene (key {expected:#010x}); name the scene that it has",
    "Sequence": "the machine expects request number {expected}: has it two clients?",
    "SequenceReused": "the request's number was used for another command: has the machine two clients?",
    "NothingQueued": "no move is queued",
    "Undecided": "a queued move is not admitted yet",
    "EndsMoving": "the queued moves end before the machine could come to rest on them",
    "QueueFull": "the queue is full",
    "MoveNumber": "the machine expects move number {expected}: has it two clients?",
    "NotFinite": "a value is infinite or not a number",
    "Duration": "its duration is not 1 to {longest} ticks",
    "StartPose": "it does not start where the last one ends, or where the machine stands",
    "StartVelocity": "it does not start as fast as the last one ends",
    "StartAcceleration": "it does not start with the acceleration that the last one ends with",
    "Tool": "the tool's power is not from 0 to 1, or its speed negative",
    "NotAdjustable": "the machine's image holds no code to change its scene",
    "NoSuchLeg": "there is no such leg",
    "NotInImage": "the machine's image holds no code for such links, loads or such a centre of mass",
    "NoPose": "with the new geometry, no pose fits the motors' angles",
    "Busy": "the machine's tick has not taken the commands before this one",
    "NoHoming": "the scene has no [homing]: the machine knows where its motors are",
    "NoQuintics": "the machine's image holds no code for quintic moves",
    "FeedOverride": "a feed override is 1 to 100 percent",
    "Retargeting": "the machine is still planning the last retarget",
    "NoPaths": "the machine's image plans no paths: set plans_paths in [service] of its scene, or send moves",
    "PathUnderWay": "the machine plans a path: wait for its end, or stop, before other moves",
    "Feed": "the feed of a piece is negative",
    "NoFeedback": "the drives of the machine's scene tell nothing",
    "NoBatches": "the machine's image takes no batches of moves: set batches in [service] of its scene",
    "Check": "the moves of the batch do not start where the last one ends: has the machine two clients?",
    "EmergencyStop": "the emergency stop is pressed, or its wire is broken: release it before the fault is acknowledged",
    "DoorOpen": "the door is open: nothing moves before it is closed",
    "NoProbe": "the machine's scene names no probe: [inputs.probe] would",
    "ProbeTouches": "the probe touches before the run",
    "ProbeOpen": "the probe does not touch before the run, which is to lead away",
    "NoOutput": "the machine's scene names {outputs} spare outputs: [[io.outputs]] names them, the first has number 0",
    "OutputsFull": "the machine has no room for more changes of outputs with moves yet",
    "LimitSwitch": "motor {number} stands on its limit switch: only a recovery or homing moves the machine off it",
    "NoUpdate": "the machine's program cannot be replaced over the line: a simulator has no flash; a board needs update = true "
    "in [service] of its scene, its boot loader, and to be flashed with a probe once",
    "Recovery": "the way there would break a limit",
}


_UPDATE = {
    "Board": "the image is for another board: build it with the board that the machine tells, BOARD=NAME cargo fw",
    "Chip": "the image is for another chip: build it with the board that the machine tells, BOARD=NAME cargo fw",
    "Start": "the image does not begin at {expected:#010x}: build it from a scene with update = true in [service]",
    "Length": "the image is longer than {longest} bytes, or empty",
    "NotBegun": "no image was begun: send it again",
    "Block": "the bytes are not those that follow ({expected} are there): has the board two clients?",
    "Checksum": "the image in the flash has the checksum {found:#010x} and not its own: send it again",
    "Flash": "the flash cannot be written at {place:#x} (status {status:#x}): send the image again; if that fails, too, the flash is "
    "worn out",
    "JournalFull": "the journal of updates has no room: restart the board, and send the image again",
    "NoScene": "the board's image takes no scene over the line: build one with scene_over_line = true in [service], and send it by "
    "Board.update",
    "SceneLayout": "the board does not read the values of the scene: send them by the package of the version that it runs, or "
    "update its program",
    "SceneStart": "the machine of the scene cannot stand at the start of its job: change [job] start or the machine",
}

_NEEDS = {
    "Torques": "torques (torque is not false)",
    "PayloadOffset": "a centre of mass off the reference point (com_m in [platform])",
    "Rotors": "rotor inertia (rotor_inertia_kgm2, or that of [[drive]])",
    "LinkMasses": "masses of links (proximal and distal in [[machine.leg]])",
    "Gravity": "gravity in the plane (gravity_m_s2, mounted)",
    "Quintics": "quintic moves (accelerations in [[job.move]], a path, plans_paths)",
    "Jerk": "a limit of jerk (jerk_rad_s3 in [limits])",
    "Paths": "a planner of paths (plans_paths in [service])",
    "Batches": "batches of moves (batches in [service], short or planned moves)",
    "PowerLists": "room for so many levels of power (power_lists in [service])",
    "Number": "its number type (number)",
    "TickRate": "its tick rate (tick_rate_hz)",
    "Drives": "its drives (kind and constants of [[drive]], but steps and gears of steppers)",
    "Brake": "its brake (brake in [power], there or not)",
    "ToolOutput": "its output to the tool ([tool])",
    "Inputs": "its inputs, or spare inputs and outputs ([inputs], [io])",
    "Lamp": "its status lamp (there or not)",
    "Homing": "its kind of homing ([homing], there or not, kind and level of its switches)",
    "Feedback": "feedback of the drives ([feedback], there or not)",
    "Contact": "detection of contacts ([contact], there or not, with a retreat or without)",
}

_INPUTS = {
    "emergency_stop": {"Clear": "emergency stop released", "Active": "emergency stop pressed, or its wire broken"},
    "door": {"Clear": "door closed", "Active": "door open"},
    "probe": {"Clear": "probe open", "Active": "probe touches"},
}


def inputs(found: Any) -> str | None:
    """The inputs; ``None`` of a scene that names none."""
    parts = [words[state.name] for name, words in _INPUTS.items() if (state := getattr(found, name)).name in words]
    limits = [state.name for state in found.limits]
    reached = [str(motor) for motor, state in enumerate(limits, 1) if state == "Active"]
    if reached:
        parts.append(f"motor {', '.join(reached)} on its limit switch")
    elif "Clear" in limits:
        parts.append("no motor on its limit switch")
    return "; ".join(parts) or None


def update(name: str, fields: Any = None) -> str:
    """Why a step of an update was not taken, and what to do."""
    return _UPDATE[name].format(**(fields or {}))


def scene_need(name: str) -> str:
    """A part of a scene that an image may lack, and where the scene has it."""
    return _NEEDS[name]


def refusal(found: Any) -> str:
    """Why a command was refused."""
    content = found.content
    if found.name == "Update":
        return _update(content)
    if found.name == "State":
        return f"not while the machine is {content.name.lower()}"
    if found.name == "Parameter":
        fields = _fields(content)
        leg = "" if fields["leg"] is None else f" of leg {fields['leg'] + 1}"
        return f"{fields['quantity'].name}{leg} cannot be built"
    text = _REFUSED.get(found.name)
    # A machine of a later version may know more refusals.
    if text is None:
        return str(found)
    fields = {name: getattr(content, name) for name in ("expected", "longest", "outputs") if hasattr(content, name)}
    if found.name == "LimitSwitch":
        fields["number"] = content.motor + 1
    return text.format(**fields)


def _update(found: Any) -> str:
    if found.name == "SceneNeeds":
        return f"the board's image lacks what the scene needs: {scene_need(found.content.name)}"
    fields = {} if found.content is None else dict(_fields(found.content))
    if found.name == "SceneValue":
        leg = "" if fields["leg"] is None else f" of leg {fields['leg'] + 1}"
        return f"the board cannot build the scene: {fields['quantity'].name}{leg}"
    return update(found.name, fields)


def _fields(content: Any) -> Any:
    """Names and values of what a refusal has with it."""
    return content._asdict() if hasattr(content, "_asdict") else vars(content)


def fault(found: Any, identity: Any) -> str:
    """A latched fault of the machine that ``identity`` describes."""
    number = "?" if found.index is None else found.index + 1
    name, what = found.code.name, found.code.content
    if name == "Limit":
        text = _limit(what.name, found, identity)
    elif name == "Board" and found.value == 1:
        text = "the board has started anew because it had failed"
    else:
        text = _DRIVE[what.name] if name == "Drive" else _CODES[name]
        text = text.format(number=number, value=found.value, limit=found.limit)
    return f"{text} (tick {found.tick})"


def text(padded: Any) -> str:
    """A text that the machine pads with zeros."""
    return bytes(padded).rstrip(b"\0").decode("ascii", "replace")


def firmware(build: Any) -> str:
    """Build of a program: version, commit, board and chip."""
    version, commit, board, chip = map(text, (build.version, build.commit, build.board, build.chip))
    # A simulator has no chip.
    if not chip:
        return f"{version}, {board}"
    if commit.endswith("-dirty"):
        commit = f"{commit.removesuffix('-dirty')} with changes"
    source = f"commit {commit}" if commit else "built without git"
    return f"{version}, {source}, board {board}, chip {chip}"


def wants_acknowledgement(found: Any) -> bool:
    """Whether a ``ClearFault`` has to come before the next ``Enable``."""
    return bool(found.name == "Restarted" or found.name == "Drive" and found.content["error"] != 0)


def not_enabled(found: Any) -> str:
    """Why the drives were not switched on."""
    fields = dict(found.content or {})
    fields["number"] = fields.pop("motor", -1) + 1
    if "state" in fields:
        fields["state"] = fields["state"].name
    if "angles" in fields:
        known = [(number, angle) for number, angle in enumerate(fields["angles"], 1) if angle is not None]
        fields["drives"] = ", ".join(f"drive {number}" for number, _ in known)
        fields["joints"] = ", ".join(f"joint {number} is taken to be at {angle:.4g} rad" for number, angle in known)
    return _NOT_ENABLED[found.name].format(**fields)


def violation(found: Any, ticks: int, identity: Any) -> str:
    """The limit that a move of ``ticks``, 0 if unknown, would break, or is not proven to keep."""
    what = found.what.name
    if what == "Range":
        coordinate = {0: "x", 1: "y", 2: "alpha"}.get(found.index, "a result")
        return f"{coordinate} is not in the range of the number type"
    subject, unit, si = _subject(what, found.index, identity)
    value, limit = found.value * unit, found.limit * unit
    if found.error is None:
        text = "has no bounds there"
    else:
        error = found.error * unit
        text = f"{value:.6g}{si} (from {max(value - error, 0.0):.6g} to {value + error:.6g})"
        text = f"would be {text}" if found.certain else f"is not proven to keep its limit: it would be {text}"
    if found.ramp:
        text += " in a hold or a resume there"
    text = f"{subject} {text}, the {_bound(what, value, limit)} allowed is {limit:.6g}{si}"
    if ticks:
        text += f", {found.at * ticks / identity.tick_rate_hz:.4g} s into the move"
    if found.shortest is None:
        return text
    enough, too_short = found.shortest.enough, found.shortest.too_short
    text += f"; {enough} ticks ({enough / identity.tick_rate_hz:.4g} s) would be long enough"
    return f"{text}, {too_short} are too few" if too_short else f"{text}, fewer are not proven to be"


def _subject(what: str, index: int | None, identity: Any) -> tuple[str, float, str]:
    """Name of the quantity, one unit of it in SI, name of the SI unit."""
    subject, part, (length, time, mass), si = _BOUNDED[what]
    if index is not None:
        subject += f" of {part} {index + 1}"
    return subject, identity.length_m**length * identity.time_s**time * identity.mass_kg**mass, si


def _bound(what: str, value: float, limit: float) -> str:
    # A leg can be too short as well as too long.
    return "least" if what.endswith("Distance") or (what == "Reach" and value < limit) else "most"


def _limit(what: str, found: Any, identity: Any) -> str:
    subject, unit, si = _subject(what, found.index, identity)
    if what == "Range":
        return f"a result was beyond the {subject}"
    value, limit = found.value * unit, found.limit * unit
    return f"{subject} was {value:.6g}{si}, the {_bound(what, value, limit)} allowed is {limit:.4g}{si}"
