//! Heartbeat of the tick: the background feeds the watchdog as long as ticks are in time, and at their pace.
//!
//! The watchdog has an oscillator of its own. It is fed after half of its period by the count of ticks, and not more often. So it bites, too, where
//! the clock of the core has become far slower than it should be and every tick still seems to be in time, as with a PLL whose crystal has
//! stopped.

use crate::scene::TICK_RATE_HZ;
use core::sync::atomic::{AtomicU32, Ordering};

/// Period of the watchdog, ms. After so long without a tick in time the board starts anew: 200 ms, and at
/// least four ticks.
pub const WATCHDOG_MS: u32 = {
    let four = (4000.0 / TICK_RATE_HZ) as u32 + 1;
    if four > 200 { four } else { 200 }
};

/// Ticks from one feeding of the watchdog to the next: half of its period.
const FEEDING_TICKS: u32 = {
    let half = (WATCHDOG_MS as f64 * TICK_RATE_HZ / 2000.0) as u32;
    if half > 1 { half } else { 1 }
};

/// Ticks that were in time, and all others. The tick alone writes.
static TICKS: AtomicU32 = AtomicU32::new(0);
static LATE: AtomicU32 = AtomicU32::new(0);

/// Counts a tick that was in time.
#[inline]
pub(crate) fn beat() {
    count(&TICKS);
}

/// Counts a tick that was late.
#[cold]
pub(crate) fn miss() {
    count(&LATE);
}

#[inline]
fn count(ticks: &AtomicU32) {
    // A load and a store: a Cortex-M0+ cannot do both at once, and there is one writer.
    let count = ticks.load(Ordering::Relaxed);
    ticks.store(count.wrapping_add(1), Ordering::Relaxed);
}

/// Number of ticks that were in time, modulo 2^32.
#[inline]
pub(crate) fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

// Time stamp of the log.
defmt::timestamp!("{=u32}", ticks());

/// Reader of the heartbeat.
#[derive(Default)]
pub(crate) struct Monitor {
    last: u32,
    /// Ticks, late ones among them, at the last feeding of the watchdog.
    fed: u32,
}

impl Monitor {
    /// Returns `true` if a tick was in time since the last call. A machine with a fault latched still ticks.
    #[inline]
    pub(crate) fn has_beaten(&mut self) -> bool {
        let ticks = ticks();
        let has_beaten = ticks != self.last;
        self.last = ticks;
        has_beaten
    }

    /// Returns `true` if the watchdog is to be fed now, after a tick that was in time.
    pub(crate) fn feeds(&mut self) -> bool {
        let ticks = self.last.wrapping_add(LATE.load(Ordering::Relaxed));
        let is_due = ticks.wrapping_sub(self.fed) >= FEEDING_TICKS;
        if is_due {
            self.fed = ticks;
        }
        is_due
    }
}
