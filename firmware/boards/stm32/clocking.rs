//! Start of a clock: its source, its PLL, and its waits at the clock of the reset.

/// The internal oscillator, Hz.
pub(crate) const HSI_HZ: u32 = 16_000_000;

/// Reads of a ready flag before the wait ends: 100 ms at 16 MHz and some 10 cycles each. A crystal takes a few
/// ms, the PLL a third of one.
const READS: u32 = 160_000;

/// Returns `true` once `is_so` does, `false` after [`READS`] calls.
pub(crate) fn becomes(is_so: impl Fn() -> bool) -> bool {
    (0..READS).any(|_| is_so())
}

/// Settings of the PLL: the source is divided, then taken so many times.
#[derive(Clone, Copy)]
pub(crate) struct Pll {
    pub(crate) divider: u8,
    pub(crate) factor: u16,
}
