//! Heartbeat of the tick: the background feeds the watchdog as long as ticks are in time.

use crate::scene::TICK_RATE_HZ;
use core::sync::atomic::{AtomicU32, Ordering};

/// Period of the watchdog, ms. After so long without a tick in time the board starts anew: 200 ms, and at
/// least four ticks.
pub const WATCHDOG_MS: u32 = {
    let four = (4000.0 / TICK_RATE_HZ) as u32 + 1;
    if four > 200 { four } else { 200 }
};

/// Ticks that were in time. The tick alone writes.
static TICKS: AtomicU32 = AtomicU32::new(0);

/// Counts a tick that was in time.
#[inline]
pub(crate) fn beat() {
    // A load and a store: a Cortex-M0+ cannot do both at once, and there is one writer.
    TICKS.store(ticks().wrapping_add(1), Ordering::Relaxed);
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
}
