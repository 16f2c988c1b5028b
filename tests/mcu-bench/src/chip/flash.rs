//! Flash controller: keys, erasure of sectors, words that are programmed (RM0090, chapter 3). The processor stands meanwhile: the
//! chip has one bank, from which it executes.

use crate::time::{SECOND, Time};

/// First address and size of each sector.
const SECTORS: [(u32, u32); 12] = {
    const KIB: u32 = 1024;
    let mut sectors = [(0, 0); 12];
    let (mut index, mut at) = (0, 0x0800_0000);
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

/// Consequence of a write to a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FlashEffect {
    /// None outside of the controller.
    None,
    /// These bytes are erased, and the processor has stood for this time.
    Erased { start: u32, bytes: u32, time: Time },
    /// There is no such register.
    Unknown,
}

pub(crate) struct FlashControl {
    access: u32,
    /// Keys that came in their order.
    keys: u8,
    status: u32,
    control: u32,
    /// Erasures and words so far, a wear of the flash.
    pub(crate) erasures: u32,
    pub(crate) words: u32,
}

impl FlashControl {
    pub(crate) fn new() -> Self {
        Self {
            access: 0,
            keys: 0,
            status: 0,
            control: LOCK,
            erasures: 0,
            words: 0,
        }
    }

    /// Registers as after a reset.
    pub(crate) fn reset(&mut self) {
        *self = Self {
            erasures: self.erasures,
            words: self.words,
            ..Self::new()
        };
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        match offset {
            0x00 => Some(self.access),
            0x0C => Some(self.status),
            0x10 => Some(self.control),
            // Option bytes: as they are delivered.
            0x14 => Some(0x0FFF_AAED),
            _ => None,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> FlashEffect {
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
            (0x10, _) => return self.begin(value),
            _ => return FlashEffect::Unknown,
        }
        FlashEffect::None
    }

    fn begin(&mut self, control: u32) -> FlashEffect {
        self.control = control & !START;
        let sector = SECTORS.get((control >> 3 & 0xF) as usize);
        match sector {
            Some(&(start, bytes)) if control & START != 0 && control & SECTOR_ERASE != 0 => {
                self.erasures += 1;
                // The longest of the data sheet, 32 bits at a time: 0.5 s, 1.1 s and 2 s.
                let time = match bytes >> 14 {
                    1 => SECOND / 2,
                    4 => SECOND * 11 / 10,
                    _ => 2 * SECOND,
                };
                FlashEffect::Erased { start, bytes, time }
            }
            _ => FlashEffect::None,
        }
    }

    /// Takes a word that the processor writes over `before`. Returns the word that is there then, and the time for which the processor stands.
    /// `None`: the controller does not let it, and sets its flag.
    pub(crate) fn store(&mut self, before: u32, word: u32, size: usize) -> Option<(u32, Time)> {
        let is_ready = self.control & (LOCK | PROGRAM | WORDS | SECTOR_ERASE) == PROGRAM | WORDS;
        if !is_ready || size != 4 {
            self.status |= SEQUENCE;
            return None;
        }
        self.words += 1;
        // Bits only fall.
        Some((before & word, WORD))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn unlocked() -> FlashControl {
        let mut flash = FlashControl::new();
        for key in [0x4567_0123, 0xCDEF_89AB] {
            assert_eq!(flash.write(0x04, key), FlashEffect::None);
        }
        flash
    }

    #[test]
    fn the_last_sector_ends_with_the_flash() {
        let ends = SECTORS.map(|(start, bytes)| start + bytes);
        assert_eq!(ends[11], 0x0810_0000);
        assert_eq!((SECTORS[4].0, SECTORS[5].0), (0x0801_0000, 0x0802_0000));
    }

    #[test]
    fn nothing_is_written_without_the_keys() {
        let mut flash = FlashControl::new();
        flash.write(0x10, PROGRAM | WORDS);
        assert_eq!(flash.store(u32::MAX, 1, 4), None);
        assert_eq!(flash.read(0x0C), Some(SEQUENCE));
        // A wrong key locks until a reset.
        for key in [1, 0x4567_0123, 0xCDEF_89AB] {
            flash.write(0x04, key);
        }
        assert_eq!(flash.read(0x10), Some(LOCK));
        flash.reset();
        for key in [0x4567_0123, 0xCDEF_89AB] {
            flash.write(0x04, key);
        }
        assert_eq!(flash.read(0x10), Some(0));
    }

    #[test]
    fn a_sector_takes_its_time_and_words_lose_bits() {
        let mut flash = unlocked();
        let control = WORDS | SECTOR_ERASE | 7 << 3;
        assert_eq!(flash.write(0x10, control), FlashEffect::None);
        let erased = flash.write(0x10, control | START);
        let (start, bytes) = SECTORS[7];
        assert_eq!(
            erased,
            FlashEffect::Erased {
                start,
                bytes,
                time: 2 * SECOND
            }
        );
        assert_eq!(flash.store(u32::MAX, 1, 4), None);
        flash.write(0x0C, SEQUENCE);
        flash.write(0x10, PROGRAM | WORDS);
        assert_eq!(flash.store(0x0FF0, 0x00FF, 4), Some((0x00F0, WORD)));
        assert_eq!(flash.store(u32::MAX, 1, 2), None);
        flash.write(0x10, LOCK);
        assert_eq!(flash.write(0x10, PROGRAM), FlashEffect::None);
        assert_eq!(flash.read(0x10), Some(LOCK));
        assert_eq!((flash.erasures, flash.words), (1, 1));
    }
}
