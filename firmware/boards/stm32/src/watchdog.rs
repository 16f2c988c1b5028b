//! Independent watchdog.

use stm32_metapac::IWDG;
use stm32_metapac::iwdg::vals::{Key, Pr};
use trirrr_app::WATCHDOG_MS;

/// The watchdog, which nothing stops but a reset.
pub(crate) struct Watchdog(());

/// Counts until it bites: 1 ms each, by an oscillator of 32 kHz.
const COUNTS: u16 = {
    assert!(WATCHDOG_MS <= 1 << 12);
    (WATCHDOG_MS - 1) as u16
};

/// Reads of the status before the wait ends. A setting takes some cycles of the oscillator, 0.2 ms.
const READS: u32 = 100_000;

impl Watchdog {
    /// Starts the watchdog.
    pub(crate) fn start() -> Self {
        // The oscillator starts with the watchdog, and takes settings only then.
        IWDG.kr().write(|w| w.set_key(Key::START));
        IWDG.kr().write(|w| w.set_key(Key::ENABLE));
        IWDG.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
        IWDG.rlr().write(|w| w.set_rl(COUNTS));
        let _ = (0..READS).any(|_| IWDG.sr().read().0 == 0);
        let mut watchdog = Self(());
        watchdog.feed();
        watchdog
    }

    /// Begins a new period.
    pub(crate) fn feed(&mut self) {
        IWDG.kr().write(|w| w.set_key(Key::RESET));
    }
}
