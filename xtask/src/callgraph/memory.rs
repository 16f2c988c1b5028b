//! Loads and stores of 32 bits (ARMv7-M Architecture Reference Manual, A5.3.5 to A5.3.10, A6.5).

use super::fields::{beside, field, register};
use super::instruction::{Flow, Instruction, PC, Register, Registers, SP, Stack, Value};

/// Changes `base` by `offset` if it `writes` it back, besides what `instruction` does.
fn with_base(instruction: Instruction, base: Register, writes: bool, offset: i32) -> Instruction {
    match (writes, base) {
        (false, _) => instruction,
        (true, SP) => Instruction {
            stack: Stack::Takes(-offset),
            ..instruction
        },
        (true, _) => Instruction {
            writes: instruction.writes.with(base),
            value: Value::Other,
            ..instruction
        },
    }
}

/// `bytes`, with the sign that bit `shift` of `word` is: one adds them.
fn offset(word: u16, shift: u32, bytes: u16) -> i32 {
    match field(word, shift, 1) {
        1 => bytes.into(),
        _ => -i32::from(bytes),
    }
}

/// ldm, stm, push, pop.
pub(super) fn several(first: u16, second: u16) -> Option<Instruction> {
    let base = register(first, 0);
    let (loads, writes_back) = (field(first, 4, 1) == 1, field(first, 5, 1) == 1);
    let list = Registers(second);
    let offset = match field(first, 7, 2) {
        0b01 => list.bytes(),
        0b10 => -list.bytes(),
        _ => return None,
    };
    let instruction = match (loads, list.contains(PC)) {
        (true, true) if base == SP => Instruction {
            flow: Flow::Return,
            ..Instruction::writing(4, Registers(second & 0x5fff))
        },
        (_, true) => return None,
        (true, false) => Instruction::writing(4, list),
        (false, false) => Instruction::plain(4),
    };
    Some(with_base(instruction, base, writes_back, offset))
}

/// ldrd, strd, exclusive access, table branch.
pub(super) fn two_words(first: u16, second: u16) -> Option<Instruction> {
    let (base, loads) = (register(first, 0), field(first, 4, 1) == 1);
    let (index, writes_back) = (field(first, 8, 1) == 1, field(first, 5, 1) == 1);
    if index || writes_back {
        let offset = offset(first, 7, 4 * field(second, 0, 8));
        let instruction = match loads {
            true => {
                let pair = Registers::one(register(second, 12)).with(register(second, 8));
                Instruction::writing(4, pair)
            }
            false => Instruction::plain(4),
        };
        return Some(with_base(instruction, base, writes_back, offset));
    }
    let target = Registers::one(register(second, 12));
    Some(match (field(first, 7, 1), loads, field(second, 4, 4)) {
        (0, false, _) => Instruction::writing(4, Registers::one(register(second, 8))),
        (0, true, _) => Instruction::writing(4, target),
        (_, false, 0b0100 | 0b0101) => Instruction::writing(4, Registers::one(register(second, 0))),
        (_, true, 0b0100 | 0b0101) => Instruction::writing(4, target),
        (_, true, 0b0000) if base == PC => Instruction::going(4, Flow::Table(1)),
        (_, true, 0b0001) if base == PC => Instruction::going(4, Flow::Table(2)),
        (_, true, 0b0000) => Instruction::going(4, Flow::TableAt(base, 1)),
        (_, true, 0b0001) => Instruction::going(4, Flow::TableAt(base, 2)),
        _ => return None,
    })
}

/// Loads and stores of one word, halfword or byte.
pub(super) fn one_word(address: u32, first: u16, second: u16) -> Option<Instruction> {
    let (base, target) = (register(first, 0), register(second, 12));
    let (size, loads) = (field(first, 5, 2), field(first, 4, 1) == 1);
    let is_long = field(first, 7, 1) == 1;
    let (offset, writes_back, is_direct) = match (is_long || base == PC, field(second, 11, 1)) {
        (true, _) if base == PC && !is_long => (-i32::from(field(second, 0, 12)), false, true),
        (true, _) => (field(second, 0, 12).into(), false, true),
        (false, 0) => (0, false, false),
        (false, _) => {
            let offset = offset(second, 9, field(second, 0, 8));
            // What is written back may be added after the access: then it is at the base itself.
            (offset, field(second, 8, 1) == 1, field(second, 10, 1) == 1)
        }
    };
    let value = match (size, is_direct && !writes_back) {
        (0b10, true) if base == PC => Value::Literal(beside(address, offset)),
        (0b10, true) => Value::Load(base, offset, 4),
        _ => Value::Other,
    };
    let instruction = match (size, loads, target) {
        (0b11, ..) => return None,
        (_, false, _) => Instruction::plain(4),
        (0b10, true, PC) if base == SP && writes_back => Instruction::going(4, Flow::Return),
        (0b10, true, PC) => return None,
        // Preloads.
        (_, true, PC) => return Some(Instruction::plain(4)),
        (_, true, SP) => return None,
        (_, true, _) => Instruction::giving(4, target, value),
    };
    Some(with_base(instruction, base, writes_back, offset))
}

/// Loads and stores of floating-point registers.
pub(super) fn floats(first: u16, second: u16) -> Instruction {
    let offset = offset(first, 7, 4 * field(second, 0, 8));
    let writes_back = field(first, 5, 1) == 1;
    with_base(
        Instruction::plain(4),
        register(first, 0),
        writes_back,
        offset,
    )
}
