//! Thumb instructions of 32 bits (ARMv7-M Architecture Reference Manual, A5.3, and with floating point A6).

use super::fields::{ahead, beside, field, register, signed};
use super::instruction::{Flow, Instruction, PC, Register, Registers, SP, Stack, Value};
use super::memory;

pub(super) fn decode(address: u32, first: u16, second: u16) -> Option<Instruction> {
    // Coprocessors, of which floating point is one, with and without the bit that tells `mcr2`.
    if field(first, 10, 1) == 1 && field(first, 11, 2) != 0b10 {
        return coprocessor(first, second);
    }
    match (field(first, 11, 2), field(second, 15, 1)) {
        (0b01, _) if field(first, 9, 1) == 1 => by_register(first, second),
        (0b01, _) if field(first, 6, 1) == 1 => memory::two_words(first, second),
        (0b01, _) => memory::several(first, second),
        (0b10, 0) if field(first, 9, 1) == 0 => by_constant(first, second),
        (0b10, 0) => by_binary(address, first, second),
        (0b10, _) => branch(address, first, second),
        (0b11, _) if field(first, 9, 1) == 1 => between(first, second),
        (0b11, _) => memory::one_word(address, first, second),
        _ => None,
    }
}

/// Sets `register`, which is sp or another, not pc.
fn set(to: Register, value: Value) -> Option<Instruction> {
    Some(match (to, value) {
        (SP, Value::Of(SP, plus)) => Instruction::taking(4, -plus),
        (SP, Value::Of(from, plus)) => Instruction {
            stack: Stack::Becomes(from, plus),
            ..Instruction::plain(4)
        },
        (SP | PC, _) => return None,
        _ => Instruction::giving(4, to, value),
    })
}

/// Arithmetic with a shifted register.
fn by_register(first: u16, second: u16) -> Option<Instruction> {
    let (to, from, operand) = (register(second, 8), register(first, 0), register(second, 0));
    let flags = field(first, 4, 1) == 1;
    // Shift by nothing: type, and both parts of how far.
    let is_unshifted = second & 0x70f0 == 0;
    let instruction = match (field(first, 5, 4), to) {
        // tst, teq, cmn, cmp
        (0b0000 | 0b0100 | 0b1000 | 0b1101, PC) if flags => Some(Instruction::comparing(4)),
        (0b0010, _) if from == PC && is_unshifted => set(to, Value::Of(operand, 0)),
        (0b1000, SP) if from == SP && is_unshifted => Some(Instruction {
            stack: Stack::Adds(operand),
            ..Instruction::plain(4)
        }),
        _ => set(to, Value::Other),
    };
    instruction.map(|instruction| with_flags(instruction, flags))
}

fn with_flags(instruction: Instruction, flags: bool) -> Instruction {
    Instruction {
        compares: flags,
        ..instruction
    }
}

/// The constant of twelve bits that stands for one of thirty-two (A5.3.2).
fn expanded(twelve: u32) -> u32 {
    let eight = twelve & 0xff;
    match twelve >> 8 {
        0 => eight,
        1 => eight << 16 | eight,
        2 => eight << 24 | eight << 8,
        3 => eight * 0x0101_0101,
        _ => (twelve & 0x7f | 0x80).rotate_right(twelve >> 7),
    }
}

/// Twelve bits: one of the first halfword, three and eight of the second.
fn twelve(first: u16, second: u16) -> u32 {
    (field(first, 10, 1) << 11 | field(second, 12, 3) << 8 | field(second, 0, 8)).into()
}

/// Arithmetic with a constant.
fn by_constant(first: u16, second: u16) -> Option<Instruction> {
    let (to, from) = (register(second, 8), register(first, 0));
    let flags = field(first, 4, 1) == 1;
    let constant = expanded(twelve(first, second));
    let instruction = match (field(first, 5, 4), to) {
        (0b0000 | 0b0100 | 0b1000 | 0b1101, PC) if flags => Some(Instruction::comparing(4)),
        (0b0010, _) if from == PC => set(to, Value::Constant(constant)),
        (0b1000, _) => set(to, Value::Of(from, constant as i32)),
        (0b1101, _) => set(to, Value::Of(from, (constant as i32).wrapping_neg())),
        _ => set(to, Value::Other),
    };
    instruction.map(|instruction| with_flags(instruction, flags))
}

