"""Another program, or another scene, for a board over its line: what ``Board.update`` and ``Board.install`` say to it.

The drives of the board have to be off. Whatever is lost on the way, the board keeps what it has, or has the new one whole.
"""

from __future__ import annotations

import struct
import time
import zlib
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from . import texts
from .errors import BoardError, TrirrrError
from .exchange import Exchange, Refused, Silent
from .messages import BLOCK, Command, Firmware, ImageBlock, ImageHeader, SceneNeed, UpdateStep
from .ports import PortError
from .postcard import Value

#: Mark in front of the label of an image that is replaced over the line.
_MARK = b"trirrr image v1:"
#: Bytes of the texts in a label: version, commit, board and chip.
_LABEL = (16, 16, 32, 16)
#: Most bytes of an image: more is no file for a microcontroller.
_LARGEST = 16 << 20
#: Bytes of a part of a block.
_PART = 32
#: Time from the answer to a restart until the first hello: the board starts anew after a tenth of a second.
_RESTART_S = 0.5
#: Longest wait for a board that installs an image, and goes back if it fails: eight erasures of 2 s, twice.
_INSTALLATION_S = 60.0
#: Time from one try to open the port to the next.
_RETRY_S = 0.2
#: Times that a broken line is opened anew.
_RECONNECTS = 3
#: Needs that an image has room for, by the bits of ``SceneTypes.room``, and those that have a key there. Power lists stand between.
_NEEDS = list(SceneNeed.variants)
_ROOM, _KEYS = _NEEDS[: _NEEDS.index("PowerLists")], _NEEDS[_NEEDS.index("PowerLists") + 1 :]

#: Hears the bytes that the board has, their number, and the name of the part: ``Sending`` or ``Restarting``.
Heard = Callable[[int, int, str], None]


class ImageError(TrirrrError, ValueError):
    """The file is no image that a board takes over its line."""


class UpdateFailed(BoardError):
    """The new program, or the new scene, does not run, and why."""


@dataclass(frozen=True)
class Program:
    """Image of a board's program, as it lies in the flash."""

    #: First address.
    start: int
    data: bytes
    #: Label of the build.
    firmware: Any

    @classmethod
    def read(cls, path: str) -> Program:
        """The image in an ELF file, as ``cargo fw`` builds it. ``ImageError`` says why there is none."""
        try:
            file = Path(path).read_bytes()
        except OSError as error:
            raise ImageError(f"{path}: {error.strerror}") from None
        start, data = _segments(path, file)
        at = data.find(_MARK)
        if at < 0 or data.find(_MARK, at + 1) >= 0 or len(data) < at + len(_MARK) + sum(_LABEL):
            raise ImageError(
                f"{path}: no image that is replaced over the line: build it by `cargo fw` from a scene with "
                "update = true in [service]"
            )
        at += len(_MARK)
        texts = []
        for length in _LABEL:
            texts.append(tuple(data[at : at + length]))
            at += length
        return cls(start, data, Firmware(*texts))

    @property
    def checksum(self) -> int:
        """CRC-32 of the bytes."""
        return zlib.crc32(self.data)

    def begin(self) -> Value:
        """The step with which it begins."""
        step: Value = UpdateStep.Begin(ImageHeader(self.start, len(self.data), self.checksum, self.firmware))
        return step

    def require_room(self, status: Any) -> None:
        """The board compares the label itself."""

    def require_running(self, status: Any, identity: Any) -> None:
        """``UpdateFailed`` where the board, started anew, runs another program."""
        if status.outcome.name not in ("OnTrial", "Confirmed"):
            raise UpdateFailed("the new program failed before this host could talk to it: the board is back at its program of before")


@dataclass(frozen=True)
class SceneValues:
    """Values of a scene as they go over the line."""

    #: Key of the scene.
    key: int
    #: ``SceneHeader``.
    header: Any
    data: bytes

    @property
    def checksum(self) -> int:
        """CRC-32 of the bytes."""
        return int(self.header.checksum)

    def begin(self) -> Value:
        """The step with which they begin."""
        step: Value = UpdateStep.BeginScene(self.header)
        return step

    def require_room(self, status: Any) -> None:
        """``UpdateFailed`` where the types of the board's image lack something that the scene needs."""
        room = status.scene
        if room is None:
            raise UpdateFailed(texts.UPDATE["NoScene"])
        needed = self.header.types
        bits = needed.room & ~room.types.room
        lacks = [name for bit, name in enumerate(_ROOM) if bits >> bit & 1]
        lacks += ["PowerLists"] * (needed.levels > room.types.levels)
        lacks += [name for name, own, asked in zip(_KEYS, room.types.keys, needed.keys) if own != asked]
        if lacks:
            parts = "".join(f"\n  {texts.SCENE_NEED[name]}" for name in lacks)
            raise UpdateFailed(
                f"the board's image lacks what the scene needs:{parts}\nmake them the same as in the scene of the image, or "
                "build an image from this scene and send it by Board.update"
            )
        if room.layout != self.header.layout:
            raise UpdateFailed(texts.UPDATE["SceneLayout"])

    def require_running(self, status: Any, identity: Any) -> None:
        """``UpdateFailed`` where the board, started anew, runs another scene."""
        if identity.scene != self.key:
            raise UpdateFailed(
                "the board runs another scene after its restart: it could not build this one; send it again, by the "
                "package of the version that the board runs"
            )


