//! Settings of the clock: 168 MHz, both buses at their limits; and the crystal's measurement.

use crate::board;
use crate::clock::{Clocks, HSI_HZ, Pll, becomes};
use stm32_metapac::flash::vals::Latency;
use stm32_metapac::rcc::vals::{Pllm, Plln, Pllp, Pllq, Pllsrc, Ppre, Sw};
use stm32_metapac::timer::vals::CcmrInputCcs;
use stm32_metapac::{RCC, TIM11};

/// Clocks with the PLL.
pub(crate) const FAST: Clocks = Clocks {
    core: 168_000_000,
    apb1: 42_000_000,
    apb2: 84_000_000,
    timers: 84_000_000,
};

/// Of the internal oscillator, as of [`board::PLL`]: twice the clock of the core.
pub(crate) const INTERNAL_PLL: Pll = Pll {
    divider: (HSI_HZ / 1_000_000) as u8,
    factor: (FAST.core / 1_000_000 * 2) as u16,
};

/// At 168 MHz and 2.7 to 3.6 V.
pub(crate) const LATENCY: Latency = Latency::WS5;

/// Captures over which the crystal is measured, each after eight of its divided periods.
const CAPTURES: u32 = 32;

/// Counts of the internal oscillator in that time.
const COUNTS: u32 = CAPTURES * 8 * (HSI_HZ / 1_000_000) * board::PLL.factor as u32 / 336;

/// Measures the crystal with the internal oscillator: TIM11 counts periods of the core's clock between edges of the crystal's, divided
/// as for the PLL (RM0090, chapters 7 and 19). Returns `false` if the crystal is not that of the board file.
///
/// The internal oscillator is 8 % slow to 4.5 % fast from -40 to 105 degrees Celsius (data sheet DS8626), so a crystal that is off less
/// than that is not told from the right one.
#[inline(never)]
pub(crate) fn is_right() -> bool {
    RCC.apb2enr().modify(|w| w.set_tim11en(true));
    RCC.cfgr().modify(|w| w.set_rtcpre(board::PLL.divider));
    // The input of channel 1 is the crystal's clock; one edge in eight is captured.
    TIM11.or().write_value(2);
    TIM11.ccmr_input(0).write(|w| {
        w.set_ccs(0, CcmrInputCcs::TI4);
        w.set_icpsc(0, 3);
    });
    TIM11.ccer().write(|w| w.set_cce(0, true));
    TIM11.cr1().write(|w| w.set_cen(true));
    let mut first = 0;
    let mut right = false;
    for capture in 0..=CAPTURES {
        let came = becomes(|| TIM11.sr().read().ccif(0));
        // Reading the capture clears its flag.
        let at = TIM11.ccr(0).read().ccr();
        // An edge that was missed is one of a far faster crystal.
        if !came || TIM11.sr().read().ccof(0) {
            break;
        }
        // The edge before the first one counted may have been any of eight.
        if capture == 0 {
            first = at;
        }
        let counts = u32::from(at.wrapping_sub(first));
        right = capture == CAPTURES && (COUNTS * 91 / 100..=COUNTS * 1055 / 1000).contains(&counts);
    }
    TIM11.cr1().write(|w| w.set_cen(false));
    RCC.apb2enr().modify(|w| w.set_tim11en(false));
    right
}

/// Sets the PLL up (RM0090, 7.2.3): through 2 for the core, through 7 for the 48 MHz of USB.
pub(crate) fn set_pll(pll: Pll, crystal: bool) {
    RCC.pllcfgr().write(|w| {
        w.set_pllsrc(if crystal { Pllsrc::HSE } else { Pllsrc::HSI });
        w.set_pllm(Pllm::from_bits(pll.divider));
        w.set_plln(Plln::from_bits(pll.factor));
        w.set_pllp(Pllp::DIV2);
        w.set_pllq(Pllq::DIV7);
    });
}

/// Divides the buses, and switches to the PLL.
pub(crate) fn run_from_pll() {
    RCC.cfgr().modify(|w| {
        w.set_ppre1(Ppre::DIV4);
        w.set_ppre2(Ppre::DIV2);
    });
    // The switch to a locked PLL takes a few cycles.
    RCC.cfgr().modify(|w| w.set_sw(Sw::PLL1_P));
    becomes(|| RCC.cfgr().read().sws() == Sw::PLL1_P);
}
