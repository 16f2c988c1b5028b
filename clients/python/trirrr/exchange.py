"""Requests and their answers over a port: numbered, repeated, counted.

A request that is not answered is sent again, unchanged, with the same sequence number; the machine
executes it once however often it comes. So it does not matter whether the request or its answer was
lost.
"""

from __future__ import annotations

import random
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from contextvars import ContextVar
from typing import Any

from . import frames, words
from .errors import BoardError, Interrupted
from .frames import Listener
from .messages import PROTOCOL, SCHEMA, Command, Goal, Hello, Request
from .numbers import NUMBERS, Pose
from .ports import Port, PortError
from .postcard import Numbers, Value


#: The call under way. Once it is set, the call ends with ``Interrupted`` before its next request.
CALL: ContextVar[threading.Event | None] = ContextVar("trirrr_call", default=None)

#: States that end by a stop.
_MOVING = ("Running", "Slowing", "Holding", "Homing", "Recovering", "Stopping", "Reacting")

#: A thread listens for so many seconds before another one may ask.
_TURN_S = 0.02


class Silent(BoardError):
    """The machine did not answer, however often it was asked."""


class Refused(BoardError):
    """The machine does not do what it was asked to."""

    def __init__(self, command: Value, refusal: Value) -> None:
        super().__init__(f"{command.name} is refused: {words.refusal(refusal, command)}")
        self.command = command
        self.refusal = refusal


class Turns:
    """A lock that threads get in turn: one that asks again and again does not starve another."""

    def __init__(self) -> None:
        self._next = threading.Lock()
        self._held = threading.RLock()

    def __enter__(self) -> None:
        with self._next:
            self._held.acquire()

    def __exit__(self, *_: object) -> None:
        self._held.release()


