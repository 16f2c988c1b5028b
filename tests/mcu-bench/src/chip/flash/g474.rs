//! Flash controller of the STM32G474 with two banks: keys, erasure of pages, double words that are programmed, check bits (RM0440, chapter 3).
//! The processor stands while an operation is under way in the bank from which it executes.

use super::{FLASH, FlashRegisters, RegisterEffect, Store, StoreEffect};
use crate::time::{SECOND, Time};

/// Bytes of a page, and of a bank.
const PAGE: u32 = 2 * 1024;
const BANK: u32 = 256 * 1024;

/// The data sheet's typical time of a double word, and its longest of a page (DS12288, characteristics of the flash): 81.7 us, 24.47 ms.
const DOUBLE_WORD: Time = SECOND * 817 / 10_000_000;
const ERASURE: Time = SECOND * 2447 / 100_000;

const PROGRAM: u32 = 1;
const PAGE_ERASE: u32 = 1 << 1;
const SECOND_BANK: u32 = 1 << 11;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;

const BUSY: u32 = 1 << 16;
/// Errors: cells that are not erased, alignment, size, sequence.
const PROGRAMMED: u32 = 1 << 3;
const ALIGNMENT: u32 = 1 << 5;
const SIZE: u32 = 1 << 6;
const SEQUENCE: u32 = 1 << 7;
const ERRORS: u32 = 0b11_1111_1010;

/// Two errors in a double word, and its address in the two banks.
const LOST: u32 = 1 << 31;
const CORRECTED: u32 = 1 << 30;

/// Caches of instructions and data: on, and reset.
const INSTRUCTIONS_ON: u32 = 1 << 9;
const DATA_ON: u32 = 1 << 10;
const INSTRUCTIONS_RESET: u32 = 1 << 11;
const DATA_RESET: u32 = 1 << 12;

pub(super) struct G474Flash {
    access: u32,
    /// Resets of caches that are due before they may be on.
    stale: u32,
    /// Keys that came in their order.
    keys: u8,
    status: u32,
    control: u32,
    check: u32,
    /// First word of a double word, with its address.
    first: Option<(u32, u32)>,
    busy_until: Time,
}

impl G474Flash {
    pub(super) fn new() -> Self {
        Self {
            // Both caches are on.
            access: INSTRUCTIONS_ON | DATA_ON,
            stale: 0,
            keys: 0,
            status: 0,
            control: LOCK | 1 << 30,
            check: 0,
            first: None,
            busy_until: 0,
        }
    }

    fn control(&mut self, control: u32, now: Time) -> RegisterEffect {
        self.control = control & !START;
        if control & PROGRAM == 0 {
            self.first = None;
        }
        if control & START == 0 {
            return RegisterEffect::None;
        }
        let is_ready = control & (PROGRAM | PAGE_ERASE) == PAGE_ERASE
            && self.access & DATA_ON == 0
            && self.status & ERRORS == 0
            && now >= self.busy_until;
        if !is_ready {
            self.status |= SEQUENCE;
            return RegisterEffect::Unknown;
        }
        self.stale = INSTRUCTIONS_RESET | DATA_RESET;
        let bank = if control & SECOND_BANK != 0 { BANK } else { 0 };
        RegisterEffect::Erase {
            start: FLASH + bank + (control >> 3 & 0x7F) * PAGE,
            bytes: PAGE,
            time: ERASURE,
        }
    }

    /// Sets the caches. Returns an error for a reset of one that is on, and for one of data that is switched on with what it may have read wrong
    /// during an operation (errata sheet ES0430, 2.2.2).
    fn set_access(&mut self, access: u32) -> RegisterEffect {
        let on = (access & (INSTRUCTIONS_ON | DATA_ON)) << 2;
        let resets = access & (INSTRUCTIONS_RESET | DATA_RESET);
        self.stale &= !resets;
        self.access = access;
        match on & resets != 0 || on & self.stale & DATA_RESET != 0 {
            true => RegisterEffect::Unknown,
            false => RegisterEffect::None,
        }
    }

    fn refuse(&mut self, flag: u32) -> StoreEffect {
        self.status |= flag;
        self.first = None;
        StoreEffect::Refused {
            was_programmed: flag == PROGRAMMED,
        }
    }
}

