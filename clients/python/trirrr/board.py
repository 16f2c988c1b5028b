"""A machine on a line: switch it on, home it, move it, play jobs. Standard library alone.

    with Board.connect("tcp:127.0.0.1:7700") as board:
        board.enable()
        board.move((0.26, 0.26, 0.4))

Poses are x, y in m and alpha in rad. Calls wait until the machine is there; ``hold``, ``resume`` and ``stop`` may come from another
thread meanwhile. ``AsyncBoard`` has the same calls for ``asyncio``.
"""

from __future__ import annotations

import asyncio
import contextlib
import functools
import math
import os
import threading
import time
from collections.abc import Callable, Coroutine, Iterable, Iterator
from dataclasses import dataclass, replace
from typing import Any, Concatenate, ParamSpec, TypeVar

from . import jobs, record, words
from .errors import BoardError, Interrupted
from .exchange import CALL, Exchange, Refused
from .goals import LOOK_S, Mover, NoMotion, Triple
from .messages import Command, Move, SceneHeader, Section, SectionName
from .numbers import NUMBERS, Pose
from .ports import Port, PortError, open_port
from .postcard import Value, loads
from .progress import Progress, hearing
from .record import Recorder
from .stream import ON_THE_WAY, Stream
from .update import Program, SceneValues, bring

P = ParamSpec("P")
T = TypeVar("T")

_UNDER_WAY = "a job is under way: wait for its end, or stop() it"

#: A machine is at a pose if it is as near as this, m and rad: its number type may round.
_NEAR = 1e-3


@dataclass(frozen=True)
class BoardStatus:
    """State of a machine."""

    #: Name of the state, such as Disabled, Unhomed, Idle, Running, Holding, Fault.
    state: str
    #: Pose at the end of what is planned: where an idle machine stands. ``None`` of one that does not know.
    end: Triple | None
    #: Sentence on the latched fault, or ``None``.
    fault: str | None
    #: Moves that are queued or under way.
    moves: int
    #: Feed override, percent.
    feed_percent: int
    #: Words on the inputs. ``None`` of a scene that names none.
    inputs: str | None = None
    #: Spare outputs that are on, and spare inputs that are active: names of ``[io]`` in the scene that the board was connected with,
    #: or else numbers, from 0.
    outputs_on: tuple[str | int, ...] = ()
    inputs_active: tuple[str | int, ...] = ()


@dataclass(frozen=True)
class Carried:
    """The platform with a tool on it. Vectors are in the frame of the platform."""

    mass_kg: float
    #: Moment of inertia about the centre of mass.
    inertia_kgm2: float
    #: Centre of mass, from the tool point.
    com_m: tuple[float, float]
    #: Tool point, from the reference point of the bare platform.
    tool_point_m: tuple[float, float]


@dataclass(frozen=True)
class Contact:
    """Place where a probe has touched, m and rad."""

    #: Pose to which the platform was commanded in the tick of the contact.
    pose: Triple
    #: Pose by the angles that the drives told then, ``None`` of drives that tell nothing.
    measured: Triple | None
    #: The tick, as telemetry counts them.
    tick: int


