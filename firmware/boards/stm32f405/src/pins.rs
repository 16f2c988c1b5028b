//! Pins of a port as one type, whatever their number: drives and switches come in arrays.
//!
//! The HAL's own such type checks the number at each use and panics on a wrong one. The tick must not be able
//! to panic, so here a pin is its bit.
#![allow(unsafe_code)]
// An image uses those of its scene's drives.
#![allow(dead_code)]

use core::convert::Infallible;
use stm32f4xx_hal::gpio::{Input, Output, Pin};
use stm32f4xx_hal::hal::digital::{ErrorType, OutputPin};
use stm32f4xx_hal::pac::{GPIOB, GPIOC};

/// Output of port C.
pub(crate) struct OutputC(u16);

impl<const N: u8> From<Pin<'C', N, Output>> for OutputC {
    fn from(_: Pin<'C', N, Output>) -> Self {
        Self(const { 1 << N })
    }
}

impl OutputC {
    /// Writes BSRR: ones of the lower half set pins, ones of the upper half clear pins.
    #[inline(always)]
    fn write(&mut self, bits: u32) {
        // SAFETY: this value owns the pin, and one write of this register changes no other pin.
        unsafe { (*GPIOC::ptr()).bsrr().write(|w| w.bits(bits)) };
    }
}

impl ErrorType for OutputC {
    type Error = Infallible;
}

impl OutputPin for OutputC {
    #[inline(always)]
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(u32::from(self.0) << 16);
        Ok(())
    }

    #[inline(always)]
    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(self.0.into());
        Ok(())
    }
}

/// Input of port C.
pub(crate) struct InputC(u16);

impl<const N: u8> From<Pin<'C', N, Input>> for InputC {
    fn from(_: Pin<'C', N, Input>) -> Self {
        Self(const { 1 << N })
    }
}

impl InputC {
    #[inline(always)]
    pub(super) fn is_high(&self) -> bool {
        // SAFETY: reading changes nothing.
        let levels = unsafe { (*GPIOC::ptr()).idr().read().bits() };
        levels & u32::from(self.0) != 0
    }
}

/// Input of port B.
pub(crate) struct InputB(u16);

impl<const N: u8> From<Pin<'B', N, Input>> for InputB {
    fn from(_: Pin<'B', N, Input>) -> Self {
        Self(const { 1 << N })
    }
}

impl InputB {
    #[inline(always)]
    pub(super) fn is_high(&self) -> bool {
        // SAFETY: reading changes nothing.
        let levels = unsafe { (*GPIOB::ptr()).idr().read().bits() };
        levels & u32::from(self.0) != 0
    }
}
