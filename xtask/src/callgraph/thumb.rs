//! Thumb instructions of 16 bits (ARMv7-M Architecture Reference Manual, A5.2).

use super::fields::{ahead, beside, field, register, signed};
use super::instruction::{Flow, Instruction, PC, Register, Registers, SP, Stack, Value};
use super::wide;

/// Decodes the instruction at `address`, whose halfwords are `first` and, where there is one more,
/// `second`. None: it is none that a program for these cores has.
pub(crate) fn decode(address: u32, first: u16, second: Option<u16>) -> Option<Instruction> {
    match first >> 11 {
        0b11101..=0b11111 => wide::decode(address, first, second?),
        _ => narrow(address, first),
    }
}

/// A number of three bits.
fn low(word: u16, shift: u32) -> Register {
    field(word, shift, 3) as Register
}

fn narrow(address: u32, word: u16) -> Option<Instruction> {
    let eight = field(word, 0, 8);
    Some(match word >> 11 {
        // lsls by nothing is movs.
        0b00000 if field(word, 6, 5) == 0 => {
            Instruction::giving(2, low(word, 0), Value::Of(low(word, 3), 0))
        }
        0b00000 if field(word, 6, 5) == 1 => {
            Instruction::giving(2, low(word, 0), Value::Double(low(word, 3)))
        }
        0b00000..=0b00010 => Instruction::writing(2, Registers::one(low(word, 0))),
        0b00011 => {
            let (source, three) = (low(word, 3), i32::from(field(word, 6, 3)));
            let value = match field(word, 9, 2) {
                0b10 => Value::Of(source, three),
                0b11 => Value::Of(source, -three),
                _ => Value::Other,
            };
            Instruction::giving(2, low(word, 0), value)
        }
        0b00100 => Instruction::giving(2, low(word, 8), Value::Constant(eight.into())),
        0b00101 => Instruction::comparing(2),
        0b00110 => Instruction::giving(2, low(word, 8), Value::Of(low(word, 8), eight.into())),
        0b00111 => Instruction::giving(2, low(word, 8), Value::Of(low(word, 8), -i32::from(eight))),
        0b01000 => return operation(address, word),
        0b01001 => {
            let literal = beside(address, 4 * i32::from(eight));
            Instruction::giving(2, low(word, 8), Value::Literal(literal))
        }
        0b01010 | 0b01011 => {
            let element = |bytes| {
                let value = Value::Element(low(word, 3), low(word, 6), bytes);
                Instruction::giving(2, low(word, 0), value)
            };
            match field(word, 9, 3) {
                0..=2 => Instruction::plain(2),
                4 => element(4),
                5 => element(2),
                6 => element(1),
                _ => Instruction::writing(2, Registers::one(low(word, 0))),
            }
        }
        0b01101 => load(word, 4),
        0b01111 => load(word, 1),
        0b10001 => load(word, 2),
        0b01100 | 0b01110 | 0b10000 | 0b10010 => Instruction::plain(2),
        0b10011 => Instruction::writing(2, Registers::one(low(word, 8))),
        0b10100 => {
            let constant = beside(address, 4 * i32::from(eight));
            Instruction::giving(2, low(word, 8), Value::Constant(constant))
        }
        0b10101 => Instruction::giving(2, low(word, 8), Value::Of(SP, 4 * i32::from(eight))),
        0b10110 | 0b10111 => return miscellaneous(address, word),
        0b11000 => Instruction::writing(2, Registers::one(low(word, 8))),
        0b11001 => Instruction::writing(2, Registers(eight).with(low(word, 8))),
        0b11010 | 0b11011 => match field(word, 8, 4) {
            0b1110 => Instruction::going(2, Flow::Trap),
            // A supervisor call would be a handler's entry, which no program here has.
            0b1111 => return None,
            _ => {
                let offset = signed(u32::from(eight) << 1, 9);
                Instruction::going(2, Flow::BranchIf(ahead(address, offset)))
            }
        },
        0b11100 => {
            let offset = signed(u32::from(field(word, 0, 11)) << 1, 12);
            Instruction::going(2, Flow::Branch(ahead(address, offset)))
        }
        _ => return None,
    })
}

