//! Thumb instructions as the timing tables tell them apart.
//!
//! Control flow and length come from the decoder of the call graph; this file adds the kinds of
//! operations, the memory that they access and the floating-point registers that they use.

use crate::callgraph::fields::{field, register};
use crate::callgraph::instruction::{Flow, Instruction, PC, Register, SP};
use crate::callgraph::thumb::decode;

/// Kinds of operations, each with a row in the timing tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// Moves, sums, logic, shifts, comparisons, hints: whatever is not below.
    Integer,
    /// Access to a special register.
    Special,
    /// Product of 32 bits.
    Multiply,
    MultiplyAdd,
    /// Product of 64 bits.
    LongMultiply,
    LongMultiplyAdd,
    Divide,
    Load,
    /// To an address that is a register plus a constant (`true`), or two registers.
    Store(bool),
    /// Several words: so many registers.
    LoadMany(u32),
    StoreMany(u32),
    /// Branch without a link, taken or not.
    Branch,
    Call,
    CallRegister,
    JumpRegister,
    /// By an entry of a table.
    TableBranch,
    If,
    /// Sum, difference, product, conversion, comparison.
    Float,
    /// Absolute value, negation, a move between registers of the FPU or to and from it: words.
    FloatMove(u32),
    FloatMultiplyAdd,
    /// Division and square root.
    FloatDivide,
    FloatLoad(u32),
    FloatStore(u32),
    FloatLoadMany(u32),
    FloatStoreMany(u32),
}

/// An access to memory: base, index with its shift, offset.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Access {
    pub(super) base: Register,
    pub(super) index: Option<(Register, u32)>,
    pub(super) offset: i32,
    pub(super) bytes: u32,
    pub(super) is_load: bool,
}

impl Access {
    fn of(base: Register, offset: i32, bytes: u32, is_load: bool) -> Self {
        Self {
            base,
            index: None,
            offset,
            bytes,
            is_load,
        }
    }

    /// The address, from the values of the registers at the instruction.
    pub(super) fn address(&self, registers: &[u32; 16]) -> u32 {
        let base = match self.base {
            // The pc reads four bytes ahead, aligned.
            PC => registers[15].wrapping_add(4) & !3,
            base => registers[usize::from(base)],
        };
        let index = self
            .index
            .map_or(0, |(index, shift)| registers[usize::from(index)] << shift);
        base.wrapping_add(index).wrapping_add_signed(self.offset)
    }

    /// Returns true if `register` is a part of the address.
    pub(super) fn uses(&self, register: Register) -> bool {
        self.base == register || self.index.is_some_and(|(index, _)| index == register)
    }
}

/// An instruction, as far as its time depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Operation {
    pub(super) instruction: Instruction,
    pub(super) kind: Kind,
    pub(super) access: Option<Access>,
    /// Registers of the FPU that it reads and writes: bit n is `s<n>`.
    pub(super) float_reads: u32,
    pub(super) float_writes: u32,
}

impl Operation {
    /// Decodes the instruction at `address`. None: no program for these cores has it.
    pub(super) fn decode(address: u32, first: u16, second: Option<u16>) -> Option<Self> {
        let instruction = decode(address, first, second)?;
        let plain = |kind| Self {
            instruction,
            kind,
            access: None,
            float_reads: 0,
            float_writes: 0,
        };
        let flow = match instruction.flow {
            Flow::Branch(_) | Flow::BranchIf(_) | Flow::Ahead(_) => Some(Kind::Branch),
            Flow::Call(_) => Some(Kind::Call),
            Flow::CallRegister(_) => Some(Kind::CallRegister),
            Flow::JumpRegister(_) => Some(Kind::JumpRegister),
            Flow::Table(_) | Flow::TableAt(..) => Some(Kind::TableBranch),
            Flow::If { .. } => Some(Kind::If),
            Flow::Trap => return None,
            Flow::Next | Flow::Return => None,
        };
        if let Some(kind) = flow {
            return Some(plain(kind));
        }
        let with = |(kind, access)| Self {
            access,
            ..plain(kind)
        };
        match (instruction.length, second) {
            (2, _) => Some(with(narrow(first))),
            (_, Some(second)) if is_coprocessor(first) => {
                let float = Float::decode(first, second)?;
                Some(Self {
                    access: float.access,
                    float_reads: float.reads,
                    float_writes: float.writes,
                    ..plain(float.kind)
                })
            }
            (_, second) => Some(with(wide(first, second?))),
        }
    }

