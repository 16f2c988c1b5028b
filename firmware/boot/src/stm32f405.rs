//! Flash of the STM32F405 (RM0090, chapter 3), by its registers alone: the boot loader has room for no more. It has no check bits: content that
//! is lost fails the checksums.
#![allow(unsafe_code)]

use crate::registers::{Controller, read, write};
use crate::{Flash, FlashError};

const ACR: u32 = 0x4002_3C00;

const CONTROLLER: Controller = Controller {
    keys: 0x4002_3C04,
    status: 0x4002_3C0C,
    control: 0x4002_3C10,
    flags: ERRORS,
    errors: ERRORS,
};

/// Caches of instructions and data: on, and reset.
const CACHES_ON: u32 = 0b11 << 9;
const CACHES_RESET: u32 = 0b11 << 11;

/// Errors of sequence, parallelism, alignment, protection and operation.
const ERRORS: u32 = 0b1111_0010;

const PROGRAM: u32 = 1;
const SECTOR_ERASE: u32 = 1 << 1;
/// 32 bits at a time, for a supply of 2.7 to 3.6 V.
const WORDS: u32 = 0b10 << 8;

/// Clock of PWR, and its registers: the detector of the supply with its level of 2.7 V, and the bit that tells a lower one.
const APB1ENR: u32 = 0x4002_3840;
const PWREN: u32 = 1 << 28;
const PWR_CR: u32 = 0x4000_7000;
const DETECTOR: u32 = 5 << 5 | 1 << 4;
const PWR_CSR: u32 = 0x4000_7004;
const IS_LOW: u32 = 1 << 2;

/// Cycles until the detector tells the level: 100 us at 168 MHz, 1 ms at 16 MHz.
const SETTLING: u32 = 16_800;

/// Refuses an operation while the supply is below 2.7 V, which 32 bits at a time take: a cell might hold too little. Leaves the detector on.
fn check_supply(place: u32) -> Result<(), FlashError> {
    if read(PWR_CR) & DETECTOR != DETECTOR {
        write(APB1ENR, read(APB1ENR) | PWREN);
        // The clock comes two cycles later (errata sheet ES0182).
        let _ = read(APB1ENR);
        write(PWR_CR, read(PWR_CR) | DETECTOR);
        cortex_m::asm::delay(SETTLING);
    }
    match read(PWR_CSR) & IS_LOW {
        0 => Ok(()),
        _ => Err(FlashError {
            place,
            status: FlashError::LOW_SUPPLY,
        }),
    }
}

/// Flash of the chip.
#[derive(Debug)]
pub struct ChipFlash(());

impl ChipFlash {
    /// Takes the flash.
    ///
    /// # Safety
    /// There is one at a time, and slots without code that runs are its only use.
    pub const unsafe fn take() -> Self {
        Self(())
    }
}

impl Flash for ChipFlash {
    type Unit = u32;

    fn unit(&self, address: u32) -> Option<u32> {
        Some(read(address))
    }

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        check_supply(sector.into())?;
        let control = WORDS | SECTOR_ERASE | u32::from(sector) << 3;
        let result = CONTROLLER.erase(control, sector.into());
        // Lines of the caches may be of the sector (RM0090, 3.6.4); words that are programmed change in the caches, too.
        let access = read(ACR);
        write(ACR, access & !CACHES_ON);
        write(ACR, access & !CACHES_ON | CACHES_RESET);
        write(ACR, access);
        result
    }

    fn program(&mut self, address: u32, unit: u32) -> Result<(), FlashError> {
        check_supply(address)?;
        CONTROLLER.begin(WORDS | PROGRAM);
        write(address, unit);
        CONTROLLER.end(address)
    }
}
