"""The example frames of docs/wire.md, and the line's damages."""

import re
import unittest
import zlib
from pathlib import Path

from trirrr import cobs, frames, messages, postcard
from trirrr.messages import (
    SCHEMA, Acting, Board, Bounded, Clock, Command, Event, Firmware, Hello, Identity, Message, Move, MoveBatch,
    MoveStep, JobLabel, QuinticMove, AngleReference, Refusal, Reply,
    LeastDuration, LevelPiece, LevelRange, ListedMove, Request, Start, State, Telemetry, ToolSetting, Verdict, Violation,
)
from trirrr.numbers import NUMBERS, SETPOINT, Pose, Setpoint
from trirrr.postcard import Enum, Newtype, Optional, Struct, Tuple

DOCUMENT = Path(__file__).parents[3] / "docs" / "wire.md"
F32, F64 = NUMBERS["f32"], NUMBERS["f64"]


def single(value: float) -> float:
    """The binary32 number nearest to ``value``."""
    return postcard.loads(postcard.F32, postcard.dumps(postcard.F32, value, F32), F32)


def hello(numbers) -> object:
    content = Hello(protocol=4, schema=SCHEMA[numbers.name], scene=0)
    return Request(7, Command.Hello(content))


def a_move(rounded) -> object:
    return Move(
        number=2,
        from_=Pose(*map(rounded, (0.21, 0.22, 0.15))),
        to=Pose(*map(rounded, (0.28, 0.28, 0.2))),
        start_velocity=(0.0, 0.0, 0.0),
        end_velocity=(rounded(0.1), 0.0, 0.0),
        ticks=300,
        tool_power=0.75,
        tool_speed=rounded(0.1),
    )


def move(rounded) -> object:
    return Request(300, Command.Move(a_move(rounded)))


def quintic(rounded) -> object:
    return Request(300, Command.Quintic(QuinticMove(
        common=a_move(rounded),
        start_acceleration=(0.0, 0.0, 0.0),
        end_acceleration=(0.5, 0.0, 0.0),
    )))


def moves() -> object:
    """Behind ``a_move``: a cubic with the tool off, and a quintic to rest."""
    velocity = (single(0.1), 0.0, 0.0)
    before = Setpoint(Pose(*map(single, (0.28, 0.28, 0.2))), velocity, (0.0, 0.0, 0.0))
    cubic = MoveStep(
        to=Pose(*map(single, (0.29, 0.28, 0.2))), velocity=velocity, acceleration=None, ticks=100, tool=None)
    quintic = MoveStep(
        to=Pose(*map(single, (0.3, 0.28, 0.2))),
        velocity=(0.0, 0.0, 0.0),
        acceleration=(0.0, 0.0, 0.0),
        ticks=200,
        tool=ToolSetting(power=0.75, speed=single(0.1)),
    )
    check = zlib.crc32(postcard.dumps(SETPOINT, before, F32))
    batch = MoveBatch(number=3, check=check, steps=(cubic, quintic, None, None))
    return Request(303, Command.Moves(batch))


def levels() -> object:
    """Four levels for a move, behind 1000 that were given before."""
    row = (0,) * 32
    first = (0, 85, 170, 255) + row[4:]
    return Request(303, Command.Levels(LevelPiece(first=1000, count=4, levels=(first, row, row, row))))


def listed() -> object:
    """The move of these levels, behind ``a_move``."""
    velocity = (single(0.1), 0.0, 0.0)
    before = Setpoint(Pose(*map(single, (0.28, 0.28, 0.2))), velocity, (0.0, 0.0, 0.0))
    step = MoveStep(
        to=Pose(*map(single, (0.29, 0.28, 0.2))),
        velocity=velocity,
        acceleration=None,
        ticks=100,
        tool=ToolSetting(power=0.75, speed=single(0.1)),
    )
    check = zlib.crc32(postcard.dumps(SETPOINT, before, F32))
    own = LevelRange(first=1000, count=4, offset=32_768, span=229_376)
    return Request(304, Command.Listed(ListedMove(number=3, check=check, step=step, levels=own)))


