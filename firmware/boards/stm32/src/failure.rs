//! Registers that are read and written after a failure, from wherever the program has come to its end.
#![allow(unsafe_code)]

use crate::chip;
use core::ops::Range;
use trirrr_app::failure::Chip;

trirrr_app::failure_handlers!(Stm32);

/// The microcontroller.
pub(crate) struct Stm32;

impl Chip for Stm32 {
    /// As in `regions.x`.
    const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

    /// Resets the ports. Every pin is let go, as in a reset; the wiring has to take that for off (`docs/board.md`).
    fn outputs_off() {
        chip::reset_ports();
    }

    fn reset() -> ! {
        cortex_m::peripheral::SCB::sys_reset()
    }

    /// CFSR, and the address of the fault, or 0.
    fn fault_status() -> (u32, u32) {
        const CFSR: *const u32 = 0xE000_ED28 as *const u32;
        const MMFAR: *const u32 = 0xE000_ED34 as *const u32;
        const BFAR: *const u32 = 0xE000_ED38 as *const u32;
        // SAFETY: registers that every Cortex-M4 has; reading changes nothing.
        let (status, memory, bus) = unsafe {
            (
                CFSR.read_volatile(),
                MMFAR.read_volatile(),
                BFAR.read_volatile(),
            )
        };
        let address = match (status & 1 << 7 != 0, status & 1 << 15 != 0) {
            (true, _) => memory,
            (_, true) => bus,
            _ => 0,
        };
        (status, address)
    }
}
