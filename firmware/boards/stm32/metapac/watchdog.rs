//! Independent watchdog.

use stm32_metapac::iwdg::Iwdg;
use stm32_metapac::iwdg::vals::{Key, Pr};
use trirrr_app::WATCHDOG_MS;

/// The watchdog, before it runs.
pub(crate) struct StoppedWatchdog(pub(crate) Iwdg);

/// The watchdog, which nothing stops but a reset.
pub(crate) struct Watchdog(Iwdg);

/// Counts until it bites: 1 ms each, by an oscillator of 32 kHz.
const COUNTS: u16 = {
    assert!(WATCHDOG_MS <= 1 << 12);
    (WATCHDOG_MS - 1) as u16
};

/// Reads of the status before the wait ends. A setting takes some cycles of the oscillator, 0.2 ms.
const READS: u32 = 100_000;

impl StoppedWatchdog {
    /// Starts the watchdog.
    pub(crate) fn start(self) -> Watchdog {
        let registers = self.0;
        // The oscillator starts with the watchdog, and takes settings only then.
        registers.kr().write(|w| w.set_key(Key::START));
        registers.kr().write(|w| w.set_key(Key::ENABLE));
        registers.pr().write(|w| w.set_pr(Pr::DIVIDE_BY32));
        registers.rlr().write(|w| w.set_rl(COUNTS));
        let _ = (0..READS).any(|_| registers.sr().read().0 == 0);
        let mut watchdog = Watchdog(registers);
        watchdog.feed();
        watchdog
    }
}

impl Watchdog {
    /// Begins a new period.
    pub(crate) fn feed(&mut self) {
        self.0.kr().write(|w| w.set_key(Key::RESET));
    }
}
