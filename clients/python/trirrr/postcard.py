"""Postcard's encoding, driven by descriptions of types.

A type writes a value to bytes and reads it back. ``N`` and ``ANGLE`` stand for the machine's own
numbers; which those are is told with every value, as ``Numbers``.
"""

from __future__ import annotations

import dataclasses
import struct
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Any


class DecodeError(ValueError):
    """The bytes are no value of the type."""


class Reader:
    """Bytes, read from the front."""

    def __init__(self, data: bytes) -> None:
        self._data = data
        self._at = 0

    def take(self, count: int) -> bytes:
        """The next ``count`` bytes."""
        end = self._at + count
        if end > len(self._data):
            raise DecodeError("the message ends too early")
        taken = self._data[self._at : end]
        self._at = end
        return taken

    @property
    def left(self) -> int:
        """Bytes not read yet."""
        return len(self._data) - self._at


class Type:
    """A type of values."""

    name = "?"

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        """Appends ``value`` to ``out``."""
        raise NotImplementedError

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        """A value from the front of ``reader``."""
        raise NotImplementedError


@dataclass(frozen=True)
class Numbers:
    """The number types of a machine."""

    name: str
    number: Type
    angle: Type


class Bool(Type):
    """A truth value."""

    name = "bool"

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        out.append(1 if value else 0)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        byte = reader.take(1)[0]
        if byte > 1:
            raise DecodeError(f"{byte} is no bool")
        return byte == 1


class U8(Type):
    """A byte."""

    name = "u8"

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        if not 0 <= value < 256:
            raise ValueError(f"{value} is no u8")
        out.append(value)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return reader.take(1)[0]


class Varint(Type):
    """A whole number of 16, 32 or 64 bits, seven of them in a byte; zigzag if it has a sign."""

    def __init__(self, name: str, bits: int, signed: bool) -> None:
        self.name = name
        self.bits = bits
        self.signed = signed

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        low, high = (-(1 << self.bits - 1), 1 << self.bits - 1) if self.signed else (0, 1 << self.bits)
        if not low <= value < high:
            raise ValueError(f"{value} is no {self.name}")
        if self.signed:
            value = (value << 1) ^ (value >> self.bits - 1)
        while value >= 0x80:
            out.append(value & 0x7F | 0x80)
            value >>= 7
        out.append(value)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        value = 0
        for shift in range(0, self.bits, 7):
            byte = reader.take(1)[0]
            value |= (byte & 0x7F) << shift
            if byte < 0x80:
                break
        else:
            raise DecodeError(f"a {self.name} does not end")
        if value >> self.bits:
            raise DecodeError(f"{value} is no {self.name}")
        return (value >> 1) ^ -(value & 1) if self.signed else value


class Float(Type):
    """An IEEE 754 number, least significant byte first."""

    def __init__(self, name: str, code: str) -> None:
        self.name = name
        self._struct = struct.Struct(code)

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        out += self._struct.pack(value)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return self._struct.unpack(reader.take(self._struct.size))[0]


