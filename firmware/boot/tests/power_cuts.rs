//! Power cuts at every erasure and every word of an update: the board always starts the old program or the new one, whole.

use trirrr_boot::{
    Flash, FlashError, Layout, ReceiveError, Receiver, Slot, Stage, Started, WholeImage, boot,
    checksum_behind, confirm, request, stage,
};

/// Small slots, so that there are few places for a cut.
const LAYOUT: Layout = Layout {
    journal: Slot {
        start: 0x1000,
        sector_bytes: 256,
        first_sector: 1,
        sectors: 1,
    },
    program: slot(0x2000, 5),
    new: slot(0x3000, 7),
    old: slot(0x4000, 9),
};

const fn slot(start: u32, first_sector: u8) -> Slot {
    Slot {
        start,
        sector_bytes: 64,
        first_sector,
        sectors: 2,
    }
}

const SLOTS: [Slot; 4] = [LAYOUT.journal, LAYOUT.program, LAYOUT.new, LAYOUT.old];

/// A flash that loses its power in its next operation but `left`.
#[derive(Clone)]
struct CutFlash {
    words: std::collections::BTreeMap<u32, u32>,
    left: Option<u32>,
    is_dead: bool,
    noise: u32,
    operations: u32,
}

impl CutFlash {
    /// With a program, and the rest erased.
    fn with(program: &[u8]) -> Self {
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

    fn put(&mut self, slot: &Slot, bytes: &[u8]) {
        for (address, part) in (slot.start..).step_by(4).zip(bytes.chunks(4)) {
            let mut word = [0xFF; 4];
            word[..part.len()].copy_from_slice(part);
            self.words.insert(address, u32::from_le_bytes(word));
        }
    }

    fn bytes(&self, slot: &Slot, length: usize) -> Vec<u8> {
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

    fn random(&mut self) -> u32 {
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

    fn power_on(&mut self, left: Option<u32>) {
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

fn image(bytes: &[u8]) -> WholeImage {
    WholeImage {
        length: bytes.len() as u32,
        checksum: checksum_behind(0, bytes),
    }
}

/// Programs that differ in every word; the new one ends within a word.
fn programs() -> (Vec<u8>, Vec<u8>) {
    ((1..=96).collect(), (100..=218).collect())
}

/// Receives `new` in blocks.
fn receive(flash: &mut CutFlash, new: &[u8]) -> Result<(), ReceiveError> {
    let mut receiver = Receiver::NONE;
    receiver.begin(&LAYOUT, image(new))?;
    for block in new.chunks(16) {
        receiver.block(flash, &LAYOUT, receiver.received(), block)?;
    }
    receiver.finish(flash, &LAYOUT)
}

/// Starts until a start is not cut.
fn start(flash: &mut CutFlash) -> Started {
    flash.power_on(None);
    boot(flash, &LAYOUT).expect("a flash with power")
}

/// Returns true for the new program, false for the old one; neither is a failure of the test.
fn runs_new(flash: &CutFlash, old: &[u8], new: &[u8], what: &str) -> bool {
    let is = |program: &[u8]| {
        let slot = LAYOUT.program;
        (slot.start..slot.start + slot.bytes())
            .step_by(4)
            .enumerate()
            .all(|(index, at)| {
                let mut word = [0xFF; 4];
                let part = program.get(4 * index..).unwrap_or_default();
                let part = &part[..part.len().min(4)];
                word[..part.len()].copy_from_slice(part);
                flash.words[&at] == u32::from_le_bytes(word)
            })
    };
    assert!(is(old) || is(new), "{what}: neither program is whole");
    is(new)
}

#[test]
fn a_new_image_is_tried_once_and_stays_if_it_is_confirmed() {
    let (old, new) = programs();
    let mut flash = CutFlash::with(&old);
    assert_eq!(start(&mut flash), Started::Known);
    receive(&mut flash, &new).expect("a whole image");
    assert_eq!(start(&mut flash), Started::OnTrial);
    assert_eq!(flash.bytes(&LAYOUT.program, new.len()), new);
    confirm(&mut flash, &LAYOUT).expect("room in the journal");
    for _ in 0..3 {
        assert_eq!(start(&mut flash), Started::Known);
        assert_eq!(flash.bytes(&LAYOUT.program, new.len()), new);
    }
    assert_eq!(stage(&flash, &LAYOUT), Stage::Confirmed);
}

#[test]
fn a_new_image_that_is_not_confirmed_goes() {
    let (old, new) = programs();
    let mut flash = CutFlash::with(&old);
    receive(&mut flash, &new).expect("a whole image");
    assert_eq!(start(&mut flash), Started::OnTrial);
    assert_eq!(start(&mut flash), Started::Known);
    assert_eq!(flash.bytes(&LAYOUT.program, old.len()), old);
    assert_eq!(stage(&flash, &LAYOUT), Stage::Reverted);
    // The next update is none the worse.
    receive(&mut flash, &new).expect("a whole image");
    assert_eq!(start(&mut flash), Started::OnTrial);
}

#[test]
fn a_cut_anywhere_in_an_installation_leaves_one_program_whole() {
    let (old, new) = programs();
    let mut requested = CutFlash::with(&old);
    receive(&mut requested, &new).expect("a whole image");
    let mut whole = requested.clone();
    start(&mut whole);
    let operations = whole.operations;
    assert!(operations > 60, "{operations}");
    let mut tried = 0;
    for seed in 0..8 {
        for cut in 0..operations {
            let mut flash = requested.clone();
            flash.noise = seed;
            flash.power_on(Some(cut));
            let cut_off = boot(&mut flash, &LAYOUT);
            assert!(cut_off.is_err(), "cut {cut}: {cut_off:?}");
            let what = format!("seed {seed}, cut {cut}");
            let started = start(&mut flash);
            assert_eq!(
                runs_new(&flash, &old, &new, &what),
                started == Started::OnTrial,
                "{what}"
            );
            tried += u32::from(started == Started::OnTrial);
            // Nobody has confirmed it.
            assert_eq!(start(&mut flash), Started::Known, "{what}");
            assert!(!runs_new(&flash, &old, &new, &what), "{what}");
        }
    }
    // A cut in the record of the trial alone gives it up.
    assert!(
        tried >= 8 * (operations - 4),
        "{tried} of {}",
        8 * operations
    );
}

#[test]
fn a_cut_anywhere_on_the_way_back_leaves_one_program_whole() {
    let (old, new) = programs();
    let mut on_trial = CutFlash::with(&old);
    receive(&mut on_trial, &new).expect("a whole image");
    start(&mut on_trial);
    let mut whole = on_trial.clone();
    start(&mut whole);
    for seed in 0..8 {
        for cut in 0..whole.operations {
            let mut flash = on_trial.clone();
            flash.noise = seed;
            flash.power_on(Some(cut));
            assert!(boot(&mut flash, &LAYOUT).is_err());
            assert_eq!(start(&mut flash), Started::Known);
            let what = format!("seed {seed}, cut {cut}");
            assert!(!runs_new(&flash, &old, &new, &what), "{what}");
        }
    }
}

#[test]
fn a_cut_anywhere_in_a_transfer_leaves_the_old_program() {
    let (old, new) = programs();
    let mut whole = CutFlash::with(&old);
    receive(&mut whole, &new).expect("a whole image");
    // All but the last word, with which the request is whole.
    for cut in 0..whole.operations - 1 {
        let mut flash = CutFlash::with(&old);
        flash.power_on(Some(cut));
        assert!(receive(&mut flash, &new).is_err(), "cut {cut}");
        assert_eq!(start(&mut flash), Started::Known, "cut {cut}");
        assert_eq!(flash.bytes(&LAYOUT.program, old.len()), old, "cut {cut}");
    }
}

#[test]
fn a_cut_in_a_confirmation_leaves_one_program_whole() {
    let (old, new) = programs();
    let mut on_trial = CutFlash::with(&old);
    receive(&mut on_trial, &new).expect("a whole image");
    start(&mut on_trial);
    for cut in 0..4 {
        let mut flash = on_trial.clone();
        flash.power_on(Some(cut));
        assert!(confirm(&mut flash, &LAYOUT).is_err());
        assert_eq!(start(&mut flash), Started::Known);
        let what = format!("cut {cut}");
        let is_confirmed = stage(&flash, &LAYOUT) == Stage::Confirmed;
        assert_eq!(runs_new(&flash, &old, &new, &what), is_confirmed, "{what}");
    }
}

#[test]
fn a_journal_makes_room_and_a_cut_there_changes_nothing() {
    let (old, new) = programs();
    let mut flash = CutFlash::with(&old);
    let mut cut_flash = None;
    for update in 0..12 {
        receive(&mut flash, if update % 2 == 0 { &new } else { &old })
            .expect("room in the journal");
        assert_eq!(start(&mut flash), Started::OnTrial, "update {update}");
        confirm(&mut flash, &LAYOUT).expect("room in the journal");
        let before = flash.clone();
        start(&mut flash);
        if flash.operations > 0 {
            cut_flash = Some((before, flash.operations, update % 2 == 0));
        }
    }
    let (before, operations, is_new) =
        cut_flash.expect("a journal of 16 records is full after 4 updates");
    for seed in 0..8 {
        for cut in 0..operations {
            let mut flash = before.clone();
            flash.noise = seed;
            flash.power_on(Some(cut));
            assert!(boot(&mut flash, &LAYOUT).is_err());
            assert_eq!(start(&mut flash), Started::Known);
            let what = format!("seed {seed}, cut {cut}");
            assert_eq!(runs_new(&flash, &old, &new, &what), is_new, "{what}");
        }
    }
}

#[test]
fn cuts_one_after_another_leave_one_program_whole() {
    let (old, new) = programs();
    for seed in 0..200 {
        let mut flash = CutFlash::with(&old);
        flash.noise = seed;
        receive(&mut flash, &new).expect("a whole image");
        for _ in 0..6 {
            let cut = flash.random() % 80;
            flash.power_on(Some(cut));
            if boot(&mut flash, &LAYOUT).is_ok() {
                runs_new(&flash, &old, &new, &format!("seed {seed}"));
            }
        }
        start(&mut flash);
        runs_new(&flash, &old, &new, &format!("seed {seed}"));
    }
}

#[test]
fn an_image_that_is_damaged_in_its_slot_is_not_installed() {
    let (old, new) = programs();
    let mut flash = CutFlash::with(&old);
    receive(&mut flash, &new).expect("a whole image");
    *flash
        .words
        .get_mut(&(LAYOUT.new.start + 8))
        .expect("a word") ^= 1;
    assert_eq!(start(&mut flash), Started::Known);
    assert_eq!(flash.bytes(&LAYOUT.program, old.len()), old);
    assert_eq!(stage(&flash, &LAYOUT), Stage::Reverted);
}

#[test]
fn blocks_come_in_their_order_and_the_checksum_is_that_of_the_flash() {
    let (old, new) = programs();
    let mut flash = CutFlash::with(&old);
    let mut receiver = Receiver::NONE;
    let first = receiver.block(&mut flash, &LAYOUT, 0, &new[..16]);
    assert_eq!(first, Err(ReceiveError::NotBegun));
    let long = WholeImage {
        length: LAYOUT.new.bytes() + 1,
        checksum: 0,
    };
    assert_eq!(receiver.begin(&LAYOUT, long), Err(ReceiveError::Length));
    let none = WholeImage {
        length: 0,
        checksum: 0,
    };
    assert_eq!(receiver.begin(&LAYOUT, none), Err(ReceiveError::Length));
    receiver
        .begin(&LAYOUT, image(&new))
        .expect("an image of this length");
    for (offset, length) in [(16, 16), (0, 15), (0, 0), (0, new.len() + 1)] {
        let bytes = vec![1; length];
        let refused = receiver.block(&mut flash, &LAYOUT, offset, &bytes);
        assert_eq!(
            refused,
            Err(ReceiveError::Offset { expected: 0 }),
            "{offset}, {length}"
        );
    }
    assert_eq!(flash.operations, 0);
    receiver
        .block(&mut flash, &LAYOUT, 0, &new[..16])
        .expect("the first block");
    let early = receiver.finish(&mut flash, &LAYOUT);
    assert_eq!(early, Err(ReceiveError::Offset { expected: 16 }));
    let mut wrong = new.clone();
    wrong[17] ^= 0x20;
    for block in wrong[16..].chunks(16) {
        receiver
            .block(&mut flash, &LAYOUT, receiver.received(), block)
            .expect("a block");
    }
    let found = checksum_behind(0, &wrong);
    assert_eq!(
        receiver.finish(&mut flash, &LAYOUT),
        Err(ReceiveError::Checksum { found })
    );
    assert_eq!(start(&mut flash), Started::Known);
    assert_eq!(stage(&flash, &LAYOUT), Stage::None);
}

#[test]
fn a_journal_of_something_else_is_cleared() {
    let (old, new) = programs();
    let mut flash = CutFlash::with(&old);
    // An image that was flashed from the beginning of the flash on.
    let noise: Vec<u8> = (0..256).map(|index| (index * 37 % 251) as u8).collect();
    flash.put(&LAYOUT.journal, &noise);
    assert!(request(&mut flash, &LAYOUT, image(&new)).is_err());
    assert_eq!(start(&mut flash), Started::Known);
    receive(&mut flash, &new).expect("room in the journal");
    assert_eq!(start(&mut flash), Started::OnTrial);
}

/// All example checksums of the line's algorithm are those of CRC-32.
#[test]
fn the_checksum_is_that_of_the_line() {
    assert_eq!(checksum_behind(0, b"123456789"), 0xCBF4_3926);
    assert_eq!(
        checksum_behind(checksum_behind(0, b"1234"), b"56789"),
        0xCBF4_3926
    );
}
