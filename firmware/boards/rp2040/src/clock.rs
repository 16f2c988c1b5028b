//! Clock: the crystal and the PLL, waited for with a bound. The reference clock, which drives the watchdog, stays with the ring oscillator: a
//! crystal that stops does not stop the watchdog.

use crate::board::CRYSTAL_MHZ;
use core::convert::Infallible;
use core::ops::RangeInclusive;
use rp2040_hal::clocks::{Clock, ClocksManager, UsbClock};
use rp2040_hal::fugit::{HertzU32, RateExtU32};
use rp2040_hal::pac::{CLOCKS, PLL_SYS, PLL_USB, RESETS, XOSC};
use rp2040_hal::pll::PhaseLockedLoop;
use rp2040_hal::pll::common_configs::PLL_SYS_125MHZ;
use rp2040_hal::xosc::CrystalOscillator;

/// Clock of the core, Hz.
pub(super) const CORE_HZ: u32 = 125_000_000;

/// Time for the start of the crystal, ms: slow ones take so long.
const START_MS: u32 = 64;

/// Reads of a flag before the wait ends: 100 ms at least, at some 10 cycles each and at most 12 MHz of the
/// ring oscillator.
const READS: u32 = 120_000;

/// Clocks of the ports.
// A port takes its own.
#[allow(dead_code)]
pub(super) struct PortRates {
    /// Clock of the UARTs.
    pub(super) peripheral: HertzU32,
    /// That of USB, with its PLL, both off, and the crystal's rate.
    pub(super) usb: (UsbClock, PLL_USB, HertzU32),
    /// Clock of the ring oscillator, MHz.
    pub(super) ring_mhz: u8,
}

/// Starts crystal, PLL and the clocks made of it. Returns the clocks of the ports, or `None` if one of them
/// does not start. The second PLL, that of USB, stays off.
pub(super) fn start(
    crystal: XOSC,
    clocks: CLOCKS,
    (pll, usb_pll): (PLL_SYS, PLL_USB),
    resets: &mut RESETS,
) -> Option<PortRates> {
    let crystal = CrystalOscillator::new(crystal)
        .initialize(u32::from(CRYSTAL_MHZ).MHz(), START_MS)
        .ok()?;
    let stable = within(|| crystal.await_stabilization())?;
    let crystal = crystal.get_stable(stable);

    let mut clocks = ClocksManager::new(clocks);
    // A debugger's reset leaves both clocks at a PLL, which is about to stand still.
    within(|| clocks.system_clock.reset_source_await())?;
    within(|| clocks.reference_clock.reset_source_await())?;
    let pll = PhaseLockedLoop::new(pll, crystal.operating_frequency(), PLL_SYS_125MHZ).ok()?;
    let pll = pll.initialize(resets);
    let locked = within(|| pll.await_lock())?;
    let pll = pll.get_locked(locked);

    clocks
        .system_clock
        .configure_clock(&pll, CORE_HZ.Hz())
        .ok()?;
    let system = &clocks.system_clock;
    clocks
        .peripheral_clock
        .configure_clock(system, system.freq())
        .ok()?;
    Some(PortRates {
        peripheral: clocks.peripheral_clock.freq(),
        usb: (clocks.usb_clock, usb_pll, crystal.operating_frequency()),
        ring_mhz: ring_mhz()?,
    })
}

/// Clocks of the ring oscillator, MHz: 1.8 to 12 by the data sheet (2.17), and rounded.
const RING_MHZ: RangeInclusive<u32> = 1..=13;

/// Measures the ring oscillator. The frequency counter (2.15.4) counts the crystal for a millisecond of the reference clock, which is the ring
/// oscillator. Returns `None` if that cannot be.
fn ring_mhz() -> Option<u8> {
    /// Of the ring oscillator, as the counter takes it.
    const ASSUMED_MHZ: u32 = 6;
    // SAFETY: the registers of the counter, which nothing else uses; any value is one.
    #[allow(unsafe_code)]
    let counter = unsafe {
        let counter = CLOCKS::steal();
        let reference = counter.fc0_ref_khz();
        reference.write(|w| w.fc0_ref_khz().bits(1000 * ASSUMED_MHZ));
        counter.fc0_interval().write(|w| w.fc0_interval().bits(10));
        counter
    };
    counter.fc0_src().write(|w| w.fc0_src().xosc_clksrc());
    (0..READS).find(|_| counter.fc0_status().read().done().bit_is_set())?;
    let khz = counter.fc0_result().read().khz().bits();
    let mhz = (1000 * ASSUMED_MHZ * u32::from(CRYSTAL_MHZ) + khz / 2).checked_div(khz)?;
    RING_MHZ.contains(&mhz).then_some(mhz as u8)
}

/// Result of `look`, if there is one within [`READS`] calls.
pub(super) fn within<T>(mut look: impl FnMut() -> nb::Result<T, Infallible>) -> Option<T> {
    (0..READS).find_map(|_| look().ok())
}