class Board:
    """A machine on an open line.

    Ctrl-C in a call that moves the machine brings it to rest on its path before ``KeyboardInterrupt`` goes on. A line that breaks
    ends the call with ``PortError``; the next call opens it anew. Everything that goes wrong is a ``BoardError``.
    """

    def __init__(
        self,
        address: str,
        baud: int = 921_600,
        number: str | None = None,
        answer_s: float = 0.2,
        scene: str | os.PathLike[str] | None = None,
    ) -> None:
        """Opens the line and says hello. See ``connect``."""
        self._pins = None if scene is None else jobs.pins(os.fspath(scene))
        self._open: Callable[[], Port] = lambda: open_port(address, baud)
        self._numbers = None if number is None else NUMBERS[number]
        self._answer_s = answer_s
        self._port: Port | None = None
        self._is_closed = False
        self._job: Stream | None = None
        # Whose conversation the line carries, and that it is open: changed together.
        self._line = threading.RLock()
        self._greet()

    @classmethod
    def connect(
        cls,
        address: str,
        *,
        baud: int = 921_600,
        number: str | None = None,
        answer_s: float = 0.2,
        scene: str | os.PathLike[str] | None = None,
    ) -> Board:
        """Opens ``address``, ``tcp:HOST:PORT`` or a serial port, and says hello.

        ``number``: the machine's number type, found out if left out. ``answer_s``: seconds to wait for an answer before a request is
        repeated. ``scene``: file of the machine's scene, for the names of its spare outputs and inputs. ``PortError``, ``Silent`` and ``Refused`` say why there is no machine.
        """
        return cls(address, baud, number, answer_s, scene)

    def __enter__(self) -> Board:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Gives the line back. The machine comes to rest by itself if it waits for its host."""
        with self._line:
            self._is_closed = True
            self._drop()

    def _drop(self) -> None:
        with self._line:
            if self._port is not None:
                self._port.close()
                self._port = None

    @property
    def name(self) -> str:
        """Name of the machine's scene."""
        return words.text(self._exchange.identity.name)

    @property
    def firmware(self) -> str:
        """Build of the machine's program: version, commit, board and chip."""
        return words.firmware(self._exchange.identity.firmware)

    @property
    def tick_rate_hz(self) -> float:
        """Ticks per second."""
        return float(self._exchange.identity.tick_rate_hz)

    def status(self) -> BoardStatus:
        """The state of the machine."""
        status, identity = self._ask(Command.Status()), self._exchange.identity
        end = None
        if status.end is not None:
            pose = status.end.pose
            end = (pose.x * identity.length_m, pose.y * identity.length_m, float(pose.alpha))
        fault = None if status.fault is None else words.fault(status.fault, identity)
        moves = (status.next - status.done) % (1 << 32)
        inputs = words.inputs(status.inputs)
        outputs_on, inputs_active = self._pin_states(status.digital)
        return BoardStatus(status.state.name, end, fault, moves, status.feed_percent, inputs, outputs_on, inputs_active)

    def _pin_states(self, digital: Any) -> tuple[tuple[str | int, ...], tuple[str | int, ...]]:
        """Spare outputs that are on, and inputs that are active."""
        if digital is None:
            return (), ()
        outputs, inputs = self._pins or ([], [])

        def named(bits: int, names: list[str]) -> tuple[str | int, ...]:
            found = [index for index in range(8) if bits >> index & 1]
            return tuple(names[index] if index < len(names) else index for index in found)

        return named(digital.outputs, outputs), named(digital.inputs, inputs)

    def output(self, output: str | int, on: bool) -> None:
        """Switches a spare output at once: by its name in the scene that the board was connected with, or by its number, from 0.

        Off goes in every state; on only while the drives are on. An output with ``job_only`` goes on once a job runs. ``BoardError``
        of a name that the scene does not have, ``Refused`` of what the machine does not do.
        """
        index = output if isinstance(output, int) else self._output_named(output)
        self._ask(Command.Output(index=index, on=on))

    def _output_named(self, name: str) -> int:
        if self._pins is None:
            raise BoardError(f"output {name!r}: no names are known; connect with scene=..., or give the number of the output")
        names = self._pins[0]
        if name not in names:
            raise BoardError(f"the scene has no output {name!r}; its outputs are {', '.join(names) or 'none'}")
        return names.index(name)

    def enable(self) -> BoardStatus:
        """Switches the drives on where the motors are, and waits until they hold. ``BoardError`` says why they do not."""
        status = self._exchange.enable(LOOK_S)
        if status.fault is not None:
            raise BoardError(f"fault: {words.fault(status.fault, self._exchange.identity)}; clear_fault() acknowledges it")
        if status.state.name == "Disabled":
            why = status.not_enabled
            raise BoardError("the drives do not go on" + (f": {words.not_enabled(why)}" if why else ""))
        return self.status()

    def disable(self) -> None:
        """Switches the drives off."""
        self._ask(Command.Disable())

    def clear_fault(self) -> None:
        """Acknowledges a latched fault."""
        self._ask(Command.ClearFault())

    def mount(self, carried: Carried) -> Triple:
        """Tells an idle machine with ``adjustable`` in its scene that it carries another tool, such as ``machine.tools["gripper"]``.

        The motors stay where they are. Returns where the new tool point is. ``Refused`` says why the machine does not take it.
        """
        platform = self._ask(Command.Read(SectionName.Platform())).content
        # Gravity and the force at the tool stay the machine's.
        platform = replace(
            platform,
            mass_kg=carried.mass_kg,
            inertia_kgm2=carried.inertia_kgm2,
            com_m=carried.com_m,
            tool_point_m=carried.tool_point_m,
        )
        self._ask(Command.Replace(Section.Platform(platform)))
        end = self.status().end
        if end is None:
            raise BoardError("the machine does not know where it stands")
        return end

    def home(self) -> Triple:
        """Homes a machine that does not know where its motors are; another one stays where it is. Returns where it stands."""
        with self._moving():
            self.enable()
            if self.status().state == "Unhomed":
                self._ask(Command.Home())
            while (status := self.status()).state in ON_THE_WAY:
                self._exchange.listen(LOOK_S)
        if status.fault is not None:
            raise BoardError(status.fault)
        if status.end is None:
            raise BoardError(f"homing was given up: the machine is {status.state.lower()}")
        return status.end

    def move(self, pose: Triple) -> Triple:
        """Goes to ``pose`` on a way that the machine plans, and returns where it stands. ``NoMotion`` says why it does not."""
        with self._moving() as mover:
            end = mover.move_to(pose)
        # A goal that was refused twice in the same way looks like one that was not refused again.
        if math.dist(end, pose) > _NEAR:
            raise NoMotion(f"no motion to the goal: the machine stands at {end}")
        return end

    def probe(self, to: Triple, seconds: float, *, away: bool = False) -> Contact | None:
        """Goes straight towards ``to``, in so many seconds for the whole way, until the probe touches; ``away``: until it lets go.

        Returns where that was, ``None`` if the way ended without. ``BoardError`` and ``Refused`` say why there was no way.
        """
        with self._moving():
            return self._probe(to, seconds, away)

    def _probe(self, to: Triple, seconds: float, away: bool) -> Contact | None:
        identity = self._exchange.identity
        # A stop passes by itself.
        while (status := self._ask(Command.Status())).state.name == "Stopping":
            self._exchange.listen(LOOK_S)
        if status.end is None or status.state.name != "Idle":
            raise BoardError(f"no probing while the machine is {status.state.name.lower()}")
        x, y, alpha = to
        ticks = max(1, math.ceil(seconds * identity.tick_rate_hz))
        number, none = status.next, (0.0, 0.0, 0.0)
        goal = Pose(x=x / identity.length_m, y=y / identity.length_m, alpha=alpha)
        way = Move(
            number=number,
            from_=status.end.pose,
            to=goal,
            start_velocity=none,
            end_velocity=none,
            ticks=ticks,
            tool_power=0.0,
            tool_speed=0.0,
        )
        self._ask(Command.Move(way))
        while (status := self._ask(Command.Status())).admitted != (number + 1) % (1 << 32) and status.state.name == "Idle":
            verdict = status.refused
            if verdict is not None and verdict.number == number and verdict.violation is not None:
                raise BoardError(f"the way is not admitted: {words.violation(verdict.violation, ticks, identity)}")
            self._exchange.listen(LOOK_S)
        try:
            self._ask(Command.Probe(away=away))
        except Refused:
            # The move is no business of the next command.
            self._ask(Command.Stop())
            raise
        while True:
            status = self._ask(Command.Status())
            if status.fault is not None:
                raise BoardError(words.fault(status.fault, identity))
            if status.state.name == "Idle" and status.probe is not None and status.probe.name != "Armed":
                break
            self._exchange.listen(LOOK_S)
        if status.probe.name == "NotTouched":
            return None
        felt = status.probe.content
        length = identity.length_m

        def si(pose: Any) -> Triple:
            return (pose.x * length, pose.y * length, float(pose.alpha))

        return Contact(si(felt.pose), None if felt.measured is None else si(felt.measured), felt.tick)

    def step(self, by: Triple) -> Triple:
        """Goes so far from where it stands."""
        with self._moving() as mover:
            return mover.step(by)

    def jog(self, velocity: Triple, seconds: float) -> Triple:
        """Moves at ``velocity`` for so many seconds, then comes to rest."""
        with self._moving() as mover:
            return mover.jog(velocity, seconds)

    def follow(self, poses: Iterable[Triple], every_s: float) -> Triple:
        """Goes to each of ``poses`` in turn, a new one every so many seconds."""
        with self._moving() as mover:
            return mover.follow(poses, every_s)

    def hold(self) -> None:
        """Slows down to rest on the path; ``resume`` goes on."""
        self._ask(Command.Hold())

    def resume(self) -> None:
        """Goes on along the path after a hold."""
        self._ask(Command.Resume())

    def stop(self) -> None:
        """Comes to rest on the path and drops the moves that are left."""
        self._ask(Command.Stop())

    def feed(self, percent: int) -> None:
        """Sets the feed override, 1 to 100 percent of normal speed, in whole percent."""
        if percent != int(percent):
            raise ValueError(f"feed: {percent} is no whole number of percent")
        self._ask(Command.FeedOverride(percent=int(percent)))

    def run(
        self,
        job: str | os.PathLike[str],
        *,
        moves: str | os.PathLike[str] | None = None,
        recover_s: float | None = None,
        progress: Progress | bool | None = None,
    ) -> dict[str, list[float]]:
        """Plays the job of a scene (.toml) or a table of moves (.csv) to its end, and returns the columns of ``ticks.csv``.

        ``moves``: the moves.csv of a job along a path. ``recover_s``: bring the machine to the start of the job first, within so many
        seconds, and acknowledge a latched fault. ``progress`` hears the moves done, their number, and the state;
        ``True`` shows a bar of tqdm. ``JobError`` and ``JobFailed`` say why the job was not played, or not to its end: also after a
        ``stop`` from another thread. A machine that stands elsewhere goes to the start of the job by a way that it plans.
        """
        read = jobs.read(os.fspath(job), None if moves is None else os.fspath(moves))
        # The board's own: a scene whose number type is another is another scene, and is told as that.
        read = replace(read, number=None)
        recorder = Recorder()
        with hearing(progress) as hear:
            stream = Stream(
                self._open,
                read,
                recorder.hear,
                hear,
                answer_s=self._answer_s,
                recover_s=recover_s,
                survey=[Command.Read(SectionName.Leg(leg)) for leg in range(3)],
            )
            # Another thread sees either conversation, and opens no line beside the one of the job.
            with self._line:
                if self._job is not None:
                    raise BoardError(_UNDER_WAY)
                self._job = stream
                self._drop()
            try:
                stream.run()
                legs = [section.content.leg for section in stream.survey]
                rows = recorder.rows(stream.exchange.identity, legs, stream.exchange.numbers)
                return record.as_columns(rows, read.torque)
            finally:
                with self._line:
                    stream.exchange = None
                    try:
                        self._greet()
                    finally:
                        self._job = None

    def update(self, image: str | os.PathLike[str], *, progress: Progress | bool | None = None) -> str:
        """Replaces the program of the board by ``image``, the ELF file that ``cargo fw`` builds, as ``trirrr update`` does.

        The drives have to be off, and the scene of both programs has ``update = true`` in ``[service]``. The board tries the new program
        once, keeps it if this host can talk to it, and goes back otherwise. ``progress`` hears the bytes that the board has, their number, and
        ``Sending`` or ``Restarting``; ``True`` shows a bar of tqdm. Returns the build that runs. ``ImageError`` says what is wrong with the file,
        ``UpdateFailed`` and ``Refused`` why the new program does not run; ``PortError`` and ``Silent`` that the board is out of reach:
        it keeps its program, and the same call goes on where the line was lost.
        """
        self._bring(Program.read(os.fspath(image)), progress)
        return self.firmware

    def install(
        self, scene: str | os.PathLike[str], settings: Iterable[str] = (), *, progress: Progress | bool | None = None
    ) -> str:
        """Brings the values of ``scene`` to a board whose image takes scenes over its line, as ``trirrr install`` does.

        ``settings`` stand in place of values of the scene, such as ``"limits.rate_rad_s=3"``. The drives have to be off. Needs the native core
        of the package. The board plays the scene from its restart on; returns its name. Names of outputs and inputs are those of
        ``scene`` from then on. ``SceneError`` and ``BoardError`` say why the scene is none for this board; the others are as for ``update``.
        """
        # Here: a client of a board needs no native core.
        from .machine import scene_values

        file = os.fspath(scene)
        board, key, header, data = scene_values(file, list(settings))
        own = words.text(self._exchange.identity.firmware.board)
        # The path of a board file says nothing of the name in the image.
        if board is not None and not board.endswith(".toml") and board != own:
            raise BoardError(
                f"{file}: board = {board!r}, and the board is {own}: its pins are others; change `board` in the scene if its "
                "wiring is the same"
            )
        values = SceneValues(key, loads(SceneHeader, header, self._own.numbers), data)
        self._bring(values, progress)
        self._pins = jobs.pins(file)
        return self.name

    def _bring(self, content: Program | SceneValues, progress: Progress | bool | None) -> None:
        def reopen() -> Exchange:
            self._drop()
            # A new program may compute with other numbers.
            self._numbers = None
            self._greet()
            return self._own

        with hearing(progress, "B") as hear:
            bring(content, self._exchange, reopen, hear)

    def _greet(self) -> None:
        port = self._port = self._open()
        try:
            self._own = Exchange(port, self._numbers, _ignore, self._answer_s)
            port.send(b"\0")  # ends whatever the line held
            self._own.hello()
        except BaseException:
            self._drop()
            raise
        self._numbers = self._own.numbers

    @property
    def _exchange(self) -> Exchange:
        """The conversation of the job that is played, or the board's own."""
        while True:
            with self._line:
                if self._job is None:
                    if self._port is None:
                        if self._is_closed:
                            raise PortError("the board was closed: connect anew")
                        self._greet()
                    return self._own
                exchange: Exchange | None = self._job.exchange
            if exchange is not None and exchange.identity is not None:
                return exchange
            # Between two conversations.
            time.sleep(LOOK_S)

    @contextlib.contextmanager
    def _moving(self) -> Iterator[Mover]:
        """Moves the machine. Where the call ends before the machine is there, the machine comes to rest on its path."""
        if self._job is not None:
            raise BoardError(_UNDER_WAY)
        exchange = self._exchange
        try:
            yield Mover(exchange)
        except (KeyboardInterrupt, Interrupted):
            exchange.come_to_rest()
            raise
        except PortError:
            self._drop()
            raise

    def _ask(self, command: Value) -> Any:
        """Asks until the tick of the machine has taken the commands before."""
        while True:
            exchange = self._exchange
            try:
                return exchange.ask(command)
            except Refused as refused:
                if refused.refusal.name != "Busy":
                    raise
                exchange.listen(LOOK_S)
            except PortError:
                # A job that begins or ends in another thread has taken the line.
                with self._line:
                    if exchange is self._own and self._job is None:
                        self._drop()
                        raise
                time.sleep(LOOK_S)