EXAMPLES = {
    "hello": (F32, Request, hello(F32)),
    "hello-f64": (F64, Request, hello(F64)),
    "identity": (F32, Message, Message.Reply(sequence=7, reply=Reply.Hello(Identity(
        protocol=4,
        schema=SCHEMA["f32"],
        scene=0x12345678,
        name=tuple(b"thesis".ljust(32, b"\0")),
        tick_rate_hz=1000.0,
        length_m=1.0,
        time_s=1.0,
        mass_kg=1.0,
        ramp_ticks=100,
        silence_ticks=1000,
        queue=256,
        window=8,
        batch=4,
        next_sequence=300,
        reference=AngleReference.Homed(),
        board=Board(timer_hz=168_000_000, clock=Clock.Crystal(), start=Start.Power()),
        levels=4096,
        firmware=Firmware(
            version=tuple(b"0.2.0".ljust(16, b"\0")),
            commit=tuple(b"13154213b7-dirty"),
            board=tuple(b"generic-f405".ljust(32, b"\0")),
            chip=tuple(b"stm32f405rg".ljust(16, b"\0")),
        ),
    )))),
    "status": (F32, Request, Request(301, Command.Status())),
    "move": (F32, Request, move(single)),
    "move-f64": (F64, Request, move(float)),
    "quintic": (F32, Request, quintic(single)),
    "moves": (F32, Request, moves()),
    "levels": (F32, Request, levels()),
    "listed": (F32, Request, listed()),
    "kept": (F32, Message, Message.Reply(sequence=304, reply=Reply.Kept(missing=303))),
    "telemetry-rate": (F32, Request, Request(302, Command.Telemetry(every=10, fields=messages.ALL_FIELDS))),
    "job": (F32, Request, Request(302, Command.Job(
        JobLabel(name=tuple(b"thesis".ljust(32, b"\0")), items=25, check=0x89ABCDEF)))),
    "done": (F32, Message, Message.Reply(sequence=300, reply=Reply.Done())),
    "out-of-sequence": (F32, Message, Message.Reply(
        sequence=315, reply=Reply.Refused(Refusal.Sequence(expected=303)))),
    "not-admitted": (F32, Message, Message.Event(Event.Verdict(Verdict(number=2, violation=Violation(
        what=Bounded.Torque(), index=1, at=0.5, value=1.25, error=0.125, limit=1.0, certain=True,
        ramp=True, shortest=LeastDuration(enough=640, too_short=639),
    ))))),
    "telemetry": (F32, Message, Message.Telemetry(Telemetry(
        tick=100_000,
        state=State.Running(),
        acting=Acting.Nothing(),
        number=2,
        at=150,
        part=0,
        lost=0,
        fields=messages.ALL_FIELDS,
        setpoint=Setpoint(
            Pose(0.25, 0.5, 0.125),
            tuple(map(single, (0.1, -0.2, 0.3))),
            (-1.0, 2.0, 0.0),
        ),
        angles=(1.5, -0.5, 3.0),
        rates=(0.5, -1.5, 0.25),
        accelerations=(10.0, -20.0, 30.0),
        torques=tuple(map(single, (0.0125, -0.03, 0.5))),
        tool=0.75,
        duration=499,
    ))),
}


#: Bytes of plain types in the schema key, by their names.
PLAIN = {
    "bool": 0x11, "u8": 0x3D, "u16": 0x83, "u32": 0xD3, "u64": 0x13, "i32": 0x0D, "i64": 0x0B, "f32": 0xEF, "f64": 0x71,
}


def shape(kind, numbers) -> bytes:
    """The bytes that a type feeds into the schema key, by "The schema key" of the document."""
    def fields(of: dict) -> bytes:
        return b"".join(name.rstrip("_").encode() + shape(each, numbers) for name, each in of.items())

    def content(name: str) -> bytes:
        of = kind.variants[name]
        if of is None:
            return b"\xb5"
        return b"\x67" + fields(of.fields) if name in kind.with_fields else b"\xdf" + shape(of, numbers)

    if kind.name in PLAIN:
        return bytes([PLAIN[kind.name]])
    match kind:
        case postcard.N:
            return shape(numbers.number, numbers)
        case postcard.ANGLE:
            return shape(numbers.angle, numbers)
        case Newtype():
            return b"\x9d" + shape(kind.inner, numbers)
        case Optional():
            return b"\x6d" + shape(kind.inner, numbers)
        case Tuple():
            return b"\xa7" + b"".join(shape(part, numbers) for part in kind.parts)
        case Struct():
            return b"\x7f" + fields(kind.fields)
        case Enum():
            return b"\xe9" + b"".join(name.encode() + content(name) for name in kind.variants)
    raise TypeError(kind)


def key(numbers) -> int:
    """FNV-1a, 64 bits."""
    state = 0xCBF2_9CE4_8422_2325
    for byte in b"trirrr" + shape(Tuple("", [Request, Message]), numbers):
        state = (state ^ byte) * 0x100_0000_01B3 % (1 << 64)
    return state


