"""A whole job: hello, moves as there is room, start, and an eye on it until it is done."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable, Sequence
from typing import Any

from . import words
from .errors import BoardError, Interrupted
from .exchange import Exchange, Refused, Silent
from .goals import Mover, NoMotion
from .jobs import Job, common, offer, switch
from .messages import ALL_FIELDS, Command, Recovery, SectionName
from .numbers import NUMBERS
from .ports import Port, PortError
from .postcard import Value

_MODULUS = 1 << 32

#: Refusals that pass by themselves.
_NOT_YET = {
    "Move": {"QueueFull", "Busy"},
    "Quintic": {"QueueFull", "Busy"},
    "OutputsAt": {"OutputsFull", "Busy"},
    "Start": {"Undecided", "NothingQueued", "EndsMoving", "Busy"},
    "Telemetry": {"Busy"},
    "Resume": {"State", "Busy", "DoorOpen"},
    "Stop": {"Busy"},
    "FeedOverride": {"Busy"},
    "Home": {"Busy"},
    "ClearFault": {"Busy"},
    "Recover": {"Busy"},
}

#: A machine is beside a pose if D is nearer than this, m, and alpha, rad; the way takes so long, s.
_NEAR_M, _NEAR_RAD, _WAY_S = 5e-4, 5e-3, 0.2


#: States that pass by themselves and are no job's.
ON_THE_WAY = ("Homing", "Recovering", "Stopping")


def _is_on_the_way(status: Any) -> bool:
    """Whether the machine is in a state that passes by itself and is no job's."""
    return status.state.name in ON_THE_WAY


class JobFailed(BoardError):
    """The job was not played to its end, and why."""


