//! Flash of the STM32F405 (RM0090, chapter 3), by its registers alone: the boot loader has room for no more. It has no check bits: content that
//! is lost fails the checksums.
#![allow(unsafe_code)]

use crate::registers::{READS, read, write};
use crate::{Flash, FlashError};

const ACR: u32 = 0x4002_3C00;
const KEYR: u32 = 0x4002_3C04;
const SR: u32 = 0x4002_3C0C;
const CR: u32 = 0x4002_3C10;

/// Caches of instructions and data: on, and reset.
const CACHES_ON: u32 = 0b11 << 9;
const CACHES_RESET: u32 = 0b11 << 11;

const BUSY: u32 = 1 << 16;
/// Errors of sequence, parallelism, alignment, protection and operation.
const ERRORS: u32 = 0b1111_0010;

const PROGRAM: u32 = 1;
const SECTOR_ERASE: u32 = 1 << 1;
/// 32 bits at a time, for a supply of 2.7 to 3.6 V.
const WORDS: u32 = 0b10 << 8;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

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

    /// Waits for the end of an operation that `control` names, and locks the flash again.
    fn end(place: u32) -> Result<(), FlashError> {
        let ended = (0..READS).any(|_| read(SR) & BUSY == 0);
        let status = read(SR);
        write(CR, LOCK);
        match ended && status & ERRORS == 0 {
            true => Ok(()),
            false => Err(FlashError { place, status }),
        }
    }

    fn begin(control: u32) {
        write(KEYR, 0x4567_0123);
        write(KEYR, 0xCDEF_89AB);
        // Errors of before.
        write(SR, ERRORS);
        write(CR, control);
    }
}

impl Flash for ChipFlash {
    type Unit = u32;

    fn unit(&self, address: u32) -> Option<u32> {
        Some(read(address))
    }

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        let control = WORDS | SECTOR_ERASE | u32::from(sector) << 3;
        Self::begin(control);
        write(CR, control | START);
        let result = Self::end(sector.into());
        // Lines of the caches may be of the sector (RM0090, 3.6.4); words that are programmed change in the caches, too.
        let access = read(ACR);
        write(ACR, access & !CACHES_ON);
        write(ACR, access & !CACHES_ON | CACHES_RESET);
        write(ACR, access);
        result
    }

    fn program(&mut self, address: u32, unit: u32) -> Result<(), FlashError> {
        Self::begin(WORDS | PROGRAM);
        write(address, unit);
        Self::end(address)
    }
}
