//! Clock: a crystal and the PLL if they start, else the internal oscillator. No wait is without bound, so a
//! dead crystal makes a slower or less exact board and not a dead one.
//!
//! The HAL's own start waits for ever, panics, and searches the PLL's factors at run time. Here factors and
//! clocks are constants. The HAL takes its clocks for those of the reset; [`dividers`](crate::dividers)
//! corrects the dividers that follow from them.

use crate::board;
pub(super) use crate::clocking::Pll;
use crate::clocking::{HSI_HZ, becomes};
use stm32f4xx_hal::pac::{DBGMCU, FLASH, RCC, TIM11};
use trirrr_protocol::message::{Clock, Start};

/// Of the internal oscillator, as of [`board::PLL`]: twice the clock of the core.
const INTERNAL_PLL: Pll = Pll {
    divider: (HSI_HZ / 1_000_000) as u8,
    factor: (FAST.core / 1_000_000 * 2) as u16,
};

/// Rates of the clocks, Hz.
#[derive(Clone, Copy)]
pub(super) struct Clocks {
    /// Core and memories.
    pub(super) core: u32,
    /// CAN controller and some serial ports, on APB1.
    pub(super) apb1: u32,
    /// Other serial ports, on APB2.
    apb2: u32,
    /// Timers on APB1, which run twice as fast as their bus where that is slower than the core.
    // Only some drives have one.
    #[allow(dead_code)]
    pub(super) timers: u32,
}

impl Clocks {
    /// Rate of a serial port's bus, Hz.
    pub(super) const fn bus(&self, is_apb2: bool) -> u32 {
        match is_apb2 {
            true => self.apb2,
            false => self.apb1,
        }
    }
}

/// Clocks with the PLL; both buses are at their limits.
pub(super) const FAST: Clocks = Clocks {
    core: 168_000_000,
    apb1: 42_000_000,
    apb2: 84_000_000,
    timers: 84_000_000,
};

/// Clocks without the PLL, as after a reset.
pub(super) const SLOW: Clocks = Clocks {
    core: HSI_HZ,
    apb1: HSI_HZ,
    apb2: HSI_HZ,
    timers: HSI_HZ,
};

/// Starts the crystal and the PLL, as far as both start. A crystal that stopped in the run before is left out: it may stop
/// again.
pub(super) fn start(
    rcc: &RCC,
    flash: &FLASH,
    debug: &DBGMCU,
    tim11: &TIM11,
    start: &Start,
) -> (Clock, Clocks) {
    let has_stopped = *start == Start::CrystalStopped;
    rcc.cr().modify(|_, w| w.hseon().bit(!has_stopped));
    let runs = !has_stopped && becomes(|| rcc.cr().read().hserdy().bit_is_set());
    let crystal = runs && is_right(rcc, tim11);
    if !crystal {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    match (crystal, start_pll(rcc, flash, crystal)) {
        (true, true) => {
            // From here on a crystal that stops is an exception, and the core goes on from the internal oscillator.
            #[cfg(outputs)]
            rcc.cr().modify(|_, w| w.csson().set_bit());
            (Clock::Crystal, FAST)
        }
        (false, true) if runs => (Clock::WrongCrystal, FAST),
        (false, true) => (Clock::Internal, FAST),
        // Only an emulator has no identity. Its core runs at full speed in any case.
        (_, false) if debug.idcode().read().bits() == 0 => (Clock::Emulated, FAST),
        (_, false) => (Clock::Slow, SLOW),
    }
}

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
fn is_right(rcc: &RCC, tim11: &TIM11) -> bool {
    rcc.apb2enr().modify(|_, w| w.tim11en().set_bit());
    rcc.cfgr().modify(|_, w| w.rtcpre().set(board::PLL.divider));
    // The input of channel 1 is the crystal's clock; one edge in eight is captured.
    // SAFETY: 2 is the setting for it.
    #[allow(unsafe_code)]
    tim11.or().write(|w| unsafe { w.rmp().bits(2) });
    tim11
        .ccmr1_input()
        .write(|w| w.cc1s().ti1().ic1psc().eight_events());
    tim11.ccer().write(|w| w.cc1e().set_bit());
    tim11.cr1().write(|w| w.cen().set_bit());
    let mut first = 0;
    let mut right = false;
    for capture in 0..=CAPTURES {
        let came = becomes(|| tim11.sr().read().cc1if().bit_is_set());
        // Reading the capture clears its flag.
        let at = tim11.ccr1().read().ccr().bits();
        // An edge that was missed is one of a far faster crystal.
        if !came || tim11.sr().read().cc1of().bit_is_set() {
            break;
        }
        // The edge before the first one counted may have been any of eight.
        if capture == 0 {
            first = at;
        }
        let counts = u32::from(at.wrapping_sub(first));
        right = capture == CAPTURES && (COUNTS * 91 / 100..=COUNTS * 1055 / 1000).contains(&counts);
    }
    tim11.cr1().reset();
    rcc.apb2enr().modify(|_, w| w.tim11en().clear_bit());
    right
}

/// Runs the core from the PLL, fed by the crystal or the internal oscillator (RM0090, 7.2.3 and 3.5.1), through 2. Returns
/// `false`, with everything as before, if the PLL does not lock.
fn start_pll(rcc: &RCC, flash: &FLASH, crystal: bool) -> bool {
    let pll = if crystal { board::PLL } else { INTERNAL_PLL };
    // The reset leaves the PLL off, and only then it takes settings. 7 makes the 48 MHz of USB.
    // SAFETY: a board file is refused if no settings within the fields make this clock of its crystal.
    #[allow(unsafe_code)]
    rcc.pllcfgr().write(|w| unsafe {
        w.pllsrc().bit(crystal);
        w.pllm().bits(pll.divider);
        w.plln().bits(pll.factor);
        w.pllp().div2();
        w.pllq().bits(7)
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    if !becomes(|| rcc.cr().read().pllrdy().bit_is_set()) {
        rcc.cr().modify(|_, w| w.pllon().clear_bit());
        return false;
    }
    // At 168 MHz and 2.7 to 3.6 V the flash takes 5 more cycles. Set before the clock gets faster.
    flash.acr().modify(|_, w| {
        w.latency().ws5();
        w.prften().set_bit();
        w.icen().set_bit();
        w.dcen().set_bit()
    });
    // Read back: from here on they count (RM0090, 3.5.1).
    let _ = flash.acr().read();
    rcc.cfgr().modify(|_, w| {
        w.ppre1().div4();
        w.ppre2().div2()
    });
    // The switch to a locked PLL takes a few cycles.
    rcc.cfgr().modify(|_, w| w.sw().pll());
    becomes(|| rcc.cfgr().read().sws().is_pll());
    true
}