impl FlashRegisters for G474Flash {
    fn reset(&mut self) {
        *self = Self::new();
    }

    fn read(&self, offset: u32, now: Time) -> Option<u32> {
        let busy = if now < self.busy_until { BUSY } else { 0 };
        match offset {
            0x00 => Some(self.access),
            0x10 => Some(self.status | busy),
            0x14 => Some(self.control),
            0x18 => Some(self.check),
            // Option bytes as they are delivered: two banks.
            0x20 => Some(0xFFEF_F8AA),
            _ => None,
        }
    }

    fn write(&mut self, offset: u32, value: u32, now: Time) -> RegisterEffect {
        match (offset, value) {
            (0x00, _) => return self.set_access(value),
            (0x08, 0x4567_0123) if self.keys == 0 => self.keys = 1,
            (0x08, 0xCDEF_89AB) if self.keys == 1 => {
                self.keys = 0;
                self.control &= !LOCK;
            }
            // Locked until the next reset.
            (0x08, _) if self.control & LOCK != 0 => self.keys = u8::MAX,
            (0x08, _) => self.keys = 0,
            (0x10, _) => self.status &= !value,
            (0x14, _) if self.control & LOCK != 0 => {}
            (0x14, _) => return self.control(value, now),
            (0x18, _) => self.check &= !(value & (LOST | CORRECTED)),
            _ => return RegisterEffect::Unknown,
        }
        RegisterEffect::None
    }

    fn store(&mut self, store: Store, now: Time) -> StoreEffect {
        let is_ready = self.control & (LOCK | PROGRAM | PAGE_ERASE) == PROGRAM
            && self.access & DATA_ON == 0
            && self.status & ERRORS == 0
            && now >= self.busy_until;
        match (is_ready, store.size, self.first, store.address % 8) {
            (false, ..) => self.refuse(SEQUENCE),
            (_, 4, None, 0) => {
                self.first = Some((store.address, store.word));
                StoreEffect::Waits
            }
            (_, 4, Some((address, low)), 4) if address + 4 == store.address => {
                self.first = None;
                self.stale |= DATA_RESET;
                if !store.is_erased && (low, store.word) != (0, 0) {
                    return self.refuse(PROGRAMMED);
                }
                let unit = u64::from(low) | u64::from(store.word) << 32;
                StoreEffect::Program {
                    address,
                    unit: unit.to_le_bytes(),
                    bytes: 8,
                    time: DOUBLE_WORD,
                }
            }
            (_, 4, ..) => self.refuse(ALIGNMENT),
            _ => self.refuse(SIZE),
        }
    }

    fn begin(&mut self, place: u32, time: Time, now: Time, executes_at: u32) -> Time {
        let is_same = (place - FLASH) / BANK == executes_at.wrapping_sub(FLASH) / BANK;
        match is_same {
            true => time,
            false => {
                self.busy_until = now + time;
                0
            }
        }
    }

    fn has_check_bits(&self) -> bool {
        true
    }