class Exchange:
    """A conversation with one machine. Threads may share it.

    ``heard`` gets every event and telemetry sample as it comes. Times are in seconds; after each
    repetition the wait doubles, up to eight times.
    """

    def __init__(
        self,
        port: Port,
        numbers: Numbers | None,
        heard: Callable[[Value], None],
        answer_s: float = 0.2,
        attempts: int = 7,
    ) -> None:
        self._port = port
        self._heard = heard
        self._answer_s = answer_s
        self._attempts = attempts
        self._sequence = 0
        # Each hello has its own number: a late answer to an old one is not taken for the new one.
        self._hello = random.getrandbits(31)
        self._numbers = numbers
        self._listener: Listener | None = None
        self._turns = Turns()
        # A request whose answer an exception has cut off.
        self._unanswered: Any = None
        self.repeated = 0
        self.identity: Any = None

    @property
    def numbers(self) -> Numbers:
        """The machine's number type; known after the hello."""
        if self._numbers is None:
            raise ValueError("the machine's number type is not known before a hello")
        return self._numbers

    @property
    def damaged(self) -> dict[str, int]:
        """Damaged frames by what was wrong with them."""
        return dict(self._listener.decoder.errors) if self._listener else {}

    def hello(self, scene: int = 0) -> Any:
        """Opens the conversation; the machine's identity. ``scene``: key of the scene, 0 for any.

        Where the number type is not given, the one that the machine accepts is taken.
        """
        for numbers in [self._numbers] if self._numbers else list(NUMBERS.values()):
            self._listener = Listener(numbers)
            self._unanswered = None
            command = Command.Hello(Hello(PROTOCOL, SCHEMA[numbers.name], scene))
            self._hello = (self._hello + 1) % (1 << 32)
            try:
                reply = self._converse(Request(self._hello, command), numbers)
            except Refused as refused:
                if refused.refusal.name == "Schema" and self._numbers is None:
                    last = refused
                    continue
                raise
            self._numbers = numbers
            # A thread that sees the identity may ask.
            self._sequence = reply.content.next_sequence
            self.identity = reply.content
            return self.identity
        raise last

    def ask(self, command: Value) -> Any:
        """The content of the answer to ``command``. ``Refused`` and ``Silent`` say why there is none, ``Interrupted`` that the call
        was ended before."""
        _raise_if_ended()
        with self._turns:
            if self._unanswered is not None:
                # The machine may have executed it: its number is not another request's.
                with suppress(Refused):
                    self._settle(self._unanswered)
            return self._settle(Request(self._sequence, command)).content

    def _settle(self, request: Any) -> Value:
        """The answer to ``request``. Answered or refused, its number is used up."""
        self._unanswered = request
        try:
            reply: Value | Refused = self._converse(request, self.numbers)
        except Refused as refused:
            reply = refused
        self._unanswered = None
        if isinstance(reply, Refused):
            if reply.refusal.name not in ("HelloFirst", "Sequence", "SequenceReused"):
                self._sequence = (request.sequence + 1) % (1 << 32)
            raise reply
        self._sequence = (request.sequence + 1) % (1 << 32)
        return reply

    def come_to_rest(self) -> None:
        """Stops the machine on its path, and waits until it stands."""
        while True:
            try:
                self.ask(Command.Stop())
                break
            except Refused as refused:
                if refused.refusal.name != "Busy":
                    raise
                self.listen(_TURN_S)
        while self.ask(Command.Status()).state.name in _MOVING:
            self.listen(_TURN_S)

    def retarget(
        self,
        pose: tuple[float, float, float],
        velocity: tuple[float, float, float] = (0.0, 0.0, 0.0),
        cut: bool = False,
        seconds: float = 0.0,
    ) -> None:
        """Asks for moves to ``pose`` (m, m, rad), to arrive with ``velocity`` (m/s, m/s, rad/s).

        The machine plans them: from the motion under way with ``cut``, or else behind the moves that are queued, to take
        ``seconds`` or more. Its verdicts and its status say what came of it.
        """
        length, time = self.identity.length_m, self.identity.time_s
        speed = length / time
        ticks = round(seconds * self.identity.tick_rate_hz)
        to = Pose(pose[0] / length, pose[1] / length, pose[2])
        goal = Goal(to, (velocity[0] / speed, velocity[1] / speed, velocity[2] * time), cut, ticks)
        self.ask(Command.Retarget(goal))

    def enable(self, pause: float = 0.02) -> Any:
        """Switches the drives on where the motors are, and waits until they hold. Returns the status: ``Idle``,
        ``Unhomed``, ``Cleared``, or ``Disabled`` where the drives do not go on. Any other machine is left as it is."""
        status = self.ask(Command.Status())
        if status.state.name != "Disabled":
            return status
        while True:
            try:
                self.ask(Command.Enable())
                break
            except Refused as refused:
                if refused.refusal.name != "Busy":
                    raise
                self.listen(pause)
        while (status := self.ask(Command.Status())).state.name == "Enabling":
            self.listen(pause)
        return status

    def listen(self, seconds: float) -> None:
        """Takes what comes in the next ``seconds``. ``Interrupted`` ends it."""
        until = time.monotonic() + seconds
        while (left := until - time.monotonic()) > 0:
            _raise_if_ended()
            with self._turns:
                self._take(min(left, _TURN_S), None)

    def _converse(self, request: Any, numbers: Numbers) -> Value:
        frame = frames.request(request, numbers)
        for attempt in range(self._attempts):
            self.repeated += attempt > 0
            self._port.send(frame)
            until = time.monotonic() + self._answer_s * 2 ** min(attempt, 3)
            while (left := until - time.monotonic()) > 0:
                reply = self._take(left, request)
                if reply is None:
                    continue
                if reply.name == "Refused":
                    raise Refused(request.command, reply.content)
                return reply
        raise Silent(f"no answer to {request.command.name} in {self._attempts} attempts")

    def _take(self, timeout: float, request: Any) -> Value | None:
        """What comes next; the answer to ``request`` if it is among it."""
        assert self._listener is not None, "a hello comes first"
        found = None
        for message in self._listener.feed(self._port.receive(timeout)):
            if message.name != "Reply":
                self._heard(message)
            elif request is not None and _answers(request, message.content):
                found = message.content.reply
        return found


def _raise_if_ended() -> None:
    """``Interrupted`` where the call under way is to end. What it does to bring the machine to rest goes on."""
    call = CALL.get()
    if call is not None and call.is_set():
        call.clear()
        raise Interrupted("the call was ended: the machine comes to rest on its path")


def _answers(request: Any, content: Any) -> bool:
    """Whether the reply belongs to the request: by its number, and by its kind, for a number can
    come again in another conversation."""
    if content.sequence != request.sequence:
        return False
    kinds = {"Hello": "Hello", "Status": "Status", "Read": "Section", "UpdateStatus": "Update"}
    expected = kinds.get(request.command.name, "Done")
    return content.reply.name in ("Refused", expected)


__all__ = ["CALL", "Exchange", "PortError", "Refused", "Silent"]
