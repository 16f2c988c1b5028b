//! Clock: a crystal and the PLL if they start, else the internal oscillator. No wait is without bound, so a
//! dead crystal makes a slower or less exact board and not a dead one.

use crate::board;
pub(super) use crate::clocking::Pll;
use crate::clocking::{HSI_HZ, becomes};
use stm32_metapac::flash::vals::Latency;
use stm32_metapac::rcc::vals::{Hpre, Pllm, Plln, Pllr, Pllsrc, Sw};
use stm32_metapac::{FLASH, PWR, RCC};
use trirrr_protocol::message::{Clock, Start};

/// Of the internal oscillator, as of [`board::PLL`]: twice the clock of the core.
const INTERNAL_PLL: Pll = Pll {
    divider: 4,
    factor: (FAST.core / (HSI_HZ / 4) * 2) as u16,
};

/// Rates of the clocks, Hz. No bus is slower than the core.
// Each kind of drive takes some of them.
#[allow(dead_code)]
#[derive(Clone, Copy)]
pub(super) struct Clocks {
    pub(super) core: u32,
    pub(super) apb1: u32,
    pub(super) timers: u32,
}

impl Clocks {
    const fn of(core: u32) -> Self {
        let (apb1, timers) = (core, core);
        Self { core, apb1, timers }
    }
}

/// Clocks with the PLL,
pub(super) const FAST: Clocks = Clocks::of(170_000_000);
/// and without, as after a reset.
pub(super) const SLOW: Clocks = Clocks::of(HSI_HZ);

/// Starts the crystal and the PLL, as far as both start. A crystal that stopped in the run before is left out: it may stop again.
pub(super) fn start(start: &Start) -> (Clock, Clocks) {
    let has_stopped = *start == Start::CrystalStopped;
    RCC.cr().modify(|w| w.set_hseon(!has_stopped));
    let crystal = !has_stopped && becomes(|| RCC.cr().read().hserdy());
    if !crystal {
        RCC.cr().modify(|w| w.set_hseon(false));
    }
    match (crystal, start_pll(crystal)) {
        (true, true) => {
            // From here on a crystal that stops is an exception, and the core goes on from the internal oscillator.
            #[cfg(outputs)]
            RCC.cr().modify(|w| w.set_csson(true));
            (Clock::Crystal, FAST)
        }
        (false, true) => (Clock::Internal, FAST),
        (_, false) => (Clock::Slow, SLOW),
    }
}

/// Runs the core from the PLL through 2 (RM0440, 7.2.4 and 6.1.5). Returns `false`, with everything as before, if the PLL
/// does not lock.
fn start_pll(crystal: bool) -> bool {
    let (pll, source) = match crystal {
        true => (board::PLL, Pllsrc::HSE),
        false => (INTERNAL_PLL, Pllsrc::HSI),
    };
    // The reset leaves the PLL off, and only then it takes settings. A board file is refused if none within the fields
    // make this clock of its crystal.
    RCC.pllcfgr().write(|w| {
        w.set_pllsrc(source);
        w.set_pllm(Pllm::from_bits(pll.divider - 1));
        w.set_plln(Plln::from_bits(pll.factor as u8));
        w.set_pllr(Pllr::DIV2);
        w.set_pllren(true);
    });
    RCC.cr().modify(|w| w.set_pllon(true));
    if !becomes(|| RCC.cr().read().pllrdy()) {
        RCC.cr().modify(|w| w.set_pllon(false));
        return false;
    }
    // Beyond 150 MHz the supply of the core is boosted, and the flash takes 4 more cycles. Both before the clock gets faster.
    PWR.cr5().modify(|w| w.set_r1mode(false));
    FLASH.acr().modify(|w| {
        w.set_latency(Latency::WS4);
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    // Read back: from here on they count.
    let _ = FLASH.acr().read();
    // Half of the clock for a microsecond at least. The switch to a locked PLL takes a few cycles.
    RCC.cfgr().modify(|w| w.set_hpre(Hpre::DIV2));
    RCC.cfgr().modify(|w| w.set_sw(Sw::PLL1_R));
    becomes(|| RCC.cfgr().read().sws() == Sw::PLL1_R);
    cortex_m::asm::delay(FAST.core / 1_000_000);
    RCC.cfgr().modify(|w| w.set_hpre(Hpre::DIV1));
    true
}
