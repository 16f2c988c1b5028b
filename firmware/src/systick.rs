//! SysTick as the clock of the control tick: it counts down to 0 at each tick.

use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{SCB, SYST};
use trirrr_station::scene::TICK_RATE_HZ;

/// Largest period: 24 bits.
const LONGEST: f64 = 16_777_216.0;

/// The clock of the tick.
pub(crate) struct TickClock {
    period: u32,
}

impl TickClock {
    /// Starts it at the scene's rate; `period`: from [`period`].
    pub(crate) fn start(mut systick: SYST, period: u32) -> Self {
        systick.set_clock_source(SystClkSource::Core);
        systick.set_reload(period - 1);
        systick.clear_current();
        systick.enable_interrupt();
        systick.enable_counter();
        Self { period }
    }

    /// Counts from one tick to the next.
    pub(crate) fn period(&self) -> u32 {
        self.period
    }

    /// Counts since the tick that is under way was due. More than a period where the next one is
    /// due too.
    #[inline]
    pub(crate) fn elapsed(&self) -> u32 {
        // Twice, for the counter may start anew between the two looks.
        let early = self.period - 1 - SYST::get_current();
        match SCB::is_pendst_pending() {
            false => early,
            true => self.period + (self.period - 1 - SYST::get_current()),
        }
    }
}

/// Counts of a core clock of `core_hz` in a tick, for constants.
pub(crate) const fn period(core_hz: u32) -> u32 {
    let counts = core_hz as f64 / TICK_RATE_HZ;
    assert!(
        counts >= 2.0 && counts <= LONGEST,
        "tick_rate_hz of the scene: a tick has to last from 2 to 2^24 counts of this board's clock"
    );
    (counts + 0.5) as u32
}
