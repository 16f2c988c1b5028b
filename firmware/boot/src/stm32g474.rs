//! Flash of the STM32G474 (RM0440, chapter 3), by its registers alone. It programs double words of 64 bits with eight check bits each.
//!
//! # Lost content
//! A double word whose programming or erasure was cut by a loss of power may have check bits that do not go with it. The flash corrects one
//! bit. With more it tells so in `FLASH_ECCR`, and the processor takes a non-maskable interrupt. The program's handler of that interrupt calls
//! [`is_expected`]. A double word that was read for its content here counts as lost; one that was read elsewhere is code or a constant of the
//! program.
#![allow(unsafe_code)]

use crate::registers::{Controller, READS, read, write};
use crate::{Flash, FlashError};
use core::sync::atomic::{AtomicU8, Ordering};

const ACR: u32 = 0x4002_2000;
const ECCR: u32 = 0x4002_2018;
const OPTR: u32 = 0x4002_2020;

const CONTROLLER: Controller = Controller {
    keys: 0x4002_2008,
    status: 0x4002_2010,
    control: 0x4002_2014,
    flags: FLAGS,
    errors: FLAGS & !END,
};

/// Caches of instructions and of data: on, and reset.
const INSTRUCTION_CACHE: u32 = 1 << 9;
const DATA_CACHE: u32 = 1 << 10;
const INSTRUCTIONS_RESET: u32 = 1 << 11;
const DATA_RESET: u32 = 1 << 12;

/// End of an operation, and errors of operation, programming, protection, alignment, size and sequence.
const FLAGS: u32 = 0b11_1111_1011;
const END: u32 = 1;

const PROGRAM: u32 = 1;
const PAGE_ERASE: u32 = 1 << 1;
/// Place of the page's number, and the bit of the second bank.
const PAGE: u32 = 3;
const SECOND_BANK: u32 = 1 << 11;

/// Two errors in a double word, and one that was corrected.
const LOST: u32 = 1 << 31;
const CORRECTED: u32 = 1 << 30;

/// Option of two banks, as delivered.
const TWO_BANKS: u32 = 1 << 22;
/// Pages of a bank.
const PAGES: u8 = 128;

/// Progress of a look at a double word.
static LOOK: AtomicU8 = AtomicU8::new(NONE);
const NONE: u8 = 0;
const UNDER_WAY: u8 = 1;
const IS_LOST: u8 = 2;

/// To be called by the handler of the non-maskable interrupt: clears the cause. Returns `false` for a double word that is lost and was not
/// read through [`ChipFlash`]: the program itself has a hole.
pub fn is_expected() -> bool {
    if read(ECCR) & LOST == 0 {
        // Called a second time for both words of the same one.
        return true;
    }
    write(ECCR, LOST | CORRECTED);
    match LOOK.load(Ordering::Relaxed) {
        NONE => false,
        _ => {
            LOOK.store(IS_LOST, Ordering::Relaxed);
            true
        }
    }
}

/// Runs an operation of the flash with the cache of data off, and empties that cache behind it: it may take wrong content where the processor reads one
/// bank while the other is written (errata sheet ES0430, 2.2.2).
fn uncached<T>(operation: impl FnOnce() -> T) -> T {
    let access = read(ACR);
    write(ACR, access & !DATA_CACHE);
    let result = operation();
    write(ACR, access & !DATA_CACHE | DATA_RESET);
    write(ACR, access);
    result
}

/// Flash of the chip, of two banks.
#[derive(Debug)]
pub struct ChipFlash(());

impl ChipFlash {
    /// Takes the flash.
    ///
    /// # Safety
    /// There is one at a time, and slots without code that runs are its only use. The handler of the non-maskable interrupt calls
    /// [`is_expected`].
    pub const unsafe fn take() -> Self {
        Self(())
    }
}

impl Flash for ChipFlash {
    type Unit = u64;

    fn unit(&self, address: u32) -> Option<u64> {
        let access = read(ACR);
        // The cache would hide a second look at a lost double word from the check.
        write(ACR, access & !DATA_CACHE);
        LOOK.store(UNDER_WAY, Ordering::Relaxed);
        let (low, high) = (read(address), read(address + 4));
        // The interrupt comes within some cycles, and its handler clears the flag.
        let is_told = (0..READS).any(|_| read(ECCR) & LOST == 0);
        let is_whole = LOOK.swap(NONE, Ordering::Relaxed) == UNDER_WAY;
        write(ACR, access);
        (is_told && is_whole).then(|| u64::from(low) | u64::from(high) << 32)
    }

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        let options = read(OPTR);
        if options & TWO_BANKS == 0 {
            // Pages of one bank have twice the size, and the program would stand for each.
            return Err(FlashError {
                place: sector.into(),
                status: options,
            });
        }
        let bank = if sector < PAGES { 0 } else { SECOND_BANK };
        let control = PAGE_ERASE | u32::from(sector % PAGES) << PAGE | bank;
        let result = uncached(|| CONTROLLER.erase(control, sector.into()));
        // Its lines may be of the page.
        let access = read(ACR);
        write(ACR, access & !INSTRUCTION_CACHE);
        write(ACR, access & !INSTRUCTION_CACHE | INSTRUCTIONS_RESET);
        write(ACR, access);
        result
    }

    fn program(&mut self, address: u32, unit: u64) -> Result<(), FlashError> {
        uncached(|| {
            CONTROLLER.begin(PROGRAM);
            write(address, unit as u32);
            // In two accesses, the first one before the second (RM0440, 3.3.7).
            cortex_m::asm::isb();
            write(address + 4, (unit >> 32) as u32);
            CONTROLLER.end(address)
        })
    }
}