def bring(content: Program | SceneValues, exchange: Exchange, reopen: Callable[[], Exchange], heard: Heard) -> None:
    """Brings ``content`` to the board of ``exchange``, and waits until it runs. ``reopen`` opens the line anew and says hello.

    ``UpdateFailed`` and ``Refused`` say why it does not run. ``PortError`` and ``Silent``: the board is out of reach, and keeps what it has.
    """
    _Transfer(content, heard).run(exchange, reopen)
    heard(len(content.data), len(content.data), "Restarting")
    time.sleep(_RESTART_S)
    exchange = _back(reopen)
    content.require_running(exchange.ask(Command.UpdateStatus()), exchange.identity)


class _Transfer:
    """The way of ``content`` into the flash of a board."""

    def __init__(self, content: Program | SceneValues, heard: Heard) -> None:
        self._content = content
        self._heard = heard
        #: All of it was sent.
        self._is_sent = False

    def run(self, exchange: Exchange | None, reopen: Callable[[], Exchange]) -> None:
        """Sends all, and lets the board start with it. A line that breaks is opened anew, and what the board has is not sent again."""
        broken = 0
        while True:
            try:
                exchange = exchange or reopen()
                if self._talk(exchange):
                    return
            except (PortError, Silent):
                broken += 1
                if broken > _RECONNECTS:
                    raise
            exchange = None

    def _talk(self, exchange: Exchange) -> bool:
        """One conversation; whether the board starts anew. It does not where it has forgotten what had begun."""
        status = exchange.ask(Command.UpdateStatus())
        self._content.require_room(status)
        is_program = isinstance(self._content, Program)
        # Where that is so the answer to the end was lost.
        if not (is_program and self._is_sent and status.outcome.name == "Requested"):
            try:
                self._fill(exchange, status)
            except Refused as refused:
                if _is_forgotten(refused):
                    return False
                raise
        try:
            _step(exchange, UpdateStep.Restart())
        except Refused as refused:
            # The answer was lost, and the board has started anew.
            if refused.refusal.name != "HelloFirst":
                raise
        except (PortError, Silent):
            # A port of the board itself goes with its restart. What runs then is asked for.
            pass
        return True

    def _fill(self, exchange: Exchange, status: Any) -> None:
        data, received = self._content.data, 0
        if status.coming == self._content.checksum:
            received = status.received
        else:
            _step(exchange, self._content.begin())
        while received < len(data):
            self._heard(received, len(data), "Sending")
            part = data[received : received + BLOCK]
            _step(exchange, UpdateStep.Block(_block(received, part)))
            received += len(part)
        self._heard(received, len(data), "Sending")
        self._is_sent = True
        _step(exchange, UpdateStep.Finish())


def _step(exchange: Exchange, step: Value) -> None:
    try:
        exchange.ask(Command.Update(step))
    except Refused as refused:
        if refused.refusal.name != "State":
            raise
        state = refused.refusal.content.name.lower()
        raise UpdateFailed(f"the machine takes it with its drives off alone, and it is {state}: disable() first") from None


def _is_forgotten(refused: Refused) -> bool:
    """Whether the board has started anew meanwhile."""
    refusal = refused.refusal
    return refusal.name == "HelloFirst" or (refusal.name == "Update" and refusal.content.name == "NotBegun")


def _block(offset: int, part: bytes) -> Any:
    padded = part.ljust(BLOCK, b"\0")
    parts = tuple(tuple(padded[at : at + _PART]) for at in range(0, BLOCK, _PART))
    return ImageBlock(offset, len(part), parts)


def _back(reopen: Callable[[], Exchange]) -> Exchange:
    """The board after its restart."""
    end = time.monotonic() + _INSTALLATION_S
    while True:
        try:
            return reopen()
        except Refused as refused:
            if refused.refusal.name not in ("Schema", "Protocol"):
                raise
            raise UpdateFailed(
                "the board's messages have another layout than this package's: talk to it by the package of its version"
            ) from None
        except (PortError, Silent):
            if time.monotonic() > end:
                raise UpdateFailed(
                    f"the board does not answer within {_INSTALLATION_S:g} s of its restart: switch it off and on, and it goes "
                    "back to its program of before"
                ) from None
            time.sleep(_RETRY_S)


def _segments(path: str, file: bytes) -> tuple[int, bytes]:
    """First address of an image, and what lies in the flash from there on."""
    if len(file) < 52 or file[:7] != b"\x7fELF\x01\x01\x01":
        raise ImageError(f"{path}: no ELF file of a 32-bit processor: give the one that `cargo fw` builds")
    (table,) = struct.unpack_from("<I", file, 28)
    size, count = struct.unpack_from("<HH", file, 42)
    parts = []
    for index in range(count):
        at = table + index * size
        if size < 32 or at + 32 > len(file):
            raise ImageError(f"{path}: its table of segments is cut off")
        kind, offset, _, address, length = struct.unpack_from("<5I", file, at)
        # Type 1: what is loaded.
        if kind == 1 and length:
            if offset + length > len(file):
                raise ImageError(f"{path}: a segment is cut off")
            parts.append((address, file[offset : offset + length]))
    parts.sort()
    start = parts[0][0] if parts else 0
    content = bytearray()
    for address, part in parts:
        gap = address - start - len(content)
        if not 0 <= gap < _LARGEST:
            raise ImageError(f"{path}: its segments overlap, or lie too far apart for one flash")
        # Between segments the flash stays erased.
        content += b"\xff" * gap + part
    return start, bytes(content)
