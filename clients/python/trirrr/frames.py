"""Frames: payload, CRC-32, COBS, a zero; and the messages in them."""

from __future__ import annotations

import zlib
from collections import Counter
from collections.abc import Iterator
from typing import Any

from . import cobs, postcard
from .messages import Message, Request

_CHECKSUM = 4


def encode(payload: bytes) -> bytes:
    """The frame of ``payload``, its zero included."""
    checksum = zlib.crc32(payload).to_bytes(_CHECKSUM, "little")
    return cobs.encode(payload + checksum) + b"\0"


class Decoder:
    """Finds frames in what a line delivers, in pieces of any size.

    ``errors`` counts what was dropped, by its name in docs/wire.md. The next zero starts afresh, and
    no more than ``longest`` bytes are ever kept.
    """

    def __init__(self, longest: int = 1024) -> None:
        self.longest = longest
        self.errors: Counter[str] = Counter()
        self._bytes = bytearray()
        self._skipping = False

    def feed(self, data: bytes) -> Iterator[bytes]:
        """The payloads of the frames that ``data`` ends."""
        *ends, rest = data.split(b"\0")
        for piece in ends:
            self._append(piece)
            try:
                yield self._payload()
            except _Dropped as dropped:
                self.errors[str(dropped)] += 1
            finally:
                self.reset()
        self._append(rest)

    def reset(self) -> None:
        """Forgets the frame that is being received."""
        self._bytes.clear()
        self._skipping = False

    def _append(self, piece: bytes) -> None:
        if self._skipping or len(self._bytes) + len(piece) > self.longest:
            self._skipping = True
            self._bytes.clear()
        else:
            self._bytes += piece

    def _payload(self) -> bytes:
        if self._skipping:
            raise _Dropped("TooLong")
        if not self._bytes:
            raise _Dropped("Empty")
        try:
            data = cobs.decode(bytes(self._bytes))
        except ValueError:
            raise _Dropped("Stuffing") from None
        if len(data) <= _CHECKSUM:
            raise _Dropped("Truncated")
        payload, checksum = data[:-_CHECKSUM], data[-_CHECKSUM:]
        if zlib.crc32(payload).to_bytes(_CHECKSUM, "little") != checksum:
            raise _Dropped("Checksum")
        return payload


class _Dropped(Exception):
    pass


def request(value: Any, numbers: postcard.Numbers) -> bytes:
    """The frame of a request."""
    return encode(postcard.dumps(Request, value, numbers))


class Listener:
    """Messages out of what a line delivers."""

    def __init__(self, numbers: postcard.Numbers) -> None:
        self.numbers = numbers
        self.decoder = Decoder()

    def feed(self, data: bytes) -> Iterator[Any]:
        """The messages in ``data``; what is damaged is counted in ``decoder.errors``."""
        for payload in self.decoder.feed(data):
            reader = postcard.Reader(payload)
            try:
                message = Message.read(reader, self.numbers)
            except postcard.DecodeError:
                self.decoder.errors["Message"] += 1
                continue
            if reader.left:
                self.decoder.errors["Trailing"] += 1
                continue
            yield message
