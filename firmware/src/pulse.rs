//! The sign of life of the tick: as long as it comes, the background feeds the watchdog.

use core::sync::atomic::{AtomicU32, Ordering};
use trirrr_station::scene::TICK_RATE_HZ;

/// Without a tick in time for so long, the board starts anew, ms: four ticks at least.
pub(crate) const PATIENCE_MS: u32 = {
    let four = (4000.0 / TICK_RATE_HZ) as u32 + 1;
    if four > 200 { four } else { 200 }
};

/// Ticks that were in time. The tick alone writes.
static TICKS: AtomicU32 = AtomicU32::new(0);

/// A tick was in time.
pub(crate) fn beat() {
    // A load and a store: not every processor can do both at once, and there is one writer.
    TICKS.store(ticks().wrapping_add(1), Ordering::Relaxed);
}

/// Ticks that were in time so far, modulo 2^32.
pub(crate) fn ticks() -> u32 {
    TICKS.load(Ordering::Relaxed)
}

// What the log calls the time.
defmt::timestamp!("{=u32}", ticks());

/// Who feels the pulse.
#[derive(Default)]
pub(crate) struct Pulse {
    last: u32,
}

impl Pulse {
    /// Whether a tick was in time since this was asked last. A machine with a fault latched ticks
    /// on, and is well in this sense.
    pub(crate) fn beats(&mut self) -> bool {
        let ticks = ticks();
        let beats = ticks != self.last;
        self.last = ticks;
        beats
    }
}
