//! Flash of the chip while the program runs from it. Only for the background, for the time of a request, and for the start.
#![allow(unsafe_code)]

#[cfg(not(feature = "stm32g474"))]
use trirrr_boot::stm32f405::ChipFlash;
#[cfg(feature = "stm32g474")]
use trirrr_boot::stm32g474::ChipFlash;
use trirrr_boot::{Flash, FlashError, Layout};

#[cfg(not(feature = "stm32g474"))]
pub(crate) const LAYOUT: Layout = Layout::STM32F405;
#[cfg(feature = "stm32g474")]
pub(crate) const LAYOUT: Layout = Layout::STM32G474;

/// Flash of the chip. An STM32F405 has one bank, and stands while a sector of it is erased; an STM32G474 runs on, for its program is in
/// another bank than all that it writes.
pub(crate) struct ImageFlash(ChipFlash);

impl ImageFlash {
    pub(crate) fn take() -> Self {
        // SAFETY: the start and then the background alone take it, one at a time, and the slots hold no code that runs. The chip's handler
        // of the non-maskable interrupt calls `is_lost_expected`.
        Self(unsafe { ChipFlash::take() })
    }
}

impl Flash for ImageFlash {
    type Unit = <ChipFlash as Flash>::Unit;

    fn unit(&self, address: u32) -> Option<Self::Unit> {
        self.0.unit(address)
    }

    /// Takes up to 2 s (DS8626, table 40). The watchdog has a longer period for this time, and no tick counts as late: the drives
    /// are off.
    #[cfg(not(feature = "stm32g474"))]
    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        use cortex_m::peripheral::{SCB, SYST};
        use trirrr_boot::watchdog;
        cortex_m::interrupt::free(|_| {
            let period = watchdog::set(watchdog::Period::LONGEST);
            let result = self.0.erase(sector);
            watchdog::set(period);
            // SAFETY: a register that the tick's handler only reads, and no handler runs now. The count starts anew: the next tick is
            // due in a whole period.
            unsafe { (*SYST::PTR).cvr.write(0) };
            SCB::clear_pendst();
            result
        })
    }

    /// Takes up to 25 ms (DS12288, characteristics of the flash), in which ticks go on and the background waits: less than the period of the
    /// watchdog.
    #[cfg(feature = "stm32g474")]
    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        self.0.erase(sector)
    }

    // STM32F405: 16 us: a tick that is due meanwhile comes so much later.
    fn program(&mut self, address: u32, unit: Self::Unit) -> Result<(), FlashError> {
        self.0.program(address, unit)
    }
}

/// To be called by the handler of the non-maskable interrupt of an STM32G474. Returns `false` where the program itself has lost content.
#[cfg(feature = "stm32g474")]
pub fn is_lost_expected() -> bool {
    trirrr_boot::stm32g474::is_expected()
}
