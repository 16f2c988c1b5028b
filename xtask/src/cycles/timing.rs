//! Timing tables of the cores, from their Technical Reference Manuals. `docs/cycles.md` names the tables and
//! the rules for what they leave open.

use super::operation::Kind;

/// Timing of one core.
#[derive(Clone, Copy, Debug)]
pub(super) struct Timing {
    /// Cycles of an integer operation of each of these kinds.
    pub(super) multiply_add: u64,
    pub(super) long_multiply: u64,
    pub(super) long_multiply_add: u64,
    pub(super) special: u64,
    /// Cycles beyond its own that a taken branch takes: refill of the pipeline.
    pub(super) refill: u64,
    /// The same of a call with its target in the instruction.
    pub(super) call_refill: u64,
    /// The same of a return by a load of the pc.
    pub(super) return_refill: u64,
    /// Neighbouring loads and stores overlap, and an address waits for a result (DDI 0337I, 3.3.2).
    pub(super) overlaps_accesses: bool,
}

/// ARM 100166 (Cortex-M4 r0p1), tables 3-1 and 7-1.
pub(super) const CORTEX_M4: Timing = Timing {
    multiply_add: 1,
    long_multiply: 1,
    long_multiply_add: 1,
    special: 2,
    refill: 2,
    call_refill: 2,
    return_refill: 2,
    overlaps_accesses: true,
};

/// ARM DDI 0337I (Cortex-M3 r2p1), table 3-1. Long products end early, at a cycle that is not published:
/// the longest stands here.
pub(super) const CORTEX_M3: Timing = Timing {
    multiply_add: 2,
    long_multiply: 5,
    long_multiply_add: 7,
    ..CORTEX_M4
};

/// ARM DDI 0432C (Cortex-M0 r0p0), table 3-1, with the multiplier of one cycle.
pub(super) const CORTEX_M0: Timing = Timing {
    multiply_add: 1,
    long_multiply: 1,
    long_multiply_add: 1,
    special: 4,
    refill: 2,
    call_refill: 3,
    return_refill: 3,
    overlaps_accesses: false,
};

/// ARM DDI 0484C (Cortex-M0+ r0p1), table 3-1, with the multiplier of one cycle.
pub(super) const CORTEX_M0_PLUS: Timing = Timing {
    special: 3,
    refill: 1,
    call_refill: 2,
    return_refill: 2,
    ..CORTEX_M0
};

/// Longest integer division; its time depends on the operands, in a way that is not published.
const DIVIDE: u64 = 12;

/// Division and square root of the FPU.
pub(super) const FLOAT_DIVIDE: u64 = 14;

impl Timing {
    /// Cycles of an operation by itself, without the refill of a taken branch.
    pub(super) fn cycles(&self, kind: Kind) -> u64 {
        match kind {
            Kind::Integer | Kind::Multiply | Kind::If | Kind::Float => 1,
            Kind::Branch | Kind::Call | Kind::CallRegister | Kind::JumpRegister => 1,
            Kind::Special => self.special,
            Kind::MultiplyAdd => self.multiply_add,
            Kind::LongMultiply => self.long_multiply,
            Kind::LongMultiplyAdd => self.long_multiply_add,
            Kind::Divide => DIVIDE,
            // The write buffer takes a store whose address is ready.
            Kind::Store(true) if self.overlaps_accesses => 1,
            Kind::Load | Kind::Store(_) | Kind::TableBranch => 2,
            Kind::LoadMany(count) | Kind::StoreMany(count) => 1 + u64::from(count),
            Kind::FloatMove(words) => words.into(),
            Kind::FloatMultiplyAdd => 3,
            Kind::FloatDivide => FLOAT_DIVIDE,
            Kind::FloatLoad(words) | Kind::FloatStore(words) => 1 + u64::from(words),
            Kind::FloatLoadMany(words) | Kind::FloatStoreMany(words) => 1 + u64::from(words),
        }
    }

    /// Cycles that the pipeline takes to be filled again, where the operation left its way.
    pub(super) fn refill(&self, kind: Kind) -> u64 {
        match kind {
            Kind::Call => self.call_refill,
            Kind::LoadMany(_) => self.return_refill,
            _ => self.refill,
        }
    }
}
