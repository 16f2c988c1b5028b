//! Flash that loses its power, with the units of a chip and small slots.

use std::collections::BTreeMap;
use std::fmt::Debug;
use trirrr_boot::{Flash, FlashError, FlashUnit, Layout, Slot};

/// Flash of a chip, with small slots, so that there are few places for a cut.
pub(crate) trait ChipCells: Clone + Debug {
    type Unit: FlashUnit;
    const LAYOUT: Layout;
    /// Units have check bits, which are lost in a cut as often as not, and take content once.
    const IS_CHECKED: bool;
    /// Units of a record of the journal.
    const RECORD: u32 = 16 / Self::Unit::BYTES;
}

/// Words, and slots of two large sectors.
#[derive(Clone, Debug)]
pub(crate) struct F405;

impl ChipCells for F405 {
    type Unit = u32;
    const LAYOUT: Layout = Layout {
        journal: slot(0x1000, 1, 256, 1),
        program: slot(0x2000, 5, 64, 2),
        new: slot(0x3000, 7, 64, 2),
        old: slot(0x4000, 9, 64, 2),
        scenes: [slot(0x5000, 2, 64, 1), slot(0x6000, 3, 64, 1)],
    };
    const IS_CHECKED: bool = false;
}

/// Double words with check bits, and slots of many small pages.
#[derive(Clone, Debug)]
pub(crate) struct G474;

impl ChipCells for G474 {
    type Unit = u64;
    const LAYOUT: Layout = Layout {
        program: slot(0x1000, 8, 32, 4),
        old: slot(0x2000, 12, 32, 4),
        new: slot(0x3000, 16, 32, 4),
        journal: slot(0x4000, 20, 128, 2),
        scenes: [slot(0x5000, 22, 64, 1), slot(0x6000, 23, 64, 1)],
    };
    const IS_CHECKED: bool = true;
}

const fn slot(start: u32, first_sector: u8, sector_bytes: u32, sectors: u8) -> Slot {
    Slot {
        start,
        sector_bytes,
        first_sector,
        sectors,
    }
}

fn slots(layout: &Layout) -> [Slot; 6] {
    let Layout {
        journal,
        program,
        new,
        old,
        scenes: [a, b],
    } = *layout;
    [journal, program, new, old, a, b]
}

/// Content of a unit.
#[derive(Clone, Copy, Debug)]
struct CellState<U> {
    unit: U,
    /// The check bits do not go with the content.
    is_lost: bool,
    /// All of its bits are those of an erasure, the check bits too.
    is_erased: bool,
}

impl<U: FlashUnit> CellState<U> {
    const ERASED: Self = Self {
        unit: U::ERASED,
        is_lost: false,
        is_erased: true,
    };
}

/// A flash that loses its power in its next operation but `left`.
#[derive(Clone)]
pub(crate) struct CutFlash<C: ChipCells> {
    cells: BTreeMap<u32, CellState<C::Unit>>,
    left: Option<u32>,
    is_dead: bool,
    pub(crate) noise: u32,
    pub(crate) operations: u32,
}

impl<C: ChipCells> CutFlash<C> {
    /// With a program, and the rest erased.
    pub(crate) fn with(program: &[u8]) -> Self {
        let step = C::Unit::BYTES as usize;
        let mut flash = Self {
            cells: slots(&C::LAYOUT)
                .iter()
                .flat_map(|slot| (slot.start..slot.start + slot.bytes()).step_by(step))
                .map(|address| (address, CellState::ERASED))
                .collect(),
            left: None,
            is_dead: false,
            noise: 1,
            operations: 0,
        };
        flash.put(&C::LAYOUT.program, program);
        flash
    }

    pub(crate) fn put(&mut self, slot: &Slot, bytes: &[u8]) {
        let step = C::Unit::BYTES as usize;
        for (address, part) in (slot.start..).step_by(step).zip(bytes.chunks(step)) {
            let cell = CellState {
                unit: C::Unit::of_bytes(part),
                is_lost: false,
                is_erased: false,
            };
            self.cells.insert(address, cell);
        }
    }

    /// Inverts bits of the byte at `address`.
    pub(crate) fn damage(&mut self, address: u32, bits: u8) {
        let at = address % C::Unit::BYTES;
        let cell = self.cell(address - at);
        let mut bytes = cell.unit.bytes().as_ref().to_vec();
        bytes[at as usize] ^= bits;
        cell.unit = C::Unit::of_bytes(&bytes);
    }

    /// Makes the check bits of the unit at `address` wrong.
    pub(crate) fn lose(&mut self, address: u32) {
        self.cell(address).is_lost = true;
    }