    fn tell_lost(&mut self, address: u32) {
        let (bank, offset) = ((address - FLASH) / BANK, (address - FLASH) % BANK);
        self.check |= LOST | bank << 21 | offset;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unlocked() -> G474Flash {
        let mut flash = G474Flash::new();
        assert_eq!(flash.write(0x00, INSTRUCTIONS_ON, 0), RegisterEffect::None);
        for key in [0x4567_0123, 0xCDEF_89AB] {
            assert_eq!(flash.write(0x08, key, 0), RegisterEffect::None);
        }
        flash
    }

    fn store(flash: &mut G474Flash, address: u32, word: u32, is_erased: bool) -> StoreEffect {
        let store = Store {
            address,
            word,
            size: 4,
            before: [if is_erased { 0xFF } else { 0x55 }; 8],
            is_erased,
        };
        flash.store(store, 0)
    }

    fn refused(flash: &G474Flash, effect: StoreEffect) -> Option<u32> {
        matches!(effect, StoreEffect::Refused { .. }).then(|| flash.status & ERRORS)
    }

    #[test]
    fn a_page_is_that_of_its_bank_and_stops_the_processor_in_it() {
        let mut flash = unlocked();
        let control = PAGE_ERASE | SECOND_BANK | 40 << 3;
        let erased = flash.write(0x14, control | START, 0);
        let start = 0x0805_4000;
        let (bytes, time) = (2048, ERASURE);
        assert_eq!(erased, RegisterEffect::Erase { start, bytes, time });
        assert_eq!(flash.begin(start, time, 0, 0x0804_0000), time);
        assert_eq!(flash.read(0x10, 0), Some(0));
        assert_eq!(flash.begin(start, time, 0, 0x0800_4000), 0);
        assert_eq!(flash.read(0x10, time - 1), Some(BUSY));
        assert_eq!(flash.read(0x10, time), Some(0));
        // Not before the end.
        assert_eq!(
            flash.write(0x14, control | START, time - 1),
            RegisterEffect::Unknown
        );
    }

    #[test]
    fn a_double_word_comes_in_two_words_and_once() {
        let mut flash = unlocked();
        flash.write(0x14, PROGRAM, 0);
        assert_eq!(store(&mut flash, FLASH, 1, true), StoreEffect::Waits);
        let whole = StoreEffect::Program {
            address: FLASH,
            unit: [1, 0, 0, 0, 2, 0, 0, 0],
            bytes: 8,
            time: DOUBLE_WORD,
        };
        assert_eq!(store(&mut flash, FLASH + 4, 2, true), whole);
        store(&mut flash, FLASH, 1, false);
        let again = store(&mut flash, FLASH + 4, 2, false);
        assert_eq!(refused(&flash, again), Some(PROGRAMMED));
        // Nothing goes on before the flag is cleared.
        let next = store(&mut flash, FLASH, 0, false);
        assert_eq!(refused(&flash, next), Some(PROGRAMMED | SEQUENCE));
        flash.write(0x10, ERRORS, 0);
        store(&mut flash, FLASH, 0, false);
        assert!(matches!(
            store(&mut flash, FLASH + 4, 0, false),
            StoreEffect::Program { .. }
        ));
    }

    #[test]
    fn the_cache_of_data_is_off_during_an_operation_and_empty_behind_it() {
        let mut flash = unlocked();
        flash.write(0x00, DATA_ON, 0);
        let erasure = PAGE_ERASE | START;
        assert_eq!(flash.write(0x14, erasure, 0), RegisterEffect::Unknown);
        let mut flash = unlocked();
        flash.write(0x00, DATA_ON, 0);
        flash.write(0x14, PROGRAM, 0);
        let cached = store(&mut flash, FLASH, 1, true);
        assert_eq!(refused(&flash, cached), Some(SEQUENCE));
        let mut flash = unlocked();
        flash.write(0x14, erasure, 0);
        assert_eq!(flash.write(0x00, DATA_ON, 0), RegisterEffect::Unknown);
        flash.write(0x00, 0, 0);
        assert_eq!(flash.write(0x00, DATA_RESET, 0), RegisterEffect::None);
        assert_eq!(flash.write(0x00, DATA_ON, 0), RegisterEffect::None);
        let reset = flash.write(0x00, DATA_ON | DATA_RESET, 0);
        assert_eq!(reset, RegisterEffect::Unknown);
    }

    #[test]
    fn a_wrong_use_has_its_flag() {
        let mut flash = G474Flash::new();
        flash.write(0x14, PROGRAM, 0);
        let locked = store(&mut flash, FLASH, 1, true);
        assert_eq!(refused(&flash, locked), Some(SEQUENCE));
        let mut flash = unlocked();
        flash.write(0x14, PROGRAM, 0);
        let second = store(&mut flash, FLASH + 4, 1, true);
        assert_eq!(refused(&flash, second), Some(ALIGNMENT));
        let mut flash = unlocked();
        flash.write(0x14, PROGRAM, 0);
        let half = flash.store(
            Store {
                address: FLASH,
                word: 1,
                size: 2,
                before: [0xFF; 8],
                is_erased: true,
            },
            0,
        );
        assert_eq!(refused(&flash, half), Some(SIZE));
    }

    #[test]
    fn a_lost_double_word_is_told_until_the_flag_is_cleared() {
        let mut flash = G474Flash::new();
        flash.tell_lost(0x0805_4008);
        assert_eq!(flash.read(0x18, 0), Some(LOST | 1 << 21 | 0x1_4008));
        flash.write(0x18, LOST, 0);
        assert_eq!(flash.read(0x18, 0).map(|check| check & LOST), Some(0));
    }
}
