//! Flash of the chip while the program runs from it. Only for the background, for the time of a request, and for the start.
#![allow(unsafe_code)]

#[cfg(not(feature = "stm32g474"))]
mod stm32f405;
#[cfg(feature = "stm32g474")]
mod stm32g474;

#[cfg(not(feature = "stm32g474"))]
use stm32f405 as chip;
#[cfg(feature = "stm32g474")]
use stm32g474 as chip;

pub(crate) use chip::LAYOUT;
pub use chip::is_lost_expected;

use chip::ChipFlash;
use trirrr_boot::{Flash, FlashError, JournalError, ReceiveError};
use trirrr_protocol::message::UpdateRefusal;

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

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        chip::erase(&mut self.0, sector)
    }

    // STM32F405: 16 us: a tick that is due meanwhile comes so much later.
    fn program(&mut self, address: u32, unit: Self::Unit) -> Result<(), FlashError> {
        self.0.program(address, unit)
    }
}

/// Refusal of what has at most `longest` bytes.
pub(super) fn refusal(error: ReceiveError, longest: u32) -> UpdateRefusal {
    match error {
        ReceiveError::Length => UpdateRefusal::Length { longest },
        ReceiveError::NotBegun => UpdateRefusal::NotBegun,
        ReceiveError::Offset { expected } => UpdateRefusal::Block { expected },
        ReceiveError::Checksum { found } => UpdateRefusal::Checksum { found },
        ReceiveError::Journal(JournalError::Full) => UpdateRefusal::JournalFull,
        ReceiveError::Journal(JournalError::Flash(error)) => flash_refusal(error),
    }
}

pub(super) fn flash_refusal(FlashError { place, status }: FlashError) -> UpdateRefusal {
    UpdateRefusal::Flash { place, status }
}
