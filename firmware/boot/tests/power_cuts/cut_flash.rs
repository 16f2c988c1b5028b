//! Flash that loses its power, and its layout.

use trirrr_boot::{Flash, FlashError, Layout, Slot};

/// Small slots, so that there are few places for a cut.
pub(crate) const LAYOUT: Layout = Layout {
    journal: Slot {
        start: 0x1000,
        sector_bytes: 256,
        first_sector: 1,
        sectors: 1,
    },
    program: slot(0x2000, 5),
    new: slot(0x3000, 7),
    old: slot(0x4000, 9),
    scenes: [scene_slot(0x5000, 2), scene_slot(0x6000, 3)],
};

const fn slot(start: u32, first_sector: u8) -> Slot {
    Slot {
        start,
        sector_bytes: 64,
        first_sector,
        sectors: 2,
    }
}

const fn scene_slot(start: u32, first_sector: u8) -> Slot {
    Slot {
        sectors: 1,
        ..slot(start, first_sector)
    }
}

const SLOTS: [Slot; 6] = [
    LAYOUT.journal,
    LAYOUT.program,
    LAYOUT.new,
    LAYOUT.old,
    LAYOUT.scenes[0],
    LAYOUT.scenes[1],
];

/// A flash that loses its power in its next operation but `left`.
#[derive(Clone)]
pub(crate) struct CutFlash {
    pub(crate) words: std::collections::BTreeMap<u32, u32>,
    left: Option<u32>,
    is_dead: bool,
    pub(crate) noise: u32,
    pub(crate) operations: u32,
}

impl CutFlash {
    /// With a program, and the rest erased.
    pub(crate) fn with(program: &[u8]) -> Self {
        let mut flash = Self {
            words: SLOTS
                .iter()
                .flat_map(|slot| (slot.start..slot.start + slot.bytes()).step_by(4))
                .map(|address| (address, u32::MAX))
                .collect(),
            left: None,
            is_dead: false,
            noise: 1,
            operations: 0,
        };
        flash.put(&LAYOUT.program, program);
        flash
    }

    pub(crate) fn put(&mut self, slot: &Slot, bytes: &[u8]) {
        for (address, part) in (slot.start..).step_by(4).zip(bytes.chunks(4)) {
            let mut word = [0xFF; 4];
            word[..part.len()].copy_from_slice(part);
            self.words.insert(address, u32::from_le_bytes(word));
        }
    }

    pub(crate) fn bytes(&self, slot: &Slot, length: usize) -> Vec<u8> {
        let addresses = (slot.start..slot.start + slot.bytes()).step_by(4);
        let mut bytes: Vec<u8> = addresses
            .flat_map(|at| self.words[&at].to_le_bytes())
            .collect();
        assert!(
            bytes.drain(length..).all(|byte| byte == 0xFF),
            "more than the image"
        );
        bytes
    }

    pub(crate) fn random(&mut self) -> u32 {
        self.noise = self
            .noise
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        self.noise ^ self.noise >> 16
    }

    /// Counts an operation; true if it is whole, false if the power goes in it, an error if there is none.
    fn goes_on(&mut self, place: u32) -> Result<bool, FlashError> {
        if self.is_dead {
            return Err(FlashError { place, status: 0 });
        }
        self.operations += 1;
        match &mut self.left {
            Some(0) => {
                self.is_dead = true;
                Ok(false)
            }
            Some(left) => {
                *left -= 1;
                Ok(true)
            }
            None => Ok(true),
        }
    }

    pub(crate) fn power_on(&mut self, left: Option<u32>) {
        (self.left, self.is_dead, self.operations) = (left, false, 0);
    }
}

impl Flash for CutFlash {
    fn word(&self, address: u32) -> u32 {
        self.words[&address]
    }

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        let slot = SLOTS
            .iter()
            .find(|slot| (slot.first_sector..slot.first_sector + slot.sectors).contains(&sector));
        let slot = slot.unwrap_or_else(|| panic!("sector {sector} is in no slot"));
        let start = slot.start + slot.sector_bytes * u32::from(sector - slot.first_sector);
        let is_whole = self.goes_on(sector.into())?;
        for address in (start..start + slot.sector_bytes).step_by(4) {
            // Bits rise one by one, those of each word on their own.
            let (kind, noise) = (self.random() % 3, self.random());
            let word = self.words.get_mut(&address).expect("a word of the flash");
            *word = match (is_whole, kind) {
                (true, _) | (false, 0) => u32::MAX,
                (false, 1) => *word,
                (false, _) => *word | noise,
            };
        }
        match is_whole {
            true => Ok(()),
            false => Err(FlashError {
                place: sector.into(),
                status: 0,
            }),
        }
    }

    fn program(&mut self, address: u32, word: u32) -> Result<(), FlashError> {
        let is_whole = self.goes_on(address)?;
        let noise = self.random();
        let kept = self.words.get_mut(&address).expect("a word of the flash");
        // Bits only fall. Of a word that is cut some do.
        *kept &= if is_whole { word } else { word | noise };
        match *kept == word {
            true => Ok(()),
            false => Err(FlashError {
                place: address,
                status: *kept,
            }),
        }
    }
}
