"""The line itself: a serial port or TCP."""

from __future__ import annotations

import contextlib
import socket
from typing import Protocol

from .errors import BoardError


class PortError(BoardError, OSError):
    """The port cannot be opened, or is gone."""


#: What a machine says over TCP in place of an answer, and what it means.
_REFUSALS = {
    b"\x00\x12trirrr: key needed": "the machine expects a key: reach it through `trirrr bridge` with --key",
    b"\x00\x16trirrr: another client": (
        "another client has the machine, which takes one at a time: end that client, or wait until it has gone"
    ),
}


class Port(Protocol):
    """An open line. Once a call has failed it is gone; open a new one."""

    def send(self, data: bytes) -> None:
        """Sends all of ``data``."""

    def receive(self, timeout: float) -> bytes:
        """What has come, after at most ``timeout`` seconds; nothing if nothing came."""

    def close(self) -> None:
        """Gives the line back."""


def open_port(address: str, baud: int = 921_600) -> Port:
    """Opens ``tcp:HOST:PORT`` or a serial port by its name. ``PortError`` if that fails."""
    if address.startswith("tcp:"):
        host, colon, port = address[4:].rpartition(":")
        if not colon or not host or not port.isdigit():
            raise PortError(f"{address}: expected tcp:HOST:PORT")
        return _Tcp(address, host, int(port))
    return _Serial(address, baud)


class _Tcp:
    def __init__(self, address: str, host: str, port: int) -> None:
        try:
            self._socket = socket.create_connection((host.strip("[]"), port), timeout=5)
        except OSError as error:
            raise PortError(f"{address}: {error}") from None
        # Frames are short and each is waited for.
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._first: bytes | None = b""

    def send(self, data: bytes) -> None:
        try:
            self._socket.settimeout(5)
            self._socket.sendall(data)
        except OSError as error:
            # A machine that has closed the line may have said why.
            with contextlib.suppress(PortError, OSError):
                self._socket.settimeout(0.001)
                self._look(self._socket.recv(65536))
            raise PortError(self._why(f"the machine does not read: {error}")) from None

    def receive(self, timeout: float) -> bytes:
        try:
            self._socket.settimeout(max(timeout, 0.001))  # 0 would be another mode
            data = self._socket.recv(65536)
        except TimeoutError:
            return b""
        except OSError as error:
            raise PortError(self._why(f"the line broke: {error}")) from None
        if not data:
            raise PortError(self._why("the machine closed the line"))
        self._look(data)
        return data

    def _look(self, data: bytes) -> None:
        """Keeps the first bytes of the machine, while they may be the words of a refusal."""
        if self._first is not None:
            self._first += data
            may_be = (w.startswith(self._first) or self._first.startswith(w) for w in _REFUSALS)
            if not any(may_be):
                self._first = None

    def _why(self, else_: str) -> str:
        """What the machine has said in place of an answer, or ``else_``."""
        said = self._first or b""
        return next((why for words, why in _REFUSALS.items() if said.startswith(words)), else_)

    def close(self) -> None:
        # Ends a wait for this line in another thread, which would hold it open.
        with contextlib.suppress(OSError):
            self._socket.shutdown(socket.SHUT_RDWR)
        self._socket.close()


class _Serial:
    def __init__(self, name: str, baud: int) -> None:
        try:
            import serial
        except ImportError:
            raise PortError(f"{name}: serial ports need pyserial (pip install pyserial)") from None
        self._failure = serial.SerialException
        try:
            self._port = serial.Serial(name, baud, write_timeout=5, exclusive=True)
            self._port.reset_input_buffer()
        except (serial.SerialException, ValueError) as error:
            raise PortError(f"{name}: {error}") from None

    def send(self, data: bytes) -> None:
        try:
            self._port.write(data)
        except self._failure as error:
            raise PortError(f"the machine does not read: {error}") from None

    def receive(self, timeout: float) -> bytes:
        try:
            self._port.timeout = max(timeout, 0)
            first = self._port.read(1)
            return first + self._port.read(self._port.in_waiting) if first else b""
        except self._failure as error:
            raise PortError(f"the line broke: {error}") from None

    def close(self) -> None:
        self._port.close()
