//! Parts of the flash.

use crate::FlashUnit;

/// Consecutive sectors of one size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Slot {
    /// Address of the first byte.
    pub start: u32,
    /// Bytes of a sector.
    pub sector_bytes: u32,
    /// Number of the first sector.
    pub first_sector: u8,
    /// Number of sectors.
    pub sectors: u8,
}

impl Slot {
    /// Bytes of the slot.
    pub const fn bytes(&self) -> u32 {
        self.sector_bytes * self.sectors as u32
    }

    /// Addresses of its first `bytes`, unit by unit.
    pub(crate) fn units<U: FlashUnit>(&self, bytes: u32) -> impl Iterator<Item = u32> + use<U> {
        (self.start..self.start + bytes.min(self.bytes())).step_by(U::BYTES as usize)
    }

    /// Numbers of its sectors.
    pub(crate) fn sectors(&self) -> impl Iterator<Item = u8> + use<> {
        self.first_sector..self.first_sector + self.sectors
    }
}

/// Slots and journal. The slots of programs have the same size.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Layout {
    /// Journal of updates.
    pub journal: Slot,
    /// The program that runs.
    pub program: Slot,
    /// The image that comes over the line.
    pub new: Slot,
    /// The program before the last update.
    pub old: Slot,
    /// Scenes that have come over the line: a sector each, which is erased with the first byte.
    pub scenes: [Slot; 2],
}

impl Layout {
    /// STM32F405RG and VG: 1 MiB in one bank (RM0090, table 5). The boot loader has sector 0. Sectors 4 and 11 are free, 64 KiB and
    /// 128 KiB.
    pub const STM32F405: Self = Self {
        journal: Self::small(0x0800_4000, 1),
        program: Self::pair(0x0802_0000, 5),
        new: Self::pair(0x0806_0000, 7),
        old: Self::pair(0x080A_0000, 9),
        scenes: [Self::small(0x0800_8000, 2), Self::small(0x0800_C000, 3)],
    };

    /// STM32G474RE: 512 KiB in two banks of 128 pages (RM0440, 3.3.1). The boot loader has the first eight pages; pages 252 to 255 are
    /// free. The program is in the first bank, and all that it writes is in the second: it runs on meanwhile.
    pub const STM32G474: Self = Self {
        program: Self::pages(8, 80),
        old: Self::pages(88, 80),
        new: Self::pages(168, 80),
        journal: Self::pages(248, 2),
        scenes: [Self::pages(250, 1), Self::pages(251, 1)],
    };

    /// Pages of 2 KiB.
    const fn pages(first: u8, count: u8) -> Slot {
        const BYTES: u32 = 2 * 1024;
        Slot {
            start: 0x0800_0000 + BYTES * first as u32,
            sector_bytes: BYTES,
            first_sector: first,
            sectors: count,
        }
    }

    /// A sector of 16 KiB.
    const fn small(start: u32, first_sector: u8) -> Slot {
        Slot {
            start,
            sector_bytes: 16 * 1024,
            first_sector,
            sectors: 1,
        }
    }

    /// Two sectors of 128 KiB.
    const fn pair(start: u32, first_sector: u8) -> Slot {
        Slot {
            start,
            sector_bytes: 128 * 1024,
            first_sector,
            sectors: 2,
        }
    }
}
