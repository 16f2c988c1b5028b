"""Goals: a pose to go to, steps and velocities by hand, poses to follow.

The machine plans its own way, from rest or from any motion: what is under way is cut.
"""

from __future__ import annotations

import time
from collections.abc import Iterable
from typing import Any

from . import words
from .errors import BoardError
from .exchange import Exchange, Refused
from .messages import Command, Goal
from .numbers import Pose

#: x and y in m, alpha in rad; or their derivatives by time.
Triple = tuple[float, float, float]

#: Refusals of a machine that will take the command in a moment.
NOT_YET = ("Busy", "Retargeting", "QueueFull", "Undecided", "NothingQueued", "EndsMoving", "PathUnderWay")

#: Seconds between two questions for the status.
LOOK_S = 0.01


class NoMotion(BoardError):
    """The machine has no motion to the goal, or has stopped on its way."""


class Mover:
    """Sends the machine of ``exchange``, which has said hello, to goals. Its drives go on for the first of them."""

    def __init__(self, exchange: Exchange) -> None:
        self.exchange = exchange
        self._refused: Any = None
        # Reason of an earlier stop, and the moves until then: no stop of what is begun here.
        self._before: Any = None

    def status(self) -> Any:
        """The status, in the machine's units."""
        return self.exchange.ask(Command.Status())

    def end(self) -> Triple:
        """Pose at the end of what is planned, m and rad."""
        status = self.exchange.enable(LOOK_S)
        while status.end is None:
            if status.state.name in ("Disabled", "Unhomed", "Cleared"):
                raise NoMotion(f"the machine is not free: {status.state}")
            self.exchange.listen(LOOK_S)
            status = self.status()
        length, pose = self.exchange.identity.length_m, status.end.pose
        return (pose.x * length, pose.y * length, pose.alpha)

    def aim(self, pose: Triple, velocity: Triple = (0.0, 0.0, 0.0), seconds: float = 0.0) -> None:
        """Begins to go to ``pose``, to be there with ``velocity``, in ``seconds`` or as soon as it can."""
        for name, given in (("pose", pose), ("velocity", velocity)):
            if len(given) != 3:
                raise ValueError(f"a {name} has three numbers, of x, y and alpha: {tuple(given)} has {len(given)}")
        status = self.exchange.enable(LOOK_S)
        self._begin(status)
        self._refused = status.refused
        self._until_taken(lambda: self.exchange.retarget(pose, velocity, True, seconds))

    def move_to(self, pose: Triple) -> Triple:
        """Goes to ``pose``, and returns where the machine stands. ``NoMotion`` says why it does not."""
        self.aim(pose)
        return self.wait()

    def go_exactly(self, pose: Pose) -> None:
        """Goes to ``pose``, in the machine's own numbers, from where it is idle. ``NoMotion`` and ``Refused`` say why it does not."""
        status = self.status()
        self._begin(status)
        self._refused = status.refused
        self._until_taken(lambda: self.exchange.ask(Command.Retarget(Goal(pose, (0.0, 0.0, 0.0), False, 0))))
        self.wait()

    def step(self, by: Triple) -> Triple:
        """Goes so far from the end of what is planned."""
        x, y, alpha = self.end()
        return self.move_to((x + by[0], y + by[1], alpha + by[2]))

    def jog(self, velocity: Triple, seconds: float, every: float = 0.05) -> Triple:
        """Moves at ``velocity`` for ``seconds``, then comes to rest.

        The machine gets a goal in motion ``every`` so many seconds. Where they end, or the line does, it comes to rest by
        itself.
        """
        identity = self.exchange.identity
        ahead = max(0.2, 3 * identity.ramp_ticks / identity.tick_rate_hz)
        start, begin = self.end(), time.monotonic()
        while (now := time.monotonic() - begin) < seconds:
            # From rest it falls behind by half of the time to the first goal.
            t = now + ahead / 2
            x, y, alpha = (place + rate * t for place, rate in zip(start, velocity))
            self.aim((x, y, alpha), velocity, ahead)
            status = self.status()
            self._raise_stopped(status)
            self._play(status)
            self.exchange.listen(every)
        self.exchange.come_to_rest()
        self._raise_fault(self.status())
        return self.end()

    def follow(self, poses: Iterable[Triple], every: float) -> Triple:
        """Goes to each of ``poses`` in turn, a new one ``every`` so many seconds, and to the last one's end."""
        for pose in poses:
            self.aim(pose)
            until = time.monotonic() + every
            while (left := until - time.monotonic()) > 0:
                status = self.status()
                self._raise_stopped(status)
                self._play(status)
                self.exchange.listen(min(left, LOOK_S))
        return self.wait()

    def wait(self) -> Triple:
        """Waits until the machine stands at the end of what is planned."""
        while True:
            status = self.status()
            self._raise_fault(status)
            if status.refused is not None and status.refused != self._refused:
                why = words.violation(status.refused.violation, 0, self.exchange.identity)
                raise NoMotion(f"no motion to the goal: {why}")
            self._raise_stopped(status)
            if not self._moves(status) and status.next == status.done:
                return self.end()
            self._play(status)
            self.exchange.listen(LOOK_S)

    def _moves(self, status: Any) -> bool:
        return status.planning or status.state.name in ("Running", "Slowing", "Stopping", "Holding")

    def _begin(self, status: Any) -> None:
        """Notes a stop that was before, once: the next start takes it out of the status."""
        if self._before is None:
            self._before = _mark(status)

    def _raise_stopped(self, status: Any) -> None:
        """``NoMotion`` where somebody has stopped the machine since the first goal."""
        stopped = status.acting.name in ("Stop", "Silence") and not self._moves(status) and status.next == status.done
        if stopped and _mark(status) != self._before:
            raise NoMotion(f"the machine has stopped: {status.acting}")

    def _raise_fault(self, status: Any) -> None:
        if status.fault is not None:
            raise NoMotion(f"fault: {words.fault(status.fault, self.exchange.identity)}")

    def _play(self, status: Any) -> None:
        """Starts moves that wait for it, and goes on where the machine has waited for its host."""
        if status.state.name in ("Slowing", "Holding") and status.acting.name == "Silence":
            self._until_taken(lambda: self.exchange.ask(Command.Resume()))
        waits = status.state.name == "Idle" and not status.planning
        if waits and status.next != status.done and status.admitted == status.next:
            self._until_taken(lambda: self.exchange.ask(Command.Start()))

    def _until_taken(self, ask: Any) -> None:
        """Repeats what the machine does not take yet."""
        while True:
            try:
                ask()
                return
            except Refused as refused:
                if refused.refusal.name not in NOT_YET:
                    raise
                self.exchange.listen(LOOK_S)


def _mark(status: Any) -> tuple[str, int, int]:
    return status.acting.name, status.next, status.done


__all__ = ["Mover", "NoMotion"]
