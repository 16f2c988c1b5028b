"""Updates and installations: a board of tests on TCP that answers as the boot loader's program does."""

import importlib.util
import socket
import struct
import tempfile
import threading
import unittest
import zlib
from dataclasses import replace
from pathlib import Path

from programs import SCENES, Device
from trirrr import Board, BoardError, ImageError, SceneError, UpdateFailed, words
from trirrr.exchange import Refused
from trirrr.frames import Decoder
from trirrr.frames import encode as frame
from trirrr.numbers import NUMBERS
from trirrr.messages import Message, Refusal, Reply, Request, SceneHeader, SceneRoom, State
from trirrr.messages import UpdateOutcome, UpdateRefusal, UpdateStatus
from trirrr.postcard import Reader, Value, dumps, loads
from trirrr.update import Program

F64 = NUMBERS["f64"]


def label(board: str = "feather-f405") -> bytes:
    texts = [("0.3.0", 16), ("13154213b7", 16), (board, 32), ("stm32f405rg", 16)]
    return b"trirrr image v1:" + b"".join(text.encode().ljust(room, b"\0") for text, room in texts)


def elf(*segments: tuple[int, bytes]) -> bytes:
    """An ELF file of segments without sections."""
    header = b"\x7fELF\x01\x01\x01".ljust(16, b"\0") + struct.pack(
        "<HHIIIIIHHHHHH", 2, 40, 1, 0x0802_0001, 52, 0, 0, 52, 32, len(segments), 40, 0, 0
    )
    table, content, at = b"", b"", 52 + 32 * len(segments)
    for address, data in segments:
        table += struct.pack("<8I", 1, at, address, address, len(data), len(data), 4, 4)
        content += data
        at += len(data)
    return header + table + content


class BoardOfTests:
    """The end of a board in a thread: says hello, and takes an image or a scene."""

    def __init__(self) -> None:
        # What a machine says of itself is that of a simulator, but for its update.
        with Device("thesis.toml") as address, Board.connect(address) as board:
            self.identity = board._exchange.identity
        self.outcome = "Never"
        self.after_restart = "Confirmed"
        self.room = None
        self.refuses: dict[str, Value] = {}
        self.coming: int | None = None
        self.received = b""
        self.blocks = 0
        #: Blocks after which the line breaks, once.
        self.breaks_after: int | None = None
        #: The line breaks before the answer to the end, once.
        self.loses_finish = False
        #: The board starts anew before it answers.
        self.loses_restart = False
        self.adopts = True
        self.begun: list[Value] = []
        self._server = socket.create_server(("127.0.0.1", 0))
        self.address = f"tcp:127.0.0.1:{self._server.getsockname()[1]}"
        threading.Thread(target=self._serve, daemon=True).start()

    def close(self) -> None:
        self._server.close()

    def _serve(self) -> None:
        while True:
            try:
                line, _ = self._server.accept()
            except OSError:
                return
            with line:
                self._talk(line)

    def _talk(self, line: socket.socket) -> None:
        decoder = Decoder()
        while data := self._take(line):
            for payload in decoder.feed(data):
                try:
                    request = Request.read(Reader(payload), F64)
                except ValueError:
                    continue
                reply = self.answer(request)
                if reply is None:
                    return
                message = Message.Reply(sequence=request.sequence, reply=reply)
                try:
                    line.sendall(frame(dumps(Message, message, F64)))
                except OSError:
                    return

    def _take(self, line: socket.socket) -> bytes:
        try:
            return line.recv(4096)
        except OSError:
            return b""

    def answer(self, request) -> Value | None:
        command = request.command
        if command.name == "Hello":
            return Reply.Hello(replace(self.identity, next_sequence=0))
        if command.name == "UpdateStatus":
            outcome = getattr(UpdateOutcome, self.outcome)()
            status = UpdateStatus(0x0802_0000, 1 << 18, self.coming, len(self.received), outcome, self.room)
            return Reply.Update(status)
        assert command.name == "Update", command
        step = command.content
        if step.name in self.refuses:
            return Reply.Refused(self.refuses[step.name])
        if step.name in ("Begin", "BeginScene"):
            self.begun.append(step)
            self.coming, self.received = step.content.checksum, b""
        elif step.name == "Block":
            block = step.content
            if block.offset != len(self.received):
                return Reply.Refused(Refusal.Update(UpdateRefusal.Block(expected=len(self.received))))
            self.received += bytes(byte for part in block.bytes for byte in part)[: block.count]
            self.blocks += 1
            if self.blocks == self.breaks_after:
                return None
        elif step.name == "Finish":
            assert zlib.crc32(self.received) == self.coming
            self.outcome, self.coming = "Requested", None
            if self.loses_finish:
                self.loses_finish = False
                return None
        elif step.name == "Restart":
            self.outcome = self.after_restart
            if self.begun[-1].name == "BeginScene" and self.adopts:
                self.identity = replace(self.identity, scene=self.key)
            if self.loses_restart:
                return None
        return Reply.Done()


