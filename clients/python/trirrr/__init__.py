"""trirrr: planar 3-RRR manipulators over numpy arrays, and a client for their boards.

    Machine, check           scenes, kinematics, torques, verdicts, plans, runs (native core, numpy)
    Board, AsyncBoard        a machine on a serial port or TCP (standard library alone)
    figures                  figures of runs and machines (matplotlib)
    table                    columns by name, to pandas and Arrow
    study                    parts of a design study over any executor

The client of ``Board`` in parts, as docs/wire.md has it:

    frames, cobs, postcard   bytes on the line and values in them
    numbers                  number types of machines; poses and setpoints
    messages, texts          messages, and texts for people: written by ``cargo xtask wire``
    words                    faults, refusals and violations in texts and SI units
    exchange, stream         one request at a time; a whole job
    goals                    poses to go to, steps, velocities, poses to follow
    jobs                     moves from a scene file or a CSV table
    ports                    serial (needs pyserial) and TCP
    record                   telemetry as CSV
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .board import AsyncBoard, Board, BoardStatus, Contact
    from .errors import BoardError, Interrupted, MotionError, PlanError, Problem, SceneError, TrirrrError
    from .exchange import Refused, Silent
    from .goals import NoMotion
    from .jobs import JobError
    from .machine import Machine, check
    from .messages import PROTOCOL
    from .ports import PortError
    from .stream import JobFailed
    from .table import Table
    from .update import ImageError, UpdateFailed

#: Modules of the names of the package. They are imported when they are used: a client needs neither numpy nor the native core.
_HOMES = {
    "AsyncBoard": "board",
    "Board": "board",
    "BoardError": "errors",
    "BoardStatus": "board",
    "Contact": "board",
    "ImageError": "update",
    "Interrupted": "errors",
    "JobError": "jobs",
    "JobFailed": "stream",
    "Machine": "machine",
    "MotionError": "errors",
    "NoMotion": "goals",
    "PROTOCOL": "messages",
    "PlanError": "errors",
    "PortError": "ports",
    "Problem": "errors",
    "Refused": "exchange",
    "SceneError": "errors",
    "Silent": "exchange",
    "Table": "table",
    "TrirrrError": "errors",
    "UpdateFailed": "update",
    "check": "machine",
}


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(importlib.import_module(f".{_HOMES[name]}", __name__), name)


def __dir__() -> list[str]:
    return sorted([*globals(), *_HOMES])


__all__ = [
    "PROTOCOL",
    "AsyncBoard",
    "Board",
    "BoardError",
    "BoardStatus",
    "Contact",
    "ImageError",
    "Interrupted",
    "JobError",
    "JobFailed",
    "Machine",
    "MotionError",
    "NoMotion",
    "PlanError",
    "PortError",
    "Problem",
    "Refused",
    "SceneError",
    "Silent",
    "Table",
    "TrirrrError",
    "UpdateFailed",
    "check",
]
