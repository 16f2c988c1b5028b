//! Flash controllers: what the chips share. Erasures, units that are programmed, a loss of power in the middle of one, and content that is lost
//! then.
//!
//! `f405` and `g474` have the registers.

mod f405;
mod g474;

use super::Kind;
use crate::time::Time;
use std::collections::BTreeSet;

/// First address of the flash.
const FLASH: u32 = 0x0800_0000;

/// Bytes that share check bits; as many are looked at on a chip without.
const CHECKED: u32 = 8;

/// Content from an address on.
pub(crate) type Content = (u32, Vec<u8>);

/// Consequence of a write to a register.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RegisterEffect {
    /// None outside of the controller.
    None,
    /// These bytes are erased, which takes a time.
    Erase { start: u32, bytes: u32, time: Time },
    /// There is no such register, or the controller is not used as its manual says.
    Unknown,
}

/// Consequence of a store of the processor to the flash.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum StoreEffect {
    /// The controller waits for the rest of the unit.
    Waits,
    /// The unit at `address` becomes these bytes, which takes a time.
    Program {
        address: u32,
        unit: [u8; 8],
        bytes: usize,
        time: Time,
    },
    /// The controller does not let it, and has set its flag; the flag of cells that are not erased is `true`.
    Refused { was_programmed: bool },
}

/// Store of the processor to the flash.
#[derive(Clone, Copy, Debug)]
struct Store {
    address: u32,
    word: u32,
    size: usize,
    /// Content of the double word at the address before.
    before: [u8; 8],
    /// All cells of that are those of an erasure.
    is_erased: bool,
}

/// Registers of a chip's controller.
trait FlashRegisters {
    fn reset(&mut self);
    fn read(&self, offset: u32, now: Time) -> Option<u32>;
    fn write(&mut self, offset: u32, value: u32, now: Time) -> RegisterEffect;
    fn store(&mut self, store: Store, now: Time) -> StoreEffect;
    /// Begins an operation at `place` that lasts for `time`. Returns the time for which a processor stands that executes at `executes_at`.
    fn begin(&mut self, place: u32, time: Time, now: Time, executes_at: u32) -> Time;
    /// Returns true if double words have check bits, which tell that their content is lost.
    fn has_check_bits(&self) -> bool;
    /// Tells that a double word is read whose content is lost.
    fn tell_lost(&mut self, address: u32);
}

/// Consequence of a write to a register for the board.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum FlashEffect {
    /// None outside of the controller.
    None,
    /// The flash has other content, and the processor has stood for this time.
    Changed { content: Vec<Content>, time: Time },
    /// There is no such register.
    Unknown,
}

/// Consequence of a store for the board. The store itself follows, into the memory of the emulator.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Stored {
    /// No content has changed: the rest of the unit is to come, or the cells take none.
    Nothing,
    /// The flash has this content from now on, and the processor has stood for this time.
    Content { content: Content, time: Time },
    /// An error of the program.
    Wrong,
}

pub(crate) struct FlashControl {
    registers: Box<dyn FlashRegisters>,
    /// Erasures and units so far, a wear of the flash.
    pub(crate) erasures: u32,
    pub(crate) units: u32,
    /// Operations until one in whose middle the power goes.
    left: Option<u32>,
    /// The power has gone in an operation.
    pub(crate) loses_power: bool,
    /// Double words whose cells are between two contents, and those of which the flash finds that.
    torn: BTreeSet<u32>,
    lost: BTreeSet<u32>,
    noise: u32,
}

impl FlashControl {
    pub(crate) fn new(kind: Kind) -> Self {
        Self {
            registers: match kind {
                Kind::Stm32f405 => Box::new(f405::F405Flash::new()),
                Kind::Stm32g474 => Box::new(g474::G474Flash::new()),
            },
            erasures: 0,
            units: 0,
            left: None,
            loses_power: false,
            torn: BTreeSet::new(),
            lost: BTreeSet::new(),
            noise: 1,
        }
    }

    /// Registers as after a reset.
    pub(crate) fn reset(&mut self) {
        self.registers.reset();
    }

    /// Lets the power go in the middle of an operation, the next but `left`.
    pub(crate) fn cut_power_in(&mut self, left: u32) {
        self.left = Some(left);
    }

    /// Erasures and units so far.
    pub(crate) fn operations(&self) -> u32 {
        self.erasures + self.units
    }

    /// Makes the double word at `address` lost, for a flash that can tell.
    pub(crate) fn lose(&mut self, address: u32) {
        let address = address / CHECKED * CHECKED;
        if self.registers.has_check_bits() {
            self.torn.insert(address);
            self.lost.insert(address);
        }
    }