async def _call(call: Callable[[], T]) -> T:
    """Runs ``call`` in a thread. A task that is cancelled ends the call, which brings the machine to rest, and waits for that."""
    end = threading.Event()
    token = CALL.set(end)
    try:
        # The thread has a copy of the context.
        running = asyncio.ensure_future(asyncio.to_thread(call))
    finally:
        CALL.reset(token)
    try:
        return await asyncio.shield(running)
    except asyncio.CancelledError:
        end.set()
        await _ended(running)
        raise


async def _uncut(call: Callable[[], T]) -> T:
    """Runs ``call`` in a thread to its end, also where the task is cancelled."""
    running = asyncio.ensure_future(asyncio.to_thread(call))
    try:
        return await asyncio.shield(running)
    except asyncio.CancelledError:
        await _ended(running)
        raise


async def _ended(running: asyncio.Future[Any]) -> None:
    """Waits for the thread, however often the task is cancelled meanwhile. What it raises, but for the end that was asked for, stands
    behind the cancellation: the machine may not have heard."""
    while not running.done():
        with contextlib.suppress(asyncio.CancelledError):
            await asyncio.wait({running})
    error = running.exception()
    if error is not None and not isinstance(error, Interrupted):
        raise asyncio.CancelledError(str(error)) from error


def _in_thread(
    method: Callable[Concatenate[Board, P], T], run: Callable[[Callable[[], T]], Coroutine[Any, Any, T]]
) -> Callable[Concatenate[AsyncBoard, P], Coroutine[Any, Any, T]]:
    """``method`` of a ``Board`` as one of its ``AsyncBoard``, with its arguments and its docs."""

    @functools.wraps(method)
    async def call(self: AsyncBoard, /, *args: P.args, **more: P.kwargs) -> T:
        return await run(functools.partial(method, self.board, *args, **more))

    return call


