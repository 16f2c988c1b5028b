//! Power cuts at every erasure and every word of an update: the board always starts the old program or the new one, whole. Likewise of a
//! scene that comes over the line.

mod cut_flash;
mod scenes;

use cut_flash::{CutFlash, LAYOUT};
use trirrr_boot::{
    ReceiveError, Receiver, Stage, Started, WholeImage, boot, checksum_behind, confirm, request,
    stage,
};

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
    receiver.begin(LAYOUT.new.bytes(), image(new))?;
    for block in new.chunks(16) {
        receiver.block(flash, &LAYOUT.new, receiver.received(), block)?;
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
    let first = receiver.block(&mut flash, &LAYOUT.new, 0, &new[..16]);
    assert_eq!(first, Err(ReceiveError::NotBegun));
    let long = WholeImage {
        length: LAYOUT.new.bytes() + 1,
        checksum: 0,
    };
    assert_eq!(
        receiver.begin(LAYOUT.new.bytes(), long),
        Err(ReceiveError::Length)
    );
    let none = WholeImage {
        length: 0,
        checksum: 0,
    };
    assert_eq!(
        receiver.begin(LAYOUT.new.bytes(), none),
        Err(ReceiveError::Length)
    );
    receiver
        .begin(LAYOUT.new.bytes(), image(&new))
        .expect("an image of this length");
    for (offset, length) in [(16, 16), (0, 15), (0, 0), (0, new.len() + 1)] {
        let bytes = vec![1; length];
        let refused = receiver.block(&mut flash, &LAYOUT.new, offset, &bytes);
        assert_eq!(
            refused,
            Err(ReceiveError::Offset { expected: 0 }),
            "{offset}, {length}"
        );
    }
    assert_eq!(flash.operations, 0);
    receiver
        .block(&mut flash, &LAYOUT.new, 0, &new[..16])
        .expect("the first block");
    let early = receiver.finish(&mut flash, &LAYOUT);
    assert_eq!(early, Err(ReceiveError::Offset { expected: 16 }));
    let mut wrong = new.clone();
    wrong[17] ^= 0x20;
    for block in wrong[16..].chunks(16) {
        receiver
            .block(&mut flash, &LAYOUT.new, receiver.received(), block)
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
