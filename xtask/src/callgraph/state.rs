//! Knowledge of stack and registers at an instruction.

use super::instruction::{Instruction, LR, PC, Register, SP, Stack, Value};
use super::program::Program;
use anyhow::{Result, bail, ensure};
use std::collections::BTreeSet;

/// Knowledge of a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Known {
    Nothing,
    Constant(u32),
    /// One of several constants: ways that set them have joined.
    OneOf(Constants),
    /// So many bytes below where the stack was at the function's entry.
    Stack(i32),
    /// This, plus something.
    From(u32),
    /// An entry of the table at this address, with so many bytes each; or twice that.
    Entry(u32, u32),
    TwiceEntry(u32, u32),
}

impl Known {
    fn plus(self, plus: i32) -> Self {
        match self {
            Self::Constant(value) => Self::Constant(value.wrapping_add_signed(plus)),
            Self::Stack(depth) => Self::Stack(depth - plus),
            _ => Self::Nothing,
        }
    }

    /// Keeps what holds of both.
    fn meet(self, other: Self) -> Self {
        match (self.constants(), other.constants()) {
            _ if self == other => self,
            (Some(one), Some(another)) => one.or(another).map_or(Self::Nothing, Self::OneOf),
            _ => Self::Nothing,
        }
    }

    /// Returns the constants that it may be.
    fn constants(self) -> Option<Constants> {
        match self {
            Self::Constant(value) => Some(Constants {
                values: [value; MOST],
                count: 1,
            }),
            Self::OneOf(constants) => Some(constants),
            _ => None,
        }
    }
}

/// Most constants of a [`Constants`].
const MOST: usize = 4;

/// Different constants in ascending order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Constants {
    /// Those behind the `count` are as the first.
    values: [u32; MOST],
    count: usize,
}

impl Constants {
    pub(super) fn iter(&self) -> impl Iterator<Item = u32> + use<> {
        self.values.into_iter().take(self.count)
    }

    /// Returns all constants of both; none if they are too many.
    fn or(self, other: Self) -> Option<Self> {
        let all: BTreeSet<u32> = self.iter().chain(other.iter()).collect();
        let mut values = [*all.first()?; MOST];
        for (nth, value) in all.iter().enumerate() {
            *values.get_mut(nth)? = *value;
        }
        Some(Self {
            values,
            count: all.len(),
        })
    }
}

/// Knowledge before an instruction.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Facts {
    /// Bytes that the stack has grown by since the function's entry.
    pub(super) depth: i32,
    registers: [Known; 16],
}

impl Facts {
    /// At a function's entry.
    pub(super) fn entry() -> Self {
        Self {
            depth: 0,
            registers: [Known::Nothing; 16],
        }
    }

    pub(super) fn get(&self, register: Register) -> Known {
        match register {
            SP => Known::Stack(self.depth),
            _ => self.registers[usize::from(register)],
        }
    }

    /// Keeps what is known on both ways, where another comes in. Returns true if it is less than before.
    ///
    /// # Errors
    /// The stack is not as deep on both.
    pub(super) fn meet(&mut self, other: &Self) -> Result<bool> {
        ensure!(
            self.depth == other.depth,
            "the stack is {} bytes deep on one way, {} on another",
            self.depth,
            other.depth
        );
        let mut changed = false;
        for (known, of_other) in self.registers.iter_mut().zip(&other.registers) {
            let met = known.meet(*of_other);
            changed |= met != *known;
            *known = met;
        }
        Ok(changed)
    }

    /// Forgets what a call may change by the calling convention: r0 to r3, r12 and lr (AAPCS32, 6.1.1).
    pub(super) fn after_call(mut self) -> Self {
        for register in [0, 1, 2, 3, 12, LR] {
            self.registers[usize::from(register)] = Known::Nothing;
        }
        self
    }

    /// Applies an instruction to what is known. Returns true if it puts the stack at its very top.
    ///
    /// # Errors
    /// What becomes of the stack is not known.
    pub(super) fn apply(&mut self, instruction: &Instruction, program: &Program) -> Result<bool> {
        let value = self.evaluate(instruction, program);
        let stack = match instruction.stack {
            Stack::Same => Known::Stack(self.depth),
            Stack::Takes(bytes) => Known::Stack(self.depth + bytes),
            Stack::Becomes(register, plus) => self.get(register).plus(plus),
            Stack::Adds(register) => match self.get(register) {
                Known::Constant(plus) => Known::Stack(self.depth).plus(plus as i32),
                _ => Known::Nothing,
            },
        };
        let restarts = match stack {
            Known::Stack(depth) => {
                self.depth = depth;
                false
            }
            Known::Constant(top) if program.stack()?.end == top && self.depth == 0 => true,
            _ => bail!("what becomes of the stack pointer is not known"),
        };
        for register in (0..PC).filter(|register| instruction.writes.contains(*register)) {
            self.registers[usize::from(register)] = value;
        }
        Ok(restarts)
    }

    fn evaluate(&self, instruction: &Instruction, program: &Program) -> Known {
        let constant = |value: Option<u32>| value.map_or(Known::Nothing, Known::Constant);
        match instruction.value {
            Value::Other => Known::Nothing,
            Value::Constant(value) => Known::Constant(value),
            Value::Of(register, plus) => self.get(register).plus(plus),
            Value::Upper(upper) => match self.get(instruction.writes.first()) {
                Known::Constant(lower) => Known::Constant(lower & 0xffff | u32::from(upper) << 16),
                _ => Known::Nothing,
            },
            Value::From(base) => Known::From(base),
            Value::Double(register) => match self.get(register) {
                Known::Entry(table, size) => Known::TwiceEntry(table, size),
                _ => Known::Nothing,
            },
            Value::Literal(address) => constant(program.word(address)),
            Value::Load(register, plus, bytes) => match self.get(register) {
                Known::Constant(base) if bytes == 4 => {
                    constant(program.word(base.wrapping_add_signed(plus)))
                }
                Known::From(base) => Known::Entry(base.wrapping_add_signed(plus), bytes),
                _ => Known::Nothing,
            },
            Value::Element(base, index, bytes) => match (self.get(base), self.get(index)) {
                (Known::Constant(table), Known::Nothing | Known::OneOf(_))
                | (Known::Nothing | Known::OneOf(_), Known::Constant(table)) => {
                    Known::Entry(table, bytes)
                }
                // On some way the index is known, too. The table is the address; all of its entries are more than that way takes.
                (Known::Constant(one), Known::Constant(other)) => {
                    Known::Entry(one.max(other), bytes)
                }
                _ => Known::Nothing,
            },
        }
    }
}