    /// Returns true for what the floating-point unit executes.
    pub(super) fn is_float(&self) -> bool {
        use Kind::{
            Float, FloatDivide, FloatLoad, FloatLoadMany, FloatMove, FloatMultiplyAdd, FloatStore,
            FloatStoreMany,
        };
        matches!(
            self.kind,
            Float
                | FloatDivide
                | FloatLoad(_)
                | FloatLoadMany(_)
                | FloatMove(_)
                | FloatMultiplyAdd
                | FloatStore(_)
                | FloatStoreMany(_)
        )
    }
}

type Timed = (Kind, Option<Access>);

const INTEGER: Timed = (Kind::Integer, None);

fn load(access: Access) -> Timed {
    (Kind::Load, Some(access))
}

/// A load or store at a base plus a constant.
fn at(base: Register, offset: i32, bytes: u32, is_load: bool) -> Timed {
    let access = Access::of(base, offset, bytes, is_load);
    match is_load {
        true => load(access),
        false => (Kind::Store(true), Some(access)),
    }
}

/// A load or store at the sum of two registers.
fn indexed(base: Register, index: Register, shift: u32, bytes: u32, is_load: bool) -> Timed {
    let access = Access {
        index: Some((index, shift)),
        ..Access::of(base, 0, bytes, is_load)
    };
    match is_load {
        true => load(access),
        false => (Kind::Store(false), Some(access)),
    }
}

/// Several registers from or to memory; downwards if `down`.
fn many(base: Register, count: u32, down: bool, is_load: bool) -> Timed {
    let bytes = 4 * count;
    let offset = if down { -(bytes as i32) } else { 0 };
    let kind = match is_load {
        true => Kind::LoadMany(count),
        false => Kind::StoreMany(count),
    };
    (kind, Some(Access::of(base, offset, bytes, is_load)))
}

/// Instructions of 16 bits (ARMv7-M Architecture Reference Manual, A5.2).
fn narrow(word: u16) -> Timed {
    let low = |shift| field(word, shift, 3) as Register;
    let list = field(word, 0, 8).count_ones();
    let offset = |scale: u16| i32::from(field(word, 6, 5) * scale);
    let is_load = field(word, 11, 1) == 1;
    match word >> 11 {
        0b01000 if field(word, 6, 5) == 0b01101 => (Kind::Multiply, None),
        0b01001 => load(Access::of(PC, 4 * i32::from(field(word, 0, 8)), 4, true)),
        0b01010 | 0b01011 => {
            let (bytes, is_load) = match field(word, 9, 3) {
                0 => (4, false),
                1 => (2, false),
                2 => (1, false),
                4 => (4, true),
                5 | 7 => (2, true),
                _ => (1, true),
            };
            indexed(low(3), low(6), 0, bytes, is_load)
        }
        0b01100 | 0b01101 => at(low(3), offset(4), 4, is_load),
        0b01110 | 0b01111 => at(low(3), offset(1), 1, is_load),
        0b10000 | 0b10001 => at(low(3), offset(2), 2, is_load),
        0b10010 | 0b10011 => at(SP, 4 * i32::from(field(word, 0, 8)), 4, is_load),
        // push, pop
        0b10110 if field(word, 9, 2) == 0b10 => {
            many(SP, list + u32::from(field(word, 8, 1)), true, false)
        }
        0b10111 if field(word, 9, 2) == 0b10 => {
            many(SP, list + u32::from(field(word, 8, 1)), false, true)
        }
        0b11000 | 0b11001 => many(low(8), list, false, is_load),
        _ => INTEGER,
    }
}

fn is_coprocessor(first: u16) -> bool {
    field(first, 10, 1) == 1 && field(first, 11, 2) != 0b10
}