class Stream:
    """Plays ``job`` through ports that ``connect`` opens, anew after each that breaks.

    ``heard`` gets events and telemetry, ``progress`` the moves done, their number and the state.
    ``survey``: what to ask before the job starts; the answers are in the attribute of that name.
    ``recover_s``: before the job, bring the machine to where the job starts, within so many seconds; a
    latched fault is acknowledged for it. ``feed_percent``: feed override, 1 to 100 % of normal speed; see
    ``override_feed`` for one while the job runs.
    """

    def __init__(
        self,
        connect: Callable[[], Port],
        job: Job,
        heard: Callable[[Value], None],
        progress: Callable[[int, int, str], None] = lambda done, moves, state: None,
        telemetry: int = 1,
        any_scene: bool = False,
        reconnects: int = 3,
        answer_s: float = 0.2,
        survey: Sequence[Value] = (),
        recover_s: float | None = None,
        feed_percent: int | None = None,
    ) -> None:
        self._connect = connect
        self._job = job
        self._heard = heard
        self._progress = progress
        self._telemetry = telemetry
        self._scene = 0 if any_scene else job.scene
        self._reconnects = reconnects
        self._answer_s = answer_s
        self._questions = survey
        self._recover_s = recover_s
        self._feed = feed_percent
        self.survey: list[Any] = []
        self._moves: list[Any] = []
        self._base: Any = None
        self._offered = 0
        #: The move whose outputs the machine knows.
        self._switched: int | None = None
        self._refused: Any = None
        #: The conversation under way.
        self.exchange: Any = None
        self.status: Any = None
        self.repeated = 0
        self.reconnected = 0
        self.damaged: Counter[str] = Counter()

    def run(self) -> None:
        """Plays the job. ``JobFailed`` says why it did not end; ``PortError`` and ``Silent`` that the
        machine is out of reach."""
        while True:
            try:
                port = self._connect()
                try:
                    return self._play(port)
                finally:
                    if self.exchange is not None:
                        self.repeated += self.exchange.repeated
                        self.damaged.update(self.exchange.damaged)
                    port.close()
            except (PortError, Silent):
                if self.reconnected == self._reconnects:
                    raise
                self.reconnected += 1
                # A machine that still sees the client before refuses this one, and may start anew itself.
                time.sleep(self._answer_s)

    def _play(self, port: Port) -> None:
        numbers = NUMBERS.get(self._job.number) if self._job.number else None
        if self._job.number and numbers is None:
            raise JobFailed(f"machines with {self._job.number} numbers are not known here")
        exchange = self.exchange = Exchange(port, numbers, self._heard, self._answer_s)
        # A change may not have come: of two for one move the last counts, and they are the same.
        self._switched = None
        port.send(b"\0")  # ends whatever the line held
        try:
            identity = exchange.hello(self._scene)
        except Refused as refused:
            raise JobFailed(str(refused)) from None
        if self._base is None:
            self._require_tool()
        if not self._moves:
            self._moves = self._job.moves(identity)
        if not self.survey:
            self.survey = [exchange.ask(question) for question in self._questions]
        pause = min(0.1, identity.silence_ticks / identity.tick_rate_hz / 4 or 0.1)
        try:
            if self._base is None:
                self._raise_off(self.exchange.enable(pause))
                if self._recover_s is not None:
                    self.recover(self._recover_s, pause)
                self.home(pause)
                self.approach(pause)
                self._look()
                self._command(Command.Job(self._job.label(self._moves, exchange.numbers)))
            self._look()
            self._command(Command.Telemetry(every=self._telemetry, fields=ALL_FIELDS))
            while not self._look():
                if self._feed is not None and self._command(Command.FeedOverride(percent=self._feed)):
                    self._feed = None
                if not self._push():
                    exchange.listen(pause)
        except (KeyboardInterrupt, Interrupted):
            exchange.come_to_rest()
            raise

    def _require_tool(self) -> None:
        """``JobFailed`` where the machine carries another tool than the job is for. One that plays it already was begun with that tool."""
        tools, mounted = self._job.tools, self._job.mounted
        if mounted is None:
            return
        platform = self.exchange.ask(Command.Read(SectionName.Platform())).content
        carried = next((name for name, body in tools.items() if body.is_near(platform)), None)
        if carried != mounted:
            found = "no tool of the scene" if carried is None else f"the tool {carried!r}"
            raise JobFailed(f"the machine carries {found}, and the job is for the tool {mounted!r}: mount that, and tell the machine")

    def override_feed(self, percent: int) -> None:
        """Plays at ``percent`` of normal speed, 1 to 100, from now on. For ``heard`` and ``progress``: the machine gets it
        with the next look."""
        self._feed = percent

    def recover(self, seconds: float, pause: float) -> None:
        """Acknowledges a latched fault, or why the drives did not go on, and takes ``seconds`` to move the motors to where they are at
        the start of the job. A machine that is not homed after that is left to be homed. Looks every
        ``pause`` seconds."""
        status = self._wait_while(_is_on_the_way, pause)
        refused = status.not_enabled if status.state.name == "Disabled" else None
        if status.fault is not None or refused is not None and words.wants_acknowledgement(refused):
            self._insist(Command.ClearFault(), pause)
            # The tick has to hear of it.
            self._wait_while(lambda status: status.fault is not None, pause)
            status = self.exchange.enable(pause)
            self._raise_off(status)
        if status.state.name in ("Idle", "Cleared"):
            ticks = max(1, round(seconds * self.exchange.identity.tick_rate_hz))
            self._insist(Command.Recover(Recovery(to=common(self._moves[0]).from_, ticks=ticks)), pause)
            self._wait_for_idle("the recovery", pause)

    def home(self, pause: float) -> None:
        """Homes a machine that does not know where its motors are, and waits until it stands at its
        start, looking every ``pause`` seconds."""
        status = self.exchange.ask(Command.Status())
        if status.state.name not in ("Unhomed", "Homing") or status.fault is not None:
            return
        if status.state.name == "Unhomed":
            self._insist(Command.Home(), pause)
        self._wait_for_idle("homing", pause)

    def approach(self, pause: float) -> None:
        """Moves a machine that stands elsewhere to the start of the job: its motors where it stands beside it, as one that was measured
        does, and along a way that the machine plans from farther away. ``JobFailed`` says why there is none."""
        status = self.exchange.ask(Command.Status())
        identity, start = self.exchange.identity, common(self._moves[0]).from_
        stands = status.end.pose if status.end is not None else start
        if stands == start or status.state.name != "Idle" or status.next != status.done:
            return
        away = math.hypot(stands.x - start.x, stands.y - start.y) * identity.length_m
        if away < _NEAR_M and abs(stands.alpha - start.alpha) < _NEAR_RAD:
            ticks = math.ceil(_WAY_S * identity.tick_rate_hz)
            self._insist(Command.Recover(Recovery(to=start, ticks=ticks)), pause)
            self._wait_for_idle("the way to the start", pause)
            return
        try:
            Mover(self.exchange).go_exactly(start)
        except (NoMotion, Refused) as why:
            raise JobFailed(f"the machine does not stand where the job starts, and has no way there: {why}") from None

    def _insist(self, command: Value, pause: float) -> None:
        """Asks until it is done."""
        while not self._command(command):
            self.exchange.listen(pause)

    def _wait_while(self, holds: Callable[[Any], bool], pause: float) -> Any:
        """Looks until ``holds`` does not hold of the status any more; the last one."""
        status = self.exchange.ask(Command.Status())
        while holds(status):
            self.exchange.listen(pause)
            status = self.exchange.ask(Command.Status())
        return status

    def _wait_for_idle(self, what: str, pause: float) -> None:
        """Looks until the machine stands at the end of ``what``. ``JobFailed`` where it does not come
        to it."""
        status = self._wait_while(_is_on_the_way, pause)
        self._raise_fault(status)
        if status.state.name != "Idle":
            raise JobFailed(f"{what} was given up: {status.acting}")

    def _raise_fault(self, status: Any) -> None:
        """``JobFailed`` where a fault is latched."""
        if status.fault is not None:
            raise JobFailed(words.fault(status.fault, self.exchange.identity))

    def _raise_off(self, status: Any) -> None:
        """``JobFailed`` where the drives did not go on."""
        if status.state.name == "Disabled":
            why = status.not_enabled
            raise JobFailed("not enabled" + (f": {words.not_enabled(why)}" if why else ""))

    def _push(self) -> bool:
        """Offers a move, starts, or goes on where the machine has waited for its host; whether there was anything to do."""
        waits = self.status.state.name in ("Slowing", "Holding") and self.status.acting.name == "Silence"
        if waits and self._command(Command.Resume()):
            self._look()
            return True
        if self._offered < len(self._moves):
            if not self.status.room:
                return self._start()
            number = (self._base + self._offered) % _MODULUS
            change = switch(self._job.steps[self._offered], number)
            if change is not None and self._switched != self._offered:
                if not self._command(change):
                    # Changes wait for moves that do not begin before the job does.
                    return self._start()
                self._switched = self._offered
            if not self._command(offer(self._moves[self._offered], number)):
                return False
            self._offered += 1
            return True
        return self._start()

    def _start(self) -> bool:
        # Not only once: where moves come too slowly, the machine rests at the end of what it has.
        status = self.status
        stands = status.state.name == "Idle" and status.admitted == status.next != status.done
        return stands and self._command(Command.Start())

    def _command(self, command: Value) -> bool:
        """Asks; whether it was done. What passes by itself is no failure."""
        try:
            self.exchange.ask(command)
            return True
        except Refused as refused:
            name = refused.refusal.name
            if name in _NOT_YET.get(command.name, ()):
                return False
            if command.name in ("Move", "Quintic"):
                raise JobFailed(f"move {self._offered + 1}: {refused}") from None
            raise JobFailed(str(refused)) from None

    def _look(self) -> bool:
        """Reads the status; whether the job is done. ``JobFailed`` where it never will be."""
        before, self.status = self.status, self.exchange.ask(Command.Status())
        status = self.status
        state = status.state.name
        self._raise_fault(status)
        if self._base is None:
            if state != "Idle" or status.next != status.done:
                raise JobFailed(f"the machine is not free: {state}, or with moves of another job")
            self._base = status.next
            # A goal that was refused before the job is none of its moves.
            self._refused = status.refused
        if status.refused is not None and status.refused.violation is not None and status.refused != self._refused:
            index = (status.refused.number - self._base) % _MODULUS
            if index < len(self._moves):
                self._command(Command.Stop())
                ticks = common(self._moves[index]).ticks
                why = words.violation(status.refused.violation, ticks, self.exchange.identity)
                raise JobFailed(f"move {index + 1} is not admitted: {why}")
        taken = (status.next - self._base) % _MODULUS
        done = (status.done - self._base) % _MODULUS
        if taken > len(self._moves):
            raise JobFailed("the machine was switched off and on during the job")
        if taken < self._offered:
            raise JobFailed(
                f"the machine dropped the job ({status.acting}), {done} of {len(self._moves)} moves done"
            )
        self._offered = taken  # more only where the answer to a move was lost with the line
        if before is None or before.done != status.done or before.state != status.state:
            self._progress(done, len(self._moves), state)
        if done != len(self._moves) or state != "Idle":
            return False
        left = status.interrupted
        if left is not None and (index := (left.number - self._base) % _MODULUS) < len(self._moves):
            raise JobFailed(f"the job was left in move {index + 1} of {len(self._moves)} ({status.acting}): another client or thread stopped it")
        return True
