//! Failures outside of the program that end it: the crystal stops, the supply sags. Outputs go off, and the board starts anew.
#![allow(unsafe_code)]

use crate::chip::Stm32f405;
use crate::clocking::becomes;
use cortex_m::peripheral::NVIC;
use stm32f4xx_hal::pac::{EXTI, Interrupt, PWR, RCC, interrupt};
use trirrr_app::failure::end;
use trirrr_protocol::message::Start;

/// Level of the detector (RM0090, chapter 5): 2.7 V, below which the flash is too slow for the clock.
const LEVEL: u8 = 5;

/// Line of the detector in the controller of external interrupts.
const LINE: u32 = 1 << 16;

/// Cycles of the internal oscillator until the detector tells the level: 100 us.
const SETTLING: u32 = 1600;

/// Switches the detector of the supply on, and waits for a supply that is there. Starts the board anew if none comes in time.
#[inline(never)]
pub(super) fn await_supply(rcc: &RCC, pwr: &PWR) {
    rcc.apb1enr().modify(|_, w| w.pwren().set_bit());
    // The clock comes two cycles later (errata sheet ES0182); read before, the register would lose the scale of the regulator.
    let _ = rcc.apb1enr().read();
    pwr.cr().modify(|_, w| w.pls().set(LEVEL).pvde().set_bit());
    cortex_m::asm::delay(SETTLING);
    if !becomes(|| pwr.csr().read().pvdo().bit_is_clear()) {
        end::<Stm32f405>(&Start::LowSupply);
    }
}

/// From here on a supply that sags is an interrupt. One that has sagged since [`await_supply`] ends the program now: the interrupt comes with
/// the fall alone.
pub(super) fn watch_supply(exti: &EXTI, pwr: &PWR) {
    // SAFETY: the line of the detector alone. Its handler shares nothing with a task, and does not return.
    unsafe {
        exti.rtsr().write(|w| w.bits(LINE));
        exti.imr().write(|w| w.bits(LINE));
        NVIC::unmask(Interrupt::PVD);
    }
    if pwr.csr().read().pvdo().bit_is_set() {
        end::<Stm32f405>(&Start::LowSupply);
    }
}

/// The supply has sagged. Above all tasks, as the priority of the reset is the highest.
#[interrupt]
fn PVD() {
    end::<Stm32f405>(&Start::LowSupply);
}

/// The crystal has stopped. The chip has put the core on the internal oscillator and calls this exception, which nothing masks.
#[cortex_m_rt::exception]
unsafe fn NonMaskableInt() -> ! {
    end::<Stm32f405>(&Start::CrystalStopped)
}