/// Instructions of 32 bits but for floating point (A5.3).
fn wide(first: u16, second: u16) -> Timed {
    let base = register(first, 0);
    let is_load = field(first, 4, 1) == 1;
    let long = field(first, 4, 3);
    match (field(first, 11, 2), field(first, 9, 1)) {
        // Special registers: `mrs` and `msr`.
        (0b10, _) if field(second, 15, 1) == 1 => match field(first, 4, 7) {
            0b011_1000 | 0b011_1001 | 0b011_1110 | 0b011_1111 => (Kind::Special, None),
            _ => INTEGER,
        },
        (0b01, 0) if field(first, 6, 1) == 1 => two_words(first, second),
        (0b01, 0) => many(
            base,
            second.count_ones(),
            field(first, 7, 2) == 0b10,
            is_load,
        ),
        (0b11, 0) => one_word(first, second),
        (0b11, _) if field(first, 7, 2) == 0b10 => {
            let adds = register(second, 12) != PC;
            let kind = if adds {
                Kind::MultiplyAdd
            } else {
                Kind::Multiply
            };
            (kind, None)
        }
        (0b11, _) if field(first, 7, 2) == 0b11 => match long {
            0b001 | 0b011 => (Kind::Divide, None),
            0b000 | 0b010 => (Kind::LongMultiply, None),
            _ => (Kind::LongMultiplyAdd, None),
        },
        _ => INTEGER,
    }
}

/// ldrd, strd, exclusive access.
fn two_words(first: u16, second: u16) -> Timed {
    let (base, is_load) = (register(first, 0), field(first, 4, 1) == 1);
    let (index, writes_back) = (field(first, 8, 1) == 1, field(first, 5, 1) == 1);
    if !index && !writes_back {
        return at(base, 0, 4, is_load);
    }
    let offset = match index {
        true => signed_offset(first, field(second, 0, 8) * 4),
        false => 0,
    };
    let (kind, access) = many(base, 2, false, is_load);
    (kind, access.map(|access| Access { offset, ..access }))
}

/// `bytes`, by the bit of `first` that tells a sum from a difference.
fn signed_offset(first: u16, bytes: u16) -> i32 {
    match field(first, 7, 1) {
        1 => i32::from(bytes),
        _ => -i32::from(bytes),
    }
}

/// Loads and stores of one word, halfword or byte.
fn one_word(first: u16, second: u16) -> Timed {
    let (base, target) = (register(first, 0), register(second, 12));
    let (size, is_load) = (u32::from(field(first, 5, 2)), field(first, 4, 1) == 1);
    let bytes = 1 << size;
    // Preloads.
    if is_load && target == PC && size != 0b10 {
        return INTEGER;
    }
    let twelve = i32::from(field(second, 0, 12));
    let eight = i32::from(field(second, 0, 8));
    match (field(first, 7, 1), field(second, 11, 1)) {
        (0, _) if base == PC => at(base, -twelve, bytes, is_load),
        (1, _) => at(base, twelve, bytes, is_load),
        (_, 0) => {
            let shift = u32::from(field(second, 4, 2));
            indexed(base, register(second, 0), shift, bytes, is_load)
        }
        // What is written back may be added after the access: then it is at the base itself.
        _ if field(second, 10, 1) == 0 => at(base, 0, bytes, is_load),
        _ if field(second, 9, 1) == 0 => at(base, -eight, bytes, is_load),
        _ => at(base, eight, bytes, is_load),
    }
}

/// An operation of the floating-point unit (A6), single precision.
struct Float {
    kind: Kind,
    access: Option<Access>,
    reads: u32,
    writes: u32,
}

impl Float {
    fn decode(first: u16, second: u16) -> Option<Self> {
        let is_double = field(second, 8, 1) == 1;
        let is_to_core = field(first, 4, 1) == 1;
        match field(first, 8, 2) {
            0b10 if field(second, 4, 1) == 1 => Some(Self::transfer(first, second, is_to_core)),
            // An FPU without double precision has no such arithmetic.
            0b10 if is_double => None,
            0b10 => Self::arithmetic(first, second),
            0b00 if field(first, 5, 4) == 0b0010 => {
                let (x, m) = (
                    u32::from(field(second, 0, 4)),
                    u32::from(field(second, 5, 1)),
                );
                Some(Self::moving(2, run_of(x, m, is_double, 2), is_to_core))
            }
            0b00 | 0b01 => Some(Self::memory(first, second, is_double, is_to_core)),
            _ => None,
        }
    }

