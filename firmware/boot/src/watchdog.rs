//! Independent watchdog of the STM32s (RM0090, chapter 21; RM0440, chapter 42), by its registers alone.

use crate::registers::{READS, read, write};

const KEY: u32 = 0x4000_3000;
const FEED: u32 = 0xAAAA;
const PRESCALER: u32 = 0x4000_3004;
const RELOAD: u32 = 0x4000_3008;
const STATUS: u32 = 0x4000_300C;

/// Prescaler and reload value.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Period {
    prescaler: u32,
    reload: u32,
}

impl Period {
    /// Longest: 32 s, and from 22 to 62 s with the oscillator's tolerance.
    pub const LONGEST: Self = Self {
        prescaler: 6,
        reload: 0xFFF,
    };

    /// 4 s, and from 2.7 to 7.5 s.
    pub const TRIAL: Self = Self {
        prescaler: 6,
        reload: 499,
    };
}

/// Starts the watchdog, or gives one that runs another period.
pub fn start(period: Period) {
    write(KEY, 0xCCCC);
    set(period);
}

/// Begins a new period.
pub fn feed() {
    write(KEY, FEED);
}

/// Sets another period and feeds the watchdog. Returns the period before.
pub fn set(period: Period) -> Period {
    settled();
    let before = Period {
        prescaler: read(PRESCALER),
        reload: read(RELOAD),
    };
    // The count goes on with the new prescaler until it is reloaded: from its beginning.
    feed();
    write(KEY, 0x5555);
    write(PRESCALER, period.prescaler);
    write(RELOAD, period.reload);
    settled();
    feed();
    before
}

/// Waits until a change of before has arrived in the watchdog's own clock.
fn settled() {
    let _ = (0..READS).any(|_| read(STATUS) & 3 == 0);
}