class Newtype(Type):
    """A value of another type that has a name of its own."""

    def __init__(self, name: str, inner: Type) -> None:
        self.name = name
        self.inner = inner

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        self.inner.write(out, value, numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return self.inner.read(reader, numbers)


class Bits(Newtype):
    """A set of names, a bit for each."""

    def __init__(self, name: str, inner: Type, names: tuple[str, ...]) -> None:
        super().__init__(name, inner)
        self.names = names

    def of(self, *names: str) -> int:
        """The bits of ``names``."""
        return sum(1 << self.names.index(name) for name in names)

    def left_out(self, bits: int) -> set[str]:
        """Names whose bits are not among ``bits``."""
        return {name for bit, name in enumerate(self.names) if not bits >> bit & 1}


class Scaled(Newtype):
    """A number of its own type, in units of ``unit``; 1 for one that is only called differently."""

    def __init__(self, name: str, inner: Type, unit: float = 1.0) -> None:
        super().__init__(name, inner)
        self._unit = unit

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        if isinstance(self.inner, Varint):
            value = round(value / self._unit)
        super().write(out, value, numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return super().read(reader, numbers) * self._unit


class _OfMachine(Type):
    """The machine's number or angle."""

    def __init__(self, name: str, pick: Callable[[Numbers], Type]) -> None:
        self.name = name
        self._pick = pick

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        self._pick(numbers).write(out, value, numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return self._pick(numbers).read(reader, numbers)


BOOL = Bool()
BYTE = U8()
U16 = Varint("u16", 16, False)
U32 = Varint("u32", 32, False)
U64 = Varint("u64", 64, False)
I32 = Varint("i32", 32, True)
I64 = Varint("i64", 64, True)
F32 = Float("f32", "<f")
F64 = Float("f64", "<d")
N = _OfMachine("N", lambda numbers: numbers.number)
ANGLE = _OfMachine("Angle", lambda numbers: numbers.angle)


class Optional(Type):
    """A value or ``None``."""

    def __init__(self, inner: Type) -> None:
        self.name = inner.name + "?"
        self.inner = inner

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        out.append(0 if value is None else 1)
        if value is not None:
            self.inner.write(out, value, numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        byte = reader.take(1)[0]
        if byte > 1:
            raise DecodeError(f"{byte} is neither none nor some")
        return self.inner.read(reader, numbers) if byte else None


class Tuple(Type):
    """Values one after the other. Those of a named tuple type come back as such."""

    def __init__(self, name: str, parts: list[Type], make: Callable[[Iterable[Any]], Any] = tuple) -> None:
        self.name = name
        self.parts = parts
        self._make = make

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        if len(value) != len(self.parts):
            raise ValueError(f"{self.name} has {len(self.parts)} values, not {len(value)}")
        for part, item in zip(self.parts, value):
            part.write(out, item, numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return self._make(part.read(reader, numbers) for part in self.parts)


def array(inner: Type, count: int) -> Tuple:
    """``count`` values of one type."""
    return Tuple(f"[{inner.name}; {count}]", [inner] * count)


class Struct(Type):
    """Named fields. Calling it makes a value: ``Hello(protocol=1, schema=..., scene=0)``.

    A field whose name is a keyword of Python has an underscore behind it here.
    """

    def __init__(self, name: str, /, **fields: Type) -> None:
        self.name = name
        self.fields = fields
        self.record = dataclasses.make_dataclass(name, list(fields), frozen=True)

    def __call__(self, *args: Any, **values: Any) -> Any:
        return self.record(*args, **values)

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        for name, kind in self.fields.items():
            kind.write(out, getattr(value, name), numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        return self.record(*(kind.read(reader, numbers) for kind in self.fields.values()))


class Sample(Struct):
    """A struct with a field ``fields``, the bits of those behind it that are there; the others are ``None``."""

    def __init__(self, name: str, bits: Bits, /, **fields: Type) -> None:
        super().__init__(name, **fields)
        self._bits = bits

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        left_out = self._bits.left_out(value.fields)
        for name, kind in self.fields.items():
            if name not in left_out:
                kind.write(out, getattr(value, name), numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        values: dict[str, Any] = dict.fromkeys(self.fields)
        left_out: set[str] = set()
        for name, kind in self.fields.items():
            if name not in left_out:
                values[name] = kind.read(reader, numbers)
            if name == "fields":
                left_out = self._bits.left_out(values[name])
        return self.record(**values)


@dataclass(frozen=True)
class Value:
    """A value of an enum: the variant's name, and its content if it has any."""

    name: str
    content: Any = None

    def __str__(self) -> str:
        return self.name if self.content is None else f"{self.name}({self.content})"


class Enum(Type):
    """One of several variants, each without content, with a type, or with fields (a ``Struct``).

    ``Command.Status()`` makes a value without content, ``Command.Move(move)`` one of a type,
    ``Command.Telemetry(every=10)`` one with fields.
    """

    def __init__(self, name: str, /, **variants: Type | None | dict[str, Type]) -> None:
        self.name = name
        self.variants = {
            variant: Struct(variant, **content) if isinstance(content, dict) else content
            for variant, content in variants.items()
        }
        self.with_fields = {name for name, content in variants.items() if isinstance(content, dict)}
        self._names = list(variants)

    def __getattr__(self, name: str) -> Any:
        variants = self.__dict__.get("variants", {})
        if name not in variants:
            raise AttributeError(name)
        content = variants[name]
        if content is None:
            return lambda: Value(name)
        if name in self.with_fields:
            return lambda **fields: Value(name, content(**fields))
        return lambda value: Value(name, value)

    def write(self, out: bytearray, value: Any, numbers: Numbers) -> None:
        U32.write(out, self._names.index(value.name), numbers)
        content = self.variants[value.name]
        if content is not None:
            content.write(out, value.content, numbers)

    def read(self, reader: Reader, numbers: Numbers) -> Any:
        index = U32.read(reader, numbers)
        if index >= len(self._names):
            raise DecodeError(f"{self.name} has no variant {index}")
        name = self._names[index]
        content = self.variants[name]
        return Value(name) if content is None else Value(name, content.read(reader, numbers))


def dumps(kind: Type, value: Any, numbers: Numbers) -> bytes:
    """``value`` as bytes."""
    out = bytearray()
    kind.write(out, value, numbers)
    return bytes(out)


def loads(kind: Type, data: bytes, numbers: Numbers) -> Any:
    """The value in ``data``, all of it. ``DecodeError`` if it is not one."""
    reader = Reader(data)
    value = kind.read(reader, numbers)
    if reader.left:
        raise DecodeError(f"{reader.left} bytes left over behind the message")
    return value
