//! Flash controller of the STM32F405: keys, erasure of sectors, words that are programmed (RM0090, chapter 3). The processor stands meanwhile: the
//! chip has one bank, from which it executes.

use super::{FLASH, FlashRegisters, RegisterEffect, Store, StoreEffect};
use crate::time::{SECOND, Time};

/// First address and size of each sector.
const SECTORS: [(u32, u32); 12] = {
    const KIB: u32 = 1024;
    let mut sectors = [(0, 0); 12];
    let (mut index, mut at) = (0, FLASH);
    while index < 12 {
        let bytes = match index {
            0..4 => 16 * KIB,
            4 => 64 * KIB,
            _ => 128 * KIB,
        };
        sectors[index] = (at, bytes);
        at += bytes;
        index += 1;
    }
    sectors
};

/// The data sheet's typical time of a word (DS8626, table 40), 16 us.
const WORD: Time = SECOND / 62_500;

const PROGRAM: u32 = 1;
const SECTOR_ERASE: u32 = 1 << 1;
const START: u32 = 1 << 16;
const LOCK: u32 = 1 << 31;
/// Bits 8 and 9: 32 bits at a time.
const WORDS: u32 = 0b10 << 8;
/// Error of the programming sequence.
const SEQUENCE: u32 = 1 << 7;

pub(super) struct F405Flash {
    access: u32,
    /// Keys that came in their order.
    keys: u8,
    status: u32,
    control: u32,
}

impl F405Flash {
    pub(super) fn new() -> Self {
        Self {
            access: 0,
            keys: 0,
            status: 0,
            control: LOCK,
        }
    }

    fn control(&mut self, control: u32) -> RegisterEffect {
        self.control = control & !START;
        let sector = SECTORS.get((control >> 3 & 0xF) as usize);
        match sector {
            Some(&(start, bytes)) if control & START != 0 && control & SECTOR_ERASE != 0 => {
                // The longest of the data sheet, 32 bits at a time: 0.5 s, 1.1 s and 2 s.
                let time = match bytes >> 14 {
                    1 => SECOND / 2,
                    4 => SECOND * 11 / 10,
                    _ => 2 * SECOND,
                };
                RegisterEffect::Erase { start, bytes, time }
            }
            _ => RegisterEffect::None,
        }
    }
}

impl FlashRegisters for F405Flash {
    fn reset(&mut self) {
        *self = Self::new();
    }

    fn read(&self, offset: u32, _: Time) -> Option<u32> {
        match offset {
            0x00 => Some(self.access),
            0x0C => Some(self.status),
            0x10 => Some(self.control),
            // Option bytes: as they are delivered.
            0x14 => Some(0x0FFF_AAED),
            _ => None,
        }
    }

    fn write(&mut self, offset: u32, value: u32, _: Time) -> RegisterEffect {
        match (offset, value) {
            (0x00, _) => self.access = value,
            (0x04, 0x4567_0123) if self.keys == 0 => self.keys = 1,
            (0x04, 0xCDEF_89AB) if self.keys == 1 => {
                self.keys = 0;
                self.control &= !LOCK;
            }
            // Locked until the next reset.
            (0x04, _) if self.control & LOCK != 0 => self.keys = u8::MAX,
            (0x04, _) => self.keys = 0,
            (0x0C, _) => self.status &= !value,
            (0x10, _) if self.control & LOCK != 0 => {}
            (0x10, _) => return self.control(value),
            _ => return RegisterEffect::Unknown,
        }
        RegisterEffect::None
    }

    fn store(&mut self, store: Store, _: Time) -> StoreEffect {
        let is_ready = self.control & (LOCK | PROGRAM | WORDS | SECTOR_ERASE) == PROGRAM | WORDS;
        if !is_ready || store.size != 4 {
            self.status |= SEQUENCE;
            return StoreEffect::Refused {
                was_programmed: false,
            };
        }
        let mut unit = [0; 8];
        let at = (store.address % 8) as usize;
        // Bits only fall.
        for ((to, before), from) in unit
            .iter_mut()
            .zip(&store.before[at..])
            .zip(store.word.to_le_bytes())
        {
            *to = before & from;
        }
        StoreEffect::Program {
            address: store.address,
            unit,
            bytes: 4,
            time: WORD,
        }
    }

    fn begin(&mut self, _: u32, time: Time, _: Time, _: u32) -> Time {
        time
    }

    fn has_check_bits(&self) -> bool {
        false
    }

    fn tell_lost(&mut self, _: u32) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unlocked() -> F405Flash {
        let mut flash = F405Flash::new();
        for key in [0x4567_0123, 0xCDEF_89AB] {
            assert_eq!(flash.write(0x04, key, 0), RegisterEffect::None);
        }
        flash
    }

    fn store(flash: &mut F405Flash, before: u8, word: u32, size: usize) -> StoreEffect {
        let store = Store {
            address: FLASH,
            word,
            size,
            before: [before; 8],
            is_erased: before == 0xFF,
        };
        flash.store(store, 0)
    }

    const REFUSED: StoreEffect = StoreEffect::Refused {
        was_programmed: false,
    };

    #[test]
    fn the_last_sector_ends_with_the_flash() {
        let ends = SECTORS.map(|(start, bytes)| start + bytes);
        assert_eq!(ends[11], 0x0810_0000);
        assert_eq!((SECTORS[4].0, SECTORS[5].0), (0x0801_0000, 0x0802_0000));
    }

    #[test]
    fn nothing_is_written_without_the_keys() {
        let mut flash = F405Flash::new();
        flash.write(0x10, PROGRAM | WORDS, 0);
        assert_eq!(store(&mut flash, 0xFF, 1, 4), REFUSED);
        assert_eq!(flash.read(0x0C, 0), Some(SEQUENCE));
        // A wrong key locks until a reset.
        for key in [1, 0x4567_0123, 0xCDEF_89AB] {
            flash.write(0x04, key, 0);
        }
        assert_eq!(flash.read(0x10, 0), Some(LOCK));
        flash.reset();
        for key in [0x4567_0123, 0xCDEF_89AB] {
            flash.write(0x04, key, 0);
        }
        assert_eq!(flash.read(0x10, 0), Some(0));
    }

    #[test]
    fn a_sector_takes_its_time_and_words_lose_bits() {
        let mut flash = unlocked();
        let control = WORDS | SECTOR_ERASE | 7 << 3;
        assert_eq!(flash.write(0x10, control, 0), RegisterEffect::None);
        let (start, bytes) = SECTORS[7];
        let time = 2 * SECOND;
        assert_eq!(
            flash.write(0x10, control | START, 0),
            RegisterEffect::Erase { start, bytes, time }
        );
        assert_eq!(store(&mut flash, 0xFF, 1, 4), REFUSED);
        flash.write(0x0C, SEQUENCE, 0);
        flash.write(0x10, PROGRAM | WORDS, 0);
        let unit = [0x0F, 0x00, 0, 0, 0, 0, 0, 0];
        let fallen = StoreEffect::Program {
            address: FLASH,
            unit,
            bytes: 4,
            time: WORD,
        };
        assert_eq!(store(&mut flash, 0x0F, 0x00FF, 4), fallen);
        assert_eq!(store(&mut flash, 0xFF, 1, 2), REFUSED);
        flash.write(0x10, LOCK, 0);
        assert_eq!(flash.write(0x10, PROGRAM, 0), RegisterEffect::None);
        assert_eq!(flash.read(0x10, 0), Some(LOCK));
    }
}
