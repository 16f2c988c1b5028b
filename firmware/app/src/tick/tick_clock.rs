//! SysTick as the clock of the control tick: the counter reaches 0 at each tick.

use crate::scene::TICK_RATE_HZ;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};

/// Longest period, counts: the counter has 24 bits.
const LONGEST: f64 = 16_777_216.0;

/// Clock of the tick.
pub struct TickClock {
    period: u32,
}

impl TickClock {
    /// Starts SysTick with an interrupt every `period` counts of the core's clock, from [`period`].
    pub fn start(mut systick: SYST, period: u32) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(period - 1);
        systick.clear_current();
        systick.enable_interrupt();
        systick.enable_counter();
        Self { period }
    }

    /// Counts from one tick to the next.
    #[inline]
    pub(crate) fn period(&self) -> u32 {
        self.period
    }

    /// Counts since the present tick was due. More than a period if the next tick is due too.
    #[inline]
    pub(crate) fn elapsed(&self) -> u32 {
        let early = self.period - 1 - SYST::get_current();
        match SCB::is_pendst_pending() {
            false => early,
            // Read again: the counter may have started anew between both reads.
            true => self.period + (self.period - 1 - SYST::get_current()),
        }
    }
}

/// Counts of a core clock of `core_hz` in a tick of the scene, for constants.
///
/// # Panics
/// A tick of fewer than 2 or more than 2^24 counts.
pub const fn period(core_hz: u32) -> u32 {
    let counts = core_hz as f64 / TICK_RATE_HZ;
    assert!(
        counts >= 2.0 && counts <= LONGEST,
        "tick_rate_hz of the scene: a tick has to last from 2 to 2^24 counts of this board's clock"
    );
    (counts + 0.5) as u32
}
