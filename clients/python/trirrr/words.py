"""Faults, refusals and violations in words and SI units: the texts of ``texts``, their places filled."""

from __future__ import annotations

from typing import Any

from . import texts
from .messages import PROTOCOL
from .postcard import Value

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


def refusal(found: Any, command: Any = None) -> str:
    """Why ``command`` was refused."""
    if found.name == "Update":
        return _say(texts.UPDATE, found.content)
    if found.name == "Schema":
        return (
            f"the board's messages have another layout (schema key {found.content.expected:#010x}): it was built for another "
            "number type, or from another version"
        )
    if found.name == "Recovery":
        return "the way there would break a limit"
    content = getattr(command, "content", None)
    return _say(texts.REFUSAL, found, ticks=getattr(getattr(content, "common", content), "ticks", "other"))


def fault(found: Any, identity: Any) -> str:
    """A latched fault of the machine that ``identity`` describes."""
    number = None if found.index is None else found.index + 1
    places: dict[str, Any] = {part: f"a {part}" if number is None else f"{part} {number}" for part in _PARTS}
    places |= {"value": _short(found.value), "limit": _short(found.limit)}
    name, what = found.code.name, found.code.content
    if name == "Limit":
        text = _limit(what.name, found, identity)
    elif name == "Board" and found.value == 1:
        text = "the board has started anew because it had failed"
    else:
        text = _say(texts.DRIVE_FAULT, what, **places) if name == "Drive" else _say(texts.FAULT, found.code, **places)
    return f"{text} (tick {found.tick})"


def not_enabled(found: Any) -> str:
    """Why the drives were not switched on."""
    places = {}
    if found.name == "Singular":
        places["what"] = _named(found.content.what.name, found.content.leg)
    if found.name == "Restarted":
        known = [(number, angle) for number, angle in enumerate(found.content.angles, 1) if angle is not None]
        places["drives"] = ", ".join(f"drive {number}" for number, _ in known)
        places["joints"] = ", ".join(f"joint {number} is taken to be at {_short(angle)} rad" for number, angle in known)
    return _say(texts.NOT_ENABLED, found, **places)


def wants_acknowledgement(found: Any) -> bool:
    """Whether a ``ClearFault`` has to come before the next ``Enable``."""
    return bool(found.name == "Restarted" or found.name == "Drive" and found.content.error != 0)


#: Parts that a fault may name.
_PARTS = ("leg", "motor", "joint", "drive")


def _say(table: dict[str, str], found: Any, **more: Any) -> str:
    """The text of the variant ``found``; its name where a machine of a later version knows more."""
    places = {"PROTOCOL": PROTOCOL, **_places(found.content), **more}
    # A variant may have a text of its own for one value of a field.
    special = (key for field, value in places.items() if (key := f"{found.name}, {field} {value}") in table)
    text = table.get(next(special, found.name))
    return str(found) if text is None else text.format(**places)


def _places(content: Any) -> dict[str, Any]:
    """The fields of a content as texts say them; motors and legs are counted from 1."""
    if isinstance(content, Value):
        return {"state": texts.STATE.get(content.name), "need": texts.SCENE_NEED.get(content.name)}
    places = dict(vars(content)) if hasattr(content, "__dict__") else {}
    for name, value in places.items():
        if name == "motor":
            places[name] = value + 1
        elif name == "leg":
            places[name] = "" if value is None else f" of leg {value + 1}"
        elif name == "quantity":
            places[name] = texts.QUANTITY.get(value.name, value.name)
        elif name == "state":
            places[name] = texts.DRIVE_STATE.get(value.name, value.name)
        elif isinstance(value, float):
            places[name] = _short(value)
    if "outputs" in places:
        places["last"] = places["outputs"] - 1
    return places


def _short(value: float) -> str:
    return f"{value:.4g}"


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


def _named(what: str, index: int | None) -> str:
    """Name of the quantity, with its part."""
    subject, part = texts.SUBJECT[what]
    return subject if index is None else f"{subject} of {part} {index + 1}"


def _subject(what: str, index: int | None, identity: Any) -> tuple[str, float, str]:
    """Name of the quantity, one unit of it in SI, name of the SI unit."""
    length, time, mass = texts.DIMENSION[what]
    unit = identity.length_m**length * identity.time_s**time * identity.mass_kg**mass
    return _named(what, index), unit, texts.UNIT[what]


def _bound(what: str, value: float, limit: float) -> str:
    # A leg can be too short as well as too long.
    return "least" if what.endswith("Distance") or (what == "Reach" and value < limit) else "most"


def _limit(what: str, found: Any, identity: Any) -> str:
    subject, unit, si = _subject(what, found.index, identity)
    if what == "Range":
        return f"a result was beyond the {subject}"
    value, limit = found.value * unit, found.limit * unit
    return f"{subject} was {value:.6g}{si}, the {_bound(what, value, limit)} allowed is {limit:.4g}{si}"
