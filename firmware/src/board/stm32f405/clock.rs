//! The clock: a crystal and the PLL if they start, else what there is. Nothing here waits without
//! bound, so a dead crystal is a slower or less exact board and not a dead one.

use stm32f4xx_hal::pac::{DBGMCU, RCC};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::rcc::Config;
use trirrr_core::message::Clock;

use super::CORE_HZ;

/// The internal oscillator, Hz.
pub(super) const HSI_HZ: u32 = 16_000_000;

/// Looks at a ready flag, at 16 MHz some 10 cycles each: 100 ms. A crystal takes a few ms, the PLL
/// a third of one.
const LOOKS: u32 = 160_000;

/// The crystal, MHz: `CRYSTAL_MHZ` when the image is built.
const CRYSTAL_MHZ: u32 = match option_env!("CRYSTAL_MHZ") {
    None => 8,
    Some(text) => match u32::from_str_radix(text, 10) {
        Ok(mhz) if mhz >= 4 && mhz <= 26 => mhz,
        _ => panic!("CRYSTAL_MHZ has to be a whole number from 4 to 26"),
    },
};

/// What will start, tried out, and the clock configuration made of it.
pub(super) fn choose(rcc: &RCC, debug: &DBGMCU) -> (Clock, Config) {
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    let crystal = becomes(|| rcc.cr().read().hserdy().bit_is_set());
    if !crystal {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    // Any setting will do to see it lock; then it is off again, for its settings are taken while it
    // is.
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    let pll = becomes(|| rcc.cr().read().pllrdy().bit_is_set());
    rcc.cr().modify(|_, w| w.pllon().clear_bit());
    let off = becomes(|| rcc.cr().read().pllrdy().bit_is_clear());
    match (crystal, pll && off) {
        (true, true) => (
            Clock::Crystal,
            Config::hse(CRYSTAL_MHZ.MHz()).sysclk(CORE_HZ.Hz()),
        ),
        (false, true) => (Clock::Internal, Config::hsi().sysclk(CORE_HZ.Hz())),
        // Only an emulator has no identity: its core runs at full speed, whatever it is told.
        (_, false) if debug.idcode().read().bits() == 0 => (Clock::Emulated, Config::hsi()),
        (_, false) => (Clock::Slow, Config::hsi()),
    }
}

/// Whether it is so before long.
fn becomes(is_so: impl Fn() -> bool) -> bool {
    (0..LOOKS).any(|_| is_so())
}