    /// Addresses of the double words that are lost.
    pub(crate) fn lost(&self) -> &BTreeSet<u32> {
        &self.lost
    }

    /// The processor reads at `address`. Returns `true` if the flash tells that the content is lost.
    pub(crate) fn is_told_lost(&mut self, address: u32) -> bool {
        let address = address / CHECKED * CHECKED;
        let is_lost = self.lost.contains(&address);
        if is_lost {
            self.registers.tell_lost(address);
        }
        is_lost
    }

    pub(crate) fn read(&self, offset: u32, now: Time) -> Option<u32> {
        self.registers.read(offset, now)
    }

    pub(crate) fn write(
        &mut self,
        offset: u32,
        value: u32,
        now: Time,
        executes_at: u32,
    ) -> FlashEffect {
        let (start, bytes, time) = match self.registers.write(offset, value, now) {
            RegisterEffect::None => return FlashEffect::None,
            RegisterEffect::Unknown => return FlashEffect::Unknown,
            RegisterEffect::Erase { start, bytes, time } => (start, bytes, time),
        };
        self.erasures += 1;
        if self.is_cut() {
            let content = self.torn_sector(start, bytes);
            return FlashEffect::Changed { content, time: 0 };
        }
        for cells in [&mut self.torn, &mut self.lost] {
            cells.retain(|address| !(start..start + bytes).contains(address));
        }
        FlashEffect::Changed {
            content: vec![(start, vec![0xFF; bytes as usize])],
            time: self.registers.begin(start, time, now, executes_at),
        }
    }

    /// Takes a word that the processor writes, over a double word that was `before`.
    pub(crate) fn store(
        &mut self,
        address: u32,
        word: u32,
        size: usize,
        before: [u8; 8],
        now: Time,
        executes_at: u32,
    ) -> Stored {
        let whole = address / CHECKED * CHECKED;
        let is_torn = self.torn.contains(&whole);
        let store = Store {
            address,
            word,
            size,
            before,
            is_erased: !is_torn && before == [0xFF; 8],
        };
        match self.registers.store(store, now) {
            StoreEffect::Waits => Stored::Nothing,
            // Cells that are between two contents take none.
            StoreEffect::Refused {
                was_programmed: true,
            } if is_torn => Stored::Nothing,
            StoreEffect::Refused { .. } => Stored::Wrong,
            StoreEffect::Program {
                address,
                unit,
                bytes,
                time,
            } => {
                self.units += 1;
                let unit = &unit[..bytes];
                if self.is_cut() {
                    return Stored::Content {
                        content: (address, self.torn_unit(address, unit)),
                        time: 0,
                    };
                }
                self.torn.remove(&whole);
                self.lost.remove(&whole);
                let is_as_stored = unit.ends_with(&word.to_le_bytes());
                match is_as_stored {
                    true => Stored::Content {
                        content: (address, unit.to_vec()),
                        time: self.registers.begin(address, time, now, executes_at),
                    },
                    // Another word than the program wants there.
                    false => Stored::Wrong,
                }
            }
        }
    }

    /// Counts an operation. Returns `true` if the power goes in its middle.
    fn is_cut(&mut self) -> bool {
        match &mut self.left {
            Some(0) => {
                self.left = None;
                self.loses_power = true;
                true
            }
            Some(left) => {
                *left -= 1;
                false
            }
            None => false,
        }
    }

    fn random(&mut self) -> u32 {
        self.noise = self
            .noise
            .wrapping_mul(1_664_525)
            .wrapping_add(1_013_904_223);
        self.noise ^ self.noise >> 16
    }

    /// Content of a unit of which some bits have fallen: every second of those that should.
    fn torn_unit(&mut self, address: u32, unit: &[u8]) -> Vec<u8> {
        self.lose(address);
        let mut torn = unit.to_vec();
        for byte in &mut torn {
            *byte |= self.random() as u8;
        }
        torn
    }

    /// Content of a sector that is erased by half: parts that are erased, as before, lost, or seem to be erased. Of a page they are double
    /// words.
    fn torn_sector(&mut self, start: u32, bytes: u32) -> Vec<Content> {
        let part = CHECKED.max(bytes / 256);
        let mut content = Vec::new();
        for address in (start..start + bytes).step_by(part as usize) {
            let erased = (address, vec![0xFF; part as usize]);
            match self.random() % 4 {
                0 => {
                    self.torn.remove(&address);
                    self.lost.remove(&address);
                    content.push(erased);
                }
                1 => {}
                2 => {
                    let cleared = vec![0; part as usize];
                    content.push((address, self.torn_unit(address, &cleared)));
                }
                _ => {
                    self.lose(address);
                    self.lost.remove(&address);
                    content.push(erased);
                }
            }
        }
        content
    }
}