class AsyncBoard:
    """A ``Board`` for ``asyncio``: each call runs in a thread, so that several machines move at once, and a hold gets through.

    A task that is cancelled, and so one whose time is out (``asyncio.timeout``, ``asyncio.wait_for``), brings the machine to rest on its
    path first. ``disable``, ``hold`` and ``stop`` are sent also where the task is cancelled. The board can be used after it.
    """

    def __init__(self, board: Board) -> None:
        self.board = board

    @classmethod
    async def connect(
        cls,
        address: str,
        *,
        baud: int = 921_600,
        number: str | None = None,
        scene: str | os.PathLike[str] | None = None,
    ) -> AsyncBoard:
        """As ``Board.connect``."""
        return cls(await asyncio.to_thread(Board.connect, address, baud=baud, number=number, scene=scene))

    async def __aenter__(self) -> AsyncBoard:
        return self

    async def __aexit__(self, *_: object) -> None:
        await asyncio.to_thread(self.board.close)

    status = _in_thread(Board.status, _call)
    enable = _in_thread(Board.enable, _call)
    disable = _in_thread(Board.disable, _uncut)
    clear_fault = _in_thread(Board.clear_fault, _call)
    mount = _in_thread(Board.mount, _call)
    home = _in_thread(Board.home, _call)
    move = _in_thread(Board.move, _call)
    step = _in_thread(Board.step, _call)
    jog = _in_thread(Board.jog, _call)
    follow = _in_thread(Board.follow, _call)
    probe = _in_thread(Board.probe, _call)
    output = _in_thread(Board.output, _call)
    feed = _in_thread(Board.feed, _call)
    run = _in_thread(Board.run, _call)
    update = _in_thread(Board.update, _call)
    install = _in_thread(Board.install, _call)
    hold = _in_thread(Board.hold, _uncut)
    resume = _in_thread(Board.resume, _call)
    stop = _in_thread(Board.stop, _uncut)


def _ignore(message: Value) -> None:
    """Telemetry and events of a machine that nobody records."""


__all__ = ["AsyncBoard", "Board", "BoardError", "BoardStatus", "Contact", "Interrupted", "NoMotion"]
