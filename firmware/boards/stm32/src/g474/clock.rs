//! Settings of the clock: 170 MHz, and no bus slower than that.

use crate::clock::{Clocks, HSI_HZ, Pll, becomes};
use stm32_metapac::flash::vals::Latency;
use stm32_metapac::rcc::vals::{Hpre, Pllm, Plln, Pllr, Pllsrc, Sw};
use stm32_metapac::{PWR, RCC};

/// Clocks with the PLL.
pub(crate) const FAST: Clocks = Clocks::undivided(170_000_000);

/// Of the internal oscillator, as of [`board::PLL`](crate::board::PLL): twice the clock of the core.
pub(crate) const INTERNAL_PLL: Pll = Pll {
    divider: 4,
    factor: (FAST.core / (HSI_HZ / 4) * 2) as u16,
};

/// Beyond 150 MHz, with the supply of the core boosted.
pub(crate) const LATENCY: Latency = Latency::WS4;

/// Takes a crystal that runs for that of the board file.
pub(crate) const fn is_right() -> bool {
    true
}

/// Sets the PLL up: through 2 for the core.
pub(crate) fn set_pll(pll: Pll, crystal: bool) {
    RCC.pllcfgr().write(|w| {
        w.set_pllsrc(if crystal { Pllsrc::HSE } else { Pllsrc::HSI });
        w.set_pllm(Pllm::from_bits(pll.divider - 1));
        w.set_plln(Plln::from_bits(pll.factor as u8));
        w.set_pllr(Pllr::DIV2);
        w.set_pllren(true);
    });
}

/// Boosts the supply of the core, and switches to the PLL (RM0440, 7.2.4 and 6.1.5).
pub(crate) fn run_from_pll() {
    PWR.cr5().modify(|w| w.set_r1mode(false));
    // Half of the clock for a microsecond at least. The switch to a locked PLL takes a few cycles.
    RCC.cfgr().modify(|w| w.set_hpre(Hpre::DIV2));
    RCC.cfgr().modify(|w| w.set_sw(Sw::PLL1_R));
    becomes(|| RCC.cfgr().read().sws() == Sw::PLL1_R);
    cortex_m::asm::delay(FAST.core / 1_000_000);
    RCC.cfgr().modify(|w| w.set_hpre(Hpre::DIV1));
}