def shown() -> dict[str, tuple[bytes, bytes]]:
    """Message and frame of each example in the document."""
    pattern = r"### `([\w-]+)`\n.*?```text\nmessage:(.*?)frame:(.*?)```"
    found = re.findall(pattern, DOCUMENT.read_text(), re.S)
    return {name: (bytes.fromhex(plain), bytes.fromhex(frame)) for name, plain, frame in found}


class Examples(unittest.TestCase):
    def test_the_document_shows_these_examples(self):
        self.assertEqual(set(shown()), set(EXAMPLES))

    def test_they_are_encoded_and_decoded_byte_for_byte(self):
        for name, (plain, frame) in shown().items():
            numbers, kind, value = EXAMPLES[name]
            with self.subTest(name):
                self.assertEqual(postcard.dumps(kind, value, numbers), plain)
                self.assertEqual(frames.encode(plain), frame)
                decoder = frames.Decoder()
                self.assertEqual(list(decoder.feed(frame)), [plain])
                self.assertFalse(decoder.errors)
                self.assertEqual(postcard.loads(kind, plain, numbers), value)

    def test_the_schema_keys_are_the_documents(self):
        rows = re.findall(r"^\| (\w+) \|.*\| 0x([0-9A-F]{16}) \|$", DOCUMENT.read_text(), re.M)
        keys = {name: int(key, 16) for name, key in rows}
        self.assertEqual(keys, SCHEMA)

    def test_the_schema_keys_are_made_as_the_document_says(self):
        self.assertEqual(SCHEMA, {name: key(each) for name, each in NUMBERS.items()})


class Damages(unittest.TestCase):
    def errors(self, line: bytes) -> dict[str, int]:
        decoder = frames.Decoder(longest=64)
        self.assertEqual(list(decoder.feed(line)), [])
        # Whatever it was: the next frame is heard.
        self.assertEqual(list(decoder.feed(frames.encode(b"good"))), [b"good"])
        return dict(decoder.errors)

    def test_each_has_its_name(self):
        frame = frames.encode(b"message")
        flipped = bytes([frame[0], frame[1] ^ 4]) + frame[2:]
        for line, name in [
            (b"\0", "Empty"),
            (b"\1" * 65 + b"\0", "TooLong"),
            (cobs.encode(b"abc") + b"\0", "Truncated"),
            (frame[:-2] + b"\0", "Stuffing"),
            (flipped, "Checksum"),
        ]:
            with self.subTest(name):
                self.assertEqual(self.errors(line), {name: 1})

    def test_what_is_no_message_is_counted(self):
        listener = frames.Listener(F32)
        done = postcard.dumps(Message, Message.Reply(sequence=1, reply=Reply.Done()), F32)
        for payload in (b"\x09", done[:-1], done + b"\0", b"\0" + b"\xff" * 6):
            self.assertEqual(list(listener.feed(frames.encode(payload))), [])
        self.assertEqual(dict(listener.decoder.errors), {"Message": 3, "Trailing": 1})

    def test_a_line_full_of_noise_keeps_little(self):
        decoder = frames.Decoder(longest=64)
        for _ in range(1000):
            list(decoder.feed(b"\x55" * 100))
        self.assertLessEqual(len(decoder._bytes), 64)


class Stuffing(unittest.TestCase):
    def test_there_and_back_at_every_length(self):
        for length in (*range(10), *range(250, 262), *range(505, 515)):
            for fill in (b"\0", b"\1", b"\xff", bytes(range(256))):
                data = (fill * (length + 1))[:length]
                stuffed = cobs.encode(data)
                self.assertNotIn(0, stuffed)
                self.assertEqual(cobs.decode(stuffed), data)

    def test_the_published_vectors(self):
        # Cheshire and Baker, "Consistent Overhead Byte Stuffing", and its common examples.
        run = bytes(range(1, 255))
        for plain, stuffed in [
            (b"", b"\x01"),
            (b"\0", b"\x01\x01"),
            (b"\x11\x22\0\x33", b"\x03\x11\x22\x02\x33"),
            (b"\x11\0\0\0", b"\x02\x11\x01\x01\x01"),
            (run, b"\xff" + run),
            (b"\0" + run, b"\x01\xff" + run),
            (run + b"\xff", b"\xff" + run + b"\x02\xff"),
        ]:
            self.assertEqual(cobs.encode(plain), stuffed)
            self.assertEqual(cobs.decode(stuffed), plain)


if __name__ == "__main__":
    unittest.main()
