//! Clock: a crystal and the PLL if they start, else the internal oscillator. No wait is without bound, so a
//! dead crystal makes a slower or less exact board and not a dead one.

use crate::{board, chip};
use stm32_metapac::{FLASH, RCC};
use trirrr_protocol::message::{Clock, Start};

/// The internal oscillator, Hz.
pub(crate) const HSI_HZ: u32 = 16_000_000;

/// Reads of a ready flag before the wait ends: 100 ms at 16 MHz and some 10 cycles each. A crystal takes a few
/// ms, the PLL a third of one.
const READS: u32 = 160_000;

/// Returns `true` once `is_so` does, `false` after [`READS`] calls.
pub(crate) fn becomes(is_so: impl Fn() -> bool) -> bool {
    (0..READS).any(|_| is_so())
}

/// Settings of the PLL: the source is divided, then taken so many times.
#[derive(Clone, Copy)]
pub(crate) struct Pll {
    pub(crate) divider: u8,
    pub(crate) factor: u16,
}

/// Rates of the clocks, Hz.
#[derive(Clone, Copy)]
// An image uses those of its scene's functions.
#[allow(dead_code)]
pub(crate) struct Clocks {
    /// Core and memories.
    pub(crate) core: u32,
    /// CAN controller and some serial ports, on APB1.
    pub(crate) apb1: u32,
    /// Other serial ports, on APB2.
    pub(crate) apb2: u32,
    /// Timers on APB1, which run twice as fast as their bus where that is slower than the core.
    pub(crate) timers: u32,
}

impl Clocks {
    /// Clocks of which none is divided.
    pub(crate) const fn undivided(core: u32) -> Self {
        Self {
            core,
            apb1: core,
            apb2: core,
            timers: core,
        }
    }
}

/// Clocks with the PLL,
pub(crate) const FAST: Clocks = chip::clock::FAST;
/// and without, as after a reset.
pub(crate) const SLOW: Clocks = Clocks::undivided(HSI_HZ);

/// Starts the crystal and the PLL, as far as both start. A crystal that stopped in the run before is left out: it may stop
/// again.
pub(crate) fn start(start: &Start) -> (Clock, Clocks) {
    let has_stopped = *start == Start::CrystalStopped;
    RCC.cr().modify(|w| w.set_hseon(!has_stopped));
    let runs = !has_stopped && becomes(|| RCC.cr().read().hserdy());
    let crystal = runs && chip::clock::is_right();
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
        (false, true) if runs => (Clock::WrongCrystal, FAST),
        (false, true) => (Clock::Internal, FAST),
        // Its core runs at full speed in any case.
        (_, false) if chip::is_emulated() => (Clock::Emulated, FAST),
        (_, false) => (Clock::Slow, SLOW),
    }
}

/// Runs the core from the PLL, fed by the crystal or the internal oscillator. Returns `false`, with everything as before, if the PLL
/// does not lock.
fn start_pll(crystal: bool) -> bool {
    let pll = if crystal {
        board::PLL
    } else {
        chip::clock::INTERNAL_PLL
    };
    // The reset leaves the PLL off, and only then it takes settings. A board file is refused if none within the fields
    // make this clock of its crystal.
    chip::clock::set_pll(pll, crystal);
    RCC.cr().modify(|w| w.set_pllon(true));
    if !becomes(|| RCC.cr().read().pllrdy()) {
        RCC.cr().modify(|w| w.set_pllon(false));
        return false;
    }
    // The flash takes more cycles. Set before the clock gets faster.
    FLASH.acr().modify(|w| {
        w.set_latency(chip::clock::LATENCY);
        w.set_prften(true);
        w.set_icen(true);
        w.set_dcen(true);
    });
    // Read back: from here on they count (RM0090, 3.5.1).
    let _ = FLASH.acr().read();
    chip::clock::run_from_pll();
    true
}
