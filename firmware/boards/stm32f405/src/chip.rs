//! Registers that are written after a failure, from wherever the program has come to its end.
#![allow(unsafe_code)]

use core::ops::Range;
use stm32f4xx_hal::pac::RCC;
use trirrr_app::failure::Chip;

trirrr_app::failure_handlers!(Stm32f405);

/// The microcontroller.
pub(crate) struct Stm32f405;

impl Chip for Stm32f405 {
    /// As in `regions.x`.
    const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

    /// Resets the ports A to E. Every pin becomes an input, as in a reset; the wiring has to take that for off
    /// (`docs/board.md`).
    fn outputs_off() {
        // SAFETY: only called when nothing else runs any more, right before the reset.
        let rcc = unsafe { RCC::steal() };
        rcc.ahb1rstr().write(|w| {
            w.gpioarst().set_bit();
            w.gpiobrst().set_bit();
            w.gpiocrst().set_bit();
            w.gpiodrst().set_bit();
            w.gpioerst().set_bit()
        });
    }

    fn reset() -> ! {
        cortex_m::peripheral::SCB::sys_reset()
    }

    fn fault_status() -> (u32, u32) {
        crate::fault_status::fault_status()
    }
}
