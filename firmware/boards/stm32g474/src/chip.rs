//! Registers that are written after a failure, from wherever the program has come to its end.

use core::ops::Range;
use stm32_metapac::RCC;
use trirrr_app::failure::Chip;
#[cfg(outputs)]
use trirrr_app::failure::end;
#[cfg(outputs)]
use trirrr_protocol::message::Start;

trirrr_app::failure_handlers!(Stm32g474);

/// The microcontroller.
struct Stm32g474;

impl Chip for Stm32g474 {
    /// As in `regions.x`.
    const RAM: Range<usize> = 0x2000_0000..0x2002_0000;

    /// Resets the ports A to G. Every pin is let go, as in a reset; the wiring has to take that for off (`docs/board.md`).
    fn outputs_off() {
        RCC.ahb2rstr().write(|w| w.0 = 0x7F);
    }

    fn reset() -> ! {
        cortex_m::peripheral::SCB::sys_reset()
    }

    fn fault_status() -> (u32, u32) {
        crate::fault_status::fault_status()
    }
}

/// The crystal has stopped, and the chip has put the core on the internal oscillator; or the flash tells that a double word is lost: one that a
/// cut of the power has left, or one of the program. Nothing masks this exception.
#[cfg(any(outputs, update))]
#[cortex_m_rt::exception]
#[allow(unsafe_code)]
unsafe fn NonMaskableInt() {
    #[cfg(outputs)]
    if RCC.cifr().read().cssf() {
        end::<Stm32g474>(&Start::CrystalStopped);
    }
    #[cfg(update)]
    if !trirrr_app::is_lost_expected() {
        panic!("the flash has lost a part of the program");
    }
}