/// Arithmetic with a constant in plain binary.
fn by_binary(address: u32, first: u16, second: u16) -> Option<Instruction> {
    let (to, from) = (register(second, 8), register(first, 0));
    let small = twelve(first, second) as i32;
    let sixteen = field(first, 0, 4) << 12 | twelve(first, second) as u16;
    match field(first, 4, 5) {
        0b00000 if from == PC => set(to, Value::Constant(beside(address, small))),
        0b00000 => set(to, Value::Of(from, small)),
        0b01010 if from == PC => set(to, Value::Constant(beside(address, -small))),
        0b01010 => set(to, Value::Of(from, -small)),
        0b00100 => set(to, Value::Constant(sixteen.into())),
        0b01100 => set(to, Value::Upper(sixteen)),
        _ => set(to, Value::Other),
    }
}

/// Branches, and what processors are told.
fn branch(address: u32, first: u16, second: u16) -> Option<Instruction> {
    let sign = u32::from(field(first, 10, 1));
    let (j1, j2) = (
        u32::from(field(second, 13, 1)),
        u32::from(field(second, 11, 1)),
    );
    let far = || {
        let (i1, i2) = (1 ^ j1 ^ sign, 1 ^ j2 ^ sign);
        let upper = u32::from(field(first, 0, 10));
        let bits = sign << 24 | i1 << 23 | i2 << 22 | upper << 12;
        ahead(
            address,
            signed(bits | u32::from(field(second, 0, 11)) << 1, 25),
        )
    };
    Some(match (field(second, 14, 1), field(second, 12, 1)) {
        (1, 1) => Instruction::going(4, Flow::Call(far())),
        (0, 1) => Instruction::going(4, Flow::Branch(far())),
        // To code that is not Thumb, of which there is none.
        (1, _) => return None,
        (0, _) if field(first, 7, 3) != 0b111 => {
            let bits = sign << 20 | j2 << 19 | j1 << 18 | u32::from(field(first, 0, 6)) << 12;
            let offset = signed(bits | u32::from(field(second, 0, 11)) << 1, 21);
            Instruction::going(4, Flow::BranchIf(ahead(address, offset)))
        }
        _ => match field(first, 4, 7) {
            // To special registers, the stack pointers among them.
            0b011_1000 | 0b011_1001 if !matches!(field(second, 0, 8), 8 | 9) => {
                Instruction::comparing(4)
            }
            // Hints and barriers.
            0b011_1010 | 0b011_1011 => Instruction::plain(4),
            0b011_1110 | 0b011_1111 => Instruction::writing(4, Registers::one(register(second, 8))),
            0b111_1111 => Instruction::going(4, Flow::Trap),
            _ => return None,
        },
    })
}

/// Arithmetic between registers: what is neither load nor store where those of one word are.
fn between(first: u16, second: u16) -> Option<Instruction> {
    let to = register(second, 8);
    match field(first, 7, 3) {
        // Multiplication: short; long, and division, which has ones in the upper field.
        0b110 => set(to, Value::Other),
        0b111 => {
            let upper = Registers::one(register(second, 12)).0 & !(1 << PC);
            Some(Instruction::writing(4, Registers(upper).with(to)))
        }
        _ => {
            let instruction = set(to, Value::Other)?;
            Some(with_flags(instruction, field(first, 4, 1) == 1))
        }
    }
}

/// Floating point: arithmetic, loads and stores, moves between it and the core.
fn coprocessor(first: u16, second: u16) -> Option<Instruction> {
    let target = register(second, 12);
    let to_core = field(first, 4, 1) == 1;
    match field(first, 8, 2) {
        // A bit of the core's for each of these: no such operation on these cores.
        0b11 => None,
        0b10 if field(second, 4, 1) == 1 && to_core => match target {
            // The flags.
            PC => Some(Instruction::comparing(4)),
            _ => set(target, Value::Other),
        },
        0b10 => Some(Instruction::plain(4)),
        // Two words at once: 00010 in five bits.
        0b00 if field(first, 5, 4) == 0b0010 => Some(match to_core {
            true => Instruction::writing(4, Registers::one(target).with(register(first, 0))),
            false => Instruction::plain(4),
        }),
        _ => Some(memory::floats(first, second)),
    }
}
