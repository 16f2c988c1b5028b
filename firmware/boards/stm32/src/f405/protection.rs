//! Failures outside of the program that end it: the crystal stops, the supply sags. Outputs go off, and the board starts anew.
#![allow(unsafe_code)]

use crate::clock::becomes;
use crate::failure::Stm32;
use cortex_m::peripheral::NVIC;
use stm32_metapac::{EXTI, Interrupt, PWR, interrupt};
use trirrr_app::failure::end;
use trirrr_protocol::message::Start;

/// Level of the detector (RM0090, chapter 5): 2.7 V, below which the flash is too slow for the clock.
const LEVEL: u8 = 5;

/// Line of the detector in the controller of external interrupts.
const LINE: usize = 16;

/// Cycles of the internal oscillator until the detector tells the level: 100 us.
const SETTLING: u32 = 1600;

/// Switches the detector of the supply on, and waits for a supply that is there. Starts the board anew if none comes in time.
#[inline(never)]
pub(crate) fn await_supply() {
    PWR.cr1().modify(|w| {
        w.set_pls(LEVEL);
        w.set_pvde(true);
    });
    cortex_m::asm::delay(SETTLING);
    if !becomes(|| !PWR.csr1().read().pvdo()) {
        end::<Stm32>(&Start::LowSupply);
    }
}

/// From here on a supply that sags is an interrupt. One that has sagged since [`await_supply`] ends the program now: the interrupt comes with
/// the fall alone.
pub(crate) fn watch_supply() {
    EXTI.rtsr(0).write(|w| w.set_line(LINE, true));
    EXTI.imr(0).write(|w| w.set_line(LINE, true));
    // SAFETY: the handler shares nothing with a task, and does not return.
    unsafe { NVIC::unmask(Interrupt::PVD) };
    if PWR.csr1().read().pvdo() {
        end::<Stm32>(&Start::LowSupply);
    }
}

/// The supply has sagged. Above all tasks, as the priority of the reset is the highest.
#[interrupt]
fn PVD() {
    end::<Stm32>(&Start::LowSupply);
}

/// The crystal has stopped. The chip has put the core on the internal oscillator and calls this exception, which nothing masks.
#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() -> ! {
    end::<Stm32>(&Start::CrystalStopped)
}