/// Loads so many bytes, at a register's value plus a multiple of them.
fn load(word: u16, bytes: u32) -> Instruction {
    let offset = u32::from(field(word, 6, 5)) * bytes;
    let value = Value::Load(low(word, 3), offset as i32, bytes);
    Instruction::giving(2, low(word, 0), value)
}

/// Between registers: 010000 and 010001.
fn operation(address: u32, word: u16) -> Option<Instruction> {
    let (to, from) = (
        low(word, 0) | (field(word, 7, 1) << 3) as Register,
        register(word, 3),
    );
    Some(match field(word, 6, 5) {
        // tst, cmp, cmn
        0b01000 | 0b01010 | 0b01011 => Instruction::comparing(2),
        0b00000..=0b01111 => Instruction::writing(2, Registers::one(low(word, 0))),
        0b10000..=0b10011 => match to {
            SP => Instruction {
                stack: Stack::Adds(from),
                ..Instruction::plain(2)
            },
            PC => Instruction::going(2, Flow::Ahead(from)),
            _ if from == PC => Instruction::giving(2, to, Value::From(ahead(address, 0))),
            _ => Instruction::writing(2, Registers::one(to)),
        },
        0b10100..=0b10111 => Instruction::comparing(2),
        0b11000..=0b11011 => match to {
            SP => Instruction {
                stack: Stack::Becomes(from, 0),
                ..Instruction::plain(2)
            },
            PC => Instruction::going(2, Flow::JumpRegister(from)),
            _ => Instruction::giving(2, to, Value::Of(from, 0)),
        },
        0b11100 | 0b11101 => Instruction::going(2, Flow::JumpRegister(from)),
        _ => Instruction::going(2, Flow::CallRegister(from)),
    })
}

/// 1011.
fn miscellaneous(address: u32, word: u16) -> Option<Instruction> {
    let seven = 4 * i32::from(field(word, 0, 7));
    let list = Registers(field(word, 0, 8));
    Some(match field(word, 8, 4) {
        0b0000 if field(word, 7, 1) == 0 => Instruction::taking(2, -seven),
        0b0000 => Instruction::taking(2, seven),
        // cbz and cbnz
        0b0001 | 0b0011 | 0b1001 | 0b1011 => {
            let offset = (field(word, 9, 1) << 6 | field(word, 3, 5) << 1).into();
            Instruction::going(2, Flow::BranchIf(ahead(address, offset)))
        }
        // sxth, sxtb, uxth, uxtb
        0b0010 => Instruction::writing(2, Registers::one(low(word, 0))),
        0b0100 => Instruction::taking(2, list.bytes()),
        0b0101 => Instruction::taking(2, list.bytes() + 4),
        // cps
        0b0110 if field(word, 5, 3) == 0b011 => Instruction::plain(2),
        // rev, rev16, revsh
        0b1010 if field(word, 6, 2) != 0b10 => {
            Instruction::writing(2, Registers::one(low(word, 0)))
        }
        0b1100 => Instruction {
            writes: list,
            ..Instruction::taking(2, -list.bytes())
        },
        0b1101 => Instruction {
            flow: Flow::Return,
            writes: list,
            ..Instruction::taking(2, -list.bytes() - 4)
        },
        0b1110 => Instruction::going(2, Flow::Trap),
        // Hints: nop, wfi and the like.
        0b1111 if field(word, 0, 4) == 0 => Instruction::plain(2),
        0b1111 => Instruction::going(2, depending(register(word, 4), field(word, 0, 4))),
        _ => return None,
    })
}

/// `it`: the mask's lowest one ends it; above it stands for each instruction behind the first whether it has
/// the lowest bit of the condition, as the first has.
fn depending(condition: u8, mask: u16) -> Flow {
    let count = 4 - mask.trailing_zeros() as u8;
    let then =
        (1..count).filter(|nth| field(mask, 4 - u32::from(*nth), 1) == u16::from(condition) % 2);
    Flow::If {
        condition,
        count,
        then: then.fold(1, |then, nth| then | 1 << nth),
    }
}
