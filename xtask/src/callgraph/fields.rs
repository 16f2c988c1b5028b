//! Fields of Thumb instructions, and the addresses that they give.

use super::instruction::Register;

/// `bits` of them from `word` at `shift`.
pub(crate) fn field(word: u16, shift: u32, bits: u32) -> u16 {
    (word >> shift) & ((1 << bits) - 1)
}

/// The same as a register's number.
pub(crate) fn register(word: u16, shift: u32) -> Register {
    field(word, shift, 4) as Register
}

/// The lower `bits` of `value`, with their sign.
pub(crate) fn signed(value: u32, bits: u32) -> i32 {
    let unused = 32 - bits;
    ((value << unused) as i32) >> unused
}

/// Returns what an instruction at `address` sees as pc, plus `offset`, for a branch.
pub(crate) fn ahead(address: u32, offset: i32) -> u32 {
    address.wrapping_add(4).wrapping_add_signed(offset)
}

/// The same where it is aligned, for what it loads.
pub(crate) fn beside(address: u32, offset: i32) -> u32 {
    (address.wrapping_add(4) & !3).wrapping_add_signed(offset)
}
