//! Pins and ports of the chip.
#![allow(unsafe_code)]

pub(crate) use stm32f4xx_hal::gpio::{Input as InputMode, Output as OutputMode, Pin, Pull};
use stm32f4xx_hal::pac::{GPIOA, GPIOB, GPIOC, GPIOD, GPIOE, gpioa};

/// Registers of a port.
#[derive(Clone, Copy)]
pub(crate) struct PortRegisters(*const gpioa::RegisterBlock);

// SAFETY: one write of BSRR changes no pin but those of its ones, and reading changes nothing, whatever runs beside it.
unsafe impl Send for PortRegisters {}

impl PortRegisters {
    /// The port of this letter.
    pub(crate) const fn of<const P: char>() -> Self {
        // All have the same registers; only their values in a reset differ.
        Self(match P {
            'A' => GPIOA::ptr(),
            'B' => GPIOB::ptr().cast(),
            'C' => GPIOC::ptr().cast(),
            'D' => GPIOD::ptr().cast(),
            'E' => GPIOE::ptr().cast(),
            _ => panic!("a pin of another port is refused when the board file is read"),
        })
    }

    /// Writes BSRR: ones of the lower half set pins, ones of the upper half clear pins. Only for pins that the caller owns.
    #[inline(always)]
    pub(crate) fn write(self, bits: u32) {
        // SAFETY: the caller owns the pins, and one write of this register changes no other pin.
        unsafe { (*self.0).bsrr().write(|w| w.bits(bits)) };
    }

    /// Levels of all pins.
    #[inline(always)]
    pub(crate) fn levels(self) -> u32 {
        // SAFETY: reading changes nothing.
        unsafe { (*self.0).idr().read().bits() }
    }
}
