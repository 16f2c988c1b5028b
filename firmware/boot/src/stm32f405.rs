//! Flash and independent watchdog of the STM32F405 (RM0090, chapters 3 and 21), by their registers alone: the boot loader has room
//! for no more.
#![allow(unsafe_code)]

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

/// Reads of the status before the flash counts as one that does not end. Each of them stands while the flash is busy.
const READS: u32 = 1 << 24;

fn read(register: u32) -> u32 {
    // SAFETY: an aligned word of the flash or of its registers, which every STM32F405 has; reading changes nothing.
    unsafe { (register as *const u32).read_volatile() }
}

fn write(register: u32, value: u32) {
    // SAFETY: a register of flash or watchdog, which nothing else in the program uses while the owner of this module's types does,
    // or a word of a slot that holds no code that runs.
    unsafe { (register as *mut u32).write_volatile(value) }
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
    fn word(&self, address: u32) -> u32 {
        read(address)
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

    fn program(&mut self, address: u32, word: u32) -> Result<(), FlashError> {
        Self::begin(WORDS | PROGRAM);
        write(address, word);
        Self::end(address)
    }
}

/// Registers of the independent watchdog.
pub mod watchdog {
    use super::{READS, read, write};

    const KEY: u32 = 0x4000_3000;
    const PRESCALER: u32 = 0x4000_3004;
    const RELOAD: u32 = 0x4000_3008;
    const STATUS: u32 = 0x4000_300C;

    /// Prescaler and reload value.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Period {
        prescaler: u32,
        reload: u32,
    }

    impl Period {
        /// Longest: 32 s, and from 22 to 62 s with the oscillator's tolerance.
        pub const LONGEST: Self = Self {
            prescaler: 6,
            reload: 0xFFF,
        };

        /// 4 s, and from 2.7 to 7.5 s.
        pub const TRIAL: Self = Self {
            prescaler: 6,
            reload: 499,
        };
    }

    /// Starts the watchdog.
    pub fn start(period: Period) {
        write(KEY, 0xCCCC);
        set(period);
    }

    /// Sets another period and feeds the watchdog. Returns the period before.
    pub fn set(period: Period) -> Period {
        settled();
        let before = Period {
            prescaler: read(PRESCALER),
            reload: read(RELOAD),
        };
        // The count goes on with the new prescaler until it is reloaded: from its beginning.
        write(KEY, 0xAAAA);
        write(KEY, 0x5555);
        write(PRESCALER, period.prescaler);
        write(RELOAD, period.reload);
        settled();
        write(KEY, 0xAAAA);
        before
    }

    /// Waits until a change of before has arrived in the watchdog's own clock.
    fn settled() {
        let _ = (0..READS).any(|_| read(STATUS) & 3 == 0);
    }
}