    fn cell(&mut self, address: u32) -> &mut CellState<C::Unit> {
        self.cells.get_mut(&address).expect("a unit of the flash")
    }

    /// Content of a slot, and true for each byte that is lost.
    pub(crate) fn content(&self, slot: &Slot) -> Vec<(u8, bool)> {
        let cells = self.cells.range(slot.start..slot.start + slot.bytes());
        let bytes = |cell: &CellState<C::Unit>| cell.unit.bytes().as_ref().to_vec();
        let mut content = Vec::new();
        for (_, cell) in cells {
            content.extend(bytes(cell).into_iter().map(|byte| (byte, cell.is_lost)));
        }
        content
    }

    pub(crate) fn bytes(&self, slot: &Slot, length: usize) -> Vec<u8> {
        let content = self.content(slot);
        assert!(
            content[length..].iter().all(|cell| *cell == (0xFF, false)),
            "more than the image"
        );
        let image = content[..length].iter();
        image.map(|(byte, _)| *byte).collect()
    }

    pub(crate) fn random(&mut self) -> u32 {
        self.noise = self
            .noise
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        self.noise ^ self.noise >> 16
    }

    /// The unit with some of its bits risen.
    fn risen(&mut self, unit: C::Unit) -> C::Unit {
        let mut bytes = unit.bytes().as_ref().to_vec();
        for byte in &mut bytes {
            *byte |= self.random() as u8;
        }
        C::Unit::of_bytes(&bytes)
    }

    /// The bits that both have.
    fn fallen(before: C::Unit, to: C::Unit) -> C::Unit {
        let (before, to) = (before.bytes(), to.bytes());
        let both = before.as_ref().iter().zip(to.as_ref());
        C::Unit::of_bytes(&both.map(|(a, b)| a & b).collect::<Vec<u8>>())
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

impl<C: ChipCells> Flash for CutFlash<C> {
    type Unit = C::Unit;

    fn unit(&self, address: u32) -> Option<C::Unit> {
        let cell = &self.cells[&address];
        (!cell.is_lost).then_some(cell.unit)
    }

    fn erase(&mut self, sector: u8) -> Result<(), FlashError> {
        let slots = slots(&C::LAYOUT);
        let slot = slots
            .iter()
            .find(|slot| (slot.first_sector..slot.first_sector + slot.sectors).contains(&sector));
        let slot = slot.unwrap_or_else(|| panic!("sector {sector} is in no slot"));
        let start = slot.start + slot.sector_bytes * u32::from(sector - slot.first_sector);
        let is_whole = self.goes_on(sector.into())?;
        for address in (start..start + slot.sector_bytes).step_by(C::Unit::BYTES as usize) {
            // Bits rise one by one, those of each unit on their own.
            let kinds = if C::IS_CHECKED { 4 } else { 3 };
            let (kind, before) = (self.random() % kinds, self.cells[&address].unit);
            let (risen, is_lost) = (self.risen(before), self.random().is_multiple_of(2));
            let cell = self.cell(address);
            match (is_whole, kind) {
                (true, _) | (false, 0) => *cell = CellState::ERASED,
                (false, 1) => {}
                (false, 2) => {
                    *cell = CellState {
                        unit: risen,
                        is_lost: C::IS_CHECKED && is_lost,
                        is_erased: false,
                    }
                }
                // Looks erased, and takes no content.
                (false, _) => {
                    *cell = CellState {
                        is_erased: false,
                        ..CellState::ERASED
                    }
                }
            }
        }
        match is_whole {
            true => Ok(()),
            false => Err(FlashError {
                place: sector.into(),
                status: 0,
            }),
        }
    }

    fn program(&mut self, address: u32, unit: C::Unit) -> Result<(), FlashError> {
        let is_whole = self.goes_on(address)?;
        let failed = FlashError {
            place: address,
            status: u32::from(C::IS_CHECKED) << 3,
        };
        let before = self.cells[&address];
        if C::IS_CHECKED && !before.is_erased && unit != C::Unit::CLEARED {
            return Err(failed);
        }
        // Bits only fall. Of a unit that is cut some do.
        let (some, kind) = (self.risen(unit), self.random() % 4);
        let (to, is_lost) = match (is_whole, kind) {
            (true, _) => (unit, false),
            // All bits have fallen before the power did, those of the check or not.
            (false, 0) if C::IS_CHECKED => (unit, self.random().is_multiple_of(2)),
            (false, _) => (some, C::IS_CHECKED && kind != 1),
        };
        *self.cell(address) = CellState {
            unit: Self::fallen(before.unit, to),
            is_lost,
            is_erased: false,
        };
        match is_whole && self.cells[&address].unit == unit {
            true => Ok(()),
            false => Err(failed),
        }
    }
}