    fn moving(words: u32, registers: u32, reads: bool) -> Self {
        Self {
            kind: Kind::FloatMove(words),
            access: None,
            reads: if reads { registers } else { 0 },
            writes: if reads { 0 } else { registers },
        }
    }

    /// A word between the core and the unit: flags, or a register.
    fn transfer(first: u16, second: u16, is_to_core: bool) -> Self {
        let is_flags = field(first, 5, 3) == 0b111;
        let single = u32::from(field(first, 0, 4)) << 1 | u32::from(field(second, 7, 1));
        Self::moving(1, if is_flags { 0 } else { 1 << single }, is_to_core)
    }

    fn arithmetic(first: u16, second: u16) -> Option<Self> {
        let d = 1 << (u32::from(field(second, 12, 4)) << 1 | u32::from(field(first, 6, 1)));
        let n = 1 << (u32::from(field(first, 0, 4)) << 1 | u32::from(field(second, 7, 1)));
        let m = 1 << single(second, 0, 5);
        let (kind, reads, writes) = match (field(first, 7, 1), field(first, 4, 2)) {
            (0, 0b00 | 0b01) | (1, 0b01 | 0b10) => (Kind::FloatMultiplyAdd, d | n | m, d),
            (0, _) => (Kind::Float, n | m, d),
            (1, 0b00) => (Kind::FloatDivide, n | m, d),
            // A constant.
            _ if field(second, 6, 1) == 0 => (Kind::FloatMove(1), 0, d),
            _ => match (field(first, 0, 4), field(second, 7, 1)) {
                (0b0000, _) | (0b0001, 0) => (Kind::FloatMove(1), m, d),
                (0b0001, _) => (Kind::FloatDivide, m, d),
                // Comparisons, with a register and with zero.
                (0b0100, _) => (Kind::Float, d | m, 0),
                (0b0101, _) => (Kind::Float, d, 0),
                // Conversions; those of fixed point convert in place.
                (0b1010 | 0b1011 | 0b1110 | 0b1111, _) => (Kind::Float, d, d),
                (0b0010 | 0b0011 | 0b1000 | 0b1100 | 0b1101, _) => (Kind::Float, m, d),
                _ => return None,
            },
        };
        Some(Self {
            kind,
            access: None,
            reads,
            writes,
        })
    }

    fn memory(first: u16, second: u16, is_double: bool, is_load: bool) -> Self {
        let base = register(first, 0);
        let bytes = 4 * field(second, 0, 8);
        let is_one = field(first, 8, 1) == 1 && field(first, 5, 1) == 0;
        let (x, d) = (
            u32::from(field(second, 12, 4)),
            u32::from(field(first, 6, 1)),
        );
        let words = match (is_one, is_double) {
            (true, true) => 2,
            (true, false) => 1,
            (false, _) => u32::from(field(second, 0, 8)),
        };
        let registers = run_of(x, d, is_double, words);
        let offset = match (is_one, field(first, 7, 1)) {
            (true, _) => signed_offset(first, bytes),
            (false, 0) => -i32::from(bytes),
            (false, _) => 0,
        };
        let kind = match (is_one, is_load) {
            (true, true) => Kind::FloatLoad(words),
            (true, false) => Kind::FloatStore(words),
            (false, true) => Kind::FloatLoadMany(words),
            (false, false) => Kind::FloatStoreMany(words),
        };
        Self {
            kind,
            access: Some(Access::of(base, offset, 4 * words, is_load)),
            reads: if is_load { 0 } else { registers },
            writes: if is_load { registers } else { 0 },
        }
    }
}

/// The number of a single register: four bits at `shift`, and behind them the one at `last`.
fn single(word: u16, shift: u32, last: u32) -> u32 {
    u32::from(field(word, shift, 4)) << 1 | u32::from(field(word, last, 1))
}

/// So many registers from the one that four bits and a single bit name, as a double one or a single one.
fn run_of(four: u32, one: u32, is_double: bool, count: u32) -> u32 {
    let start = match is_double {
        true => (one << 4 | four) << 1,
        false => four << 1 | one,
    };
    let run = start..start + count;
    run.fold(0, |all, register| {
        all | 1_u32.checked_shl(register).unwrap_or(0)
    })
}
