"""Exceptions of the package. Each says in a sentence what is wrong, and each is a ``TrirrrError``."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Problem:
    """One thing that is wrong with a scene."""

    #: File that the value stands in.
    file: str
    #: Line, from 1; 0 for a setting that was given as an argument.
    line: int
    #: Path of the key, such as ``job.move[2].duration_s``; empty for a line that is no TOML.
    key: str
    #: Value as the file has it, or ``None``.
    value: str | None
    #: Description of what is wrong, and of what would be right.
    reason: str


class TrirrrError(Exception):
    """Something is wrong, or was not done. All exceptions of the package are of this class."""


class BoardError(TrirrrError):
    """The machine did not do what it was asked to, or is out of reach, and why."""


class Interrupted(BoardError):
    """The call was ended before the machine was there: the machine came to rest on its path."""


class SceneError(TrirrrError, ValueError):
    """A scene that cannot be used. The text has a line for each problem, as ``trirrr check`` prints it."""

    def __init__(
        self, text: str, problems: Sequence[tuple[str, int, str, str | None, str]] = ()
    ) -> None:
        super().__init__(text)
        #: Everything that was found wrong, in the order of the file; empty for a file that cannot be read.
        self.problems = [Problem(*fields) for fields in problems]


class MotionError(TrirrrError, ValueError):
    """States without a motion: out of reach, or singular."""

    def __init__(self, text: str, rows: Sequence[tuple[int, str]] = ()) -> None:
        super().__init__(text)
        #: Number of each such state, from 0 in the order of the array, and the reason.
        self.rows = list(rows)


class PlanError(TrirrrError, ValueError):
    """A path without a plan."""


__all__ = ["BoardError", "Interrupted", "MotionError", "PlanError", "Problem", "SceneError", "TrirrrError"]