class WithBoard(unittest.TestCase):
    def setUp(self) -> None:
        self.end = BoardOfTests()
        self.addCleanup(self.end.close)
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.folder = Path(folder.name)

    def image(self, *segments: tuple[int, bytes]) -> Path:
        path = self.folder / "image.elf"
        path.write_bytes(elf(*segments))
        return path


class Updates(WithBoard):
    def setUp(self) -> None:
        super().setUp()
        self.content = bytes(range(100)) + label() + b"\xff" * 900
        self.file = self.image((0x0802_0000, self.content))

    def test_a_board_takes_an_image_and_runs_it(self) -> None:
        heard: list[tuple[int, int, str]] = []
        with Board.connect(self.end.address) as board:
            runs = board.update(self.file, progress=lambda *now: heard.append(now))
            self.assertEqual(runs, board.firmware)
            board.update(self.file)
        self.assertEqual(self.end.received, self.content)
        header = self.end.begun[0].content
        self.assertEqual((header.start, header.length), (0x0802_0000, len(self.content)))
        self.assertEqual(words.firmware(header.firmware), "0.3.0, commit 13154213b7, board feather-f405, chip stm32f405rg")
        done = [now[0] for now in heard]
        self.assertEqual(done, sorted(done))
        self.assertEqual({now[1] for now in heard}, {len(self.content)})
        self.assertEqual([now[2] for now in heard].index("Restarting"), len(heard) - 1)

    def test_it_goes_on_where_the_line_was_lost(self) -> None:
        self.end.breaks_after = 3
        self.end.loses_finish = True
        self.end.loses_restart = True
        with Board.connect(self.end.address) as board:
            board.update(self.file)
        self.assertEqual(self.end.received, self.content)
        self.assertEqual((self.end.blocks, len(self.end.begun)), (-(-len(self.content) // 128), 1))

    def test_why_it_does_not_run_is_said(self) -> None:
        with Board.connect(self.end.address) as board:
            self.end.refuses = {"Begin": Refusal.Update(UpdateRefusal.Chip())}
            with self.assertRaisesRegex(Refused, "the image is for another chip"):
                board.update(self.file)
            self.end.refuses = {"Finish": Refusal.Update(UpdateRefusal.Checksum(found=0xAB))}
            with self.assertRaisesRegex(Refused, "has the checksum 0x000000ab and not its own"):
                board.update(self.file)
            self.end.refuses = {"Begin": Refusal.State(State.Idle())}
            self.end.coming = None
            with self.assertRaisesRegex(UpdateFailed, r"it is idle: disable\(\) first"):
                board.update(self.file)
            self.end.refuses, self.end.after_restart = {}, "Reverted"
            with self.assertRaisesRegex(UpdateFailed, "back at its program of before"):
                board.update(self.file)
            # The line is open.
            self.assertIn("simulator", board.firmware)
        with Device("thesis.toml") as address, Board.connect(address) as board:
            with self.assertRaisesRegex(Refused, "a simulator has no flash"):
                board.update(self.file)

    def test_what_lies_in_the_flash_is_the_image(self) -> None:
        # In any order, with a gap.
        found = Program.read(str(self.image((0x0802_0070 + 6, b"def"), (0x0802_0000, label() + b"abcd"))))
        data = label() + b"abcd"
        self.assertEqual((found.start, found.data), (0x0802_0000, data + b"\xff" * (0x76 - len(data)) + b"def"))

    def test_what_is_no_image_is_refused_with_what_to_do(self) -> None:
        with Board.connect(self.end.address) as board:
            for segments, reason in [
                ([(0x0802_0000, b"abcd")], r"image.elf: .*update = true in \[service\]"),
                ([(0x0802_0000, label() + label())], "no image that is replaced"),
                ([(0x0802_0000, b"abcd"), (0x0802_0002, b"def")], "segments overlap"),
            ]:
                with self.assertRaisesRegex(ImageError, reason):
                    board.update(self.image(*segments))
            text = self.folder / "text.elf"
            text.write_text("text")
            with self.assertRaisesRegex(ImageError, "give the one that `cargo fw` builds"):
                board.update(text)
            whole = elf((0x0802_0000, label()))
            text.write_bytes(whole[:-1])
            with self.assertRaisesRegex(ImageError, "a segment is cut off"):
                board.update(text)
            with self.assertRaisesRegex(ImageError, "No such file"):
                board.update(self.folder / "none.elf")
        self.assertEqual(self.end.begun, [])


@unittest.skipIf(importlib.util.find_spec("trirrr._native") is None, "the native core is not built")
class Installations(WithBoard):
    def setUp(self) -> None:
        super().setUp()
        from trirrr.machine import scene_values

        self.scene = SCENES / "thesis.toml"
        _, self.end.key, header, self.values = scene_values(str(self.scene), ["tick_rate_hz=1000"])
        self.header = loads(SceneHeader, header, F64)
        self.end.room = SceneRoom(4000, self.header.layout, self.header.types)

    def test_a_board_takes_a_scene_and_tells_its_key(self) -> None:
        with Board.connect(self.end.address) as board:
            self.assertEqual(board.install(self.scene, ["tick_rate_hz=1000"]), "thesis")
            self.assertEqual(self.end.received, self.values)
            self.assertEqual(zlib.crc32(self.values), self.header.checksum)
            self.end.adopts, self.end.identity = False, replace(self.end.identity, scene=1)
            with self.assertRaisesRegex(UpdateFailed, "the board runs another scene"):
                board.install(self.scene, ["tick_rate_hz=1000"])

    def test_what_the_image_lacks_is_named_before_anything_is_sent(self) -> None:
        types = self.header.types
        with Board.connect(self.end.address) as board:
            lacking = replace(types, room=0)
            self.end.room = replace(self.end.room, types=lacking)
            reason = r"lacks what the scene needs:\n  torques [^\n]*\n(  [^\n]*\n)*  its tick rate \(tick_rate_hz\)\nmake them"
            with self.assertRaisesRegex(UpdateFailed, reason):
                board.install(self.scene)
            self.end.room = replace(self.end.room, types=types, layout=1)
            with self.assertRaisesRegex(UpdateFailed, "does not read the values"):
                board.install(self.scene, ["tick_rate_hz=1000"])
            self.end.room = None
            with self.assertRaisesRegex(UpdateFailed, "scene_over_line = true"):
                board.install(self.scene)
            other = self.folder / "other.toml"
            other.write_text('board = "pico"\n' + self.scene.read_text())
            with self.assertRaisesRegex(BoardError, r"other.toml: board = 'pico', and the board is"):
                board.install(other)
            with self.assertRaises(SceneError):
                board.install(self.scene, ["tick_rate_hz=0"])
        self.assertEqual(self.end.begun, [])


if __name__ == "__main__":
    unittest.main()
