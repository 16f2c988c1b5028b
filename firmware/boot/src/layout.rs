//! Parts of the flash.

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

    /// Addresses of its first `bytes`, word by word.
    pub(crate) fn words(&self, bytes: u32) -> impl Iterator<Item = u32> + use<> {
        (self.start..self.start + bytes.min(self.bytes())).step_by(4)
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
    /// Scenes that have come over the line.
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
