//! Power cuts at every erasure and every unit of an update: the board always starts the old program or the new one, whole. Likewise of a
//! scene that comes over the line. With words as the STM32F405 programs them, and with double words of the STM32G474, whose content is lost
//! where a cut comes between them and their check bits.

/// Makes tests of functions that take a chip.
macro_rules! on_both_chips {
    ($($name:ident)*) => {
        mod on_stm32f405 {
            $(#[test] fn $name() { super::$name::<crate::cut_flash::F405>(); })*
        }

        mod on_stm32g474 {
            $(#[test] fn $name() { super::$name::<crate::cut_flash::G474>(); })*
        }
    };
}

mod cut_flash;
mod damage;
mod layouts;
mod scenes;

use cut_flash::{ChipCells, CutFlash, G474};
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

/// Programs that differ in every word and have the same number of sectors, for those behind an image keep what they have. Both end within a
/// double word.
fn programs() -> (Vec<u8>, Vec<u8>) {
    ((1..=100).collect(), (100..=218).collect())
}

/// Receives `new` in blocks.
fn receive<C: ChipCells>(flash: &mut CutFlash<C>, new: &[u8]) -> Result<(), ReceiveError> {
    let mut receiver = Receiver::NONE;
    receiver.begin(C::LAYOUT.new.bytes(), image(new))?;
    for block in new.chunks(16) {
        receiver.block(flash, &C::LAYOUT.new, receiver.received(), block)?;
    }
    receiver.finish(flash, &C::LAYOUT)
}

/// Starts until a start is not cut.
fn start<C: ChipCells>(flash: &mut CutFlash<C>) -> Started {
    flash.power_on(None);
    boot(flash, &C::LAYOUT).expect("a flash with power")
}

fn is_reverted<C: ChipCells>(flash: &CutFlash<C>) -> bool {
    matches!(stage(flash, &C::LAYOUT), Stage::Reverted(_))
}

/// Returns true for the new program, false for the old one; neither is a failure of the test.
fn runs_new<C: ChipCells>(flash: &CutFlash<C>, old: &[u8], new: &[u8], what: &str) -> bool {
    let content = flash.content(&C::LAYOUT.program);
    let is = |program: &[u8]| {
        let expected = program.iter().copied().chain(std::iter::repeat(0xFF));
        let mut pairs = content.iter().zip(expected);
        pairs.all(|((byte, is_lost), expected)| *byte == expected && !is_lost)
    };
    assert!(is(old) || is(new), "{what}: neither program is whole");
    is(new)
}

fn a_new_image_is_tried_once_and_stays_if_it_is_confirmed<C: ChipCells>() {
    let (old, new) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    assert_eq!(start(&mut flash), Started::Known);
    receive(&mut flash, &new).expect("a whole image");
    assert_eq!(start(&mut flash), Started::OnTrial);
    assert_eq!(flash.bytes(&C::LAYOUT.program, new.len()), new);
    confirm(&mut flash, &C::LAYOUT).expect("room in the journal");
    for _ in 0..3 {
        assert_eq!(start(&mut flash), Started::Known);
        assert_eq!(flash.bytes(&C::LAYOUT.program, new.len()), new);
    }
    assert_eq!(stage(&flash, &C::LAYOUT), Stage::Confirmed(image(&new)));
}

fn a_new_image_that_is_not_confirmed_goes<C: ChipCells>() {
    let (old, new) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    receive(&mut flash, &new).expect("a whole image");
    assert_eq!(start(&mut flash), Started::OnTrial);
    assert_eq!(start(&mut flash), Started::Known);
    assert_eq!(flash.bytes(&C::LAYOUT.program, old.len()), old);
    assert!(is_reverted(&flash));
    // The next update is none the worse.
    receive(&mut flash, &new).expect("a whole image");
    assert_eq!(start(&mut flash), Started::OnTrial);
}

fn a_cut_anywhere_in_an_installation_leaves_one_program_whole<C: ChipCells>() {
    let (old, new) = programs();
    let mut requested = CutFlash::<C>::with(&old);
    receive(&mut requested, &new).expect("a whole image");
    let mut whole = requested.clone();
    start(&mut whole);
    let operations = whole.operations;
    // Four slots of erasures and units, and records.
    assert!(operations > 30, "{operations}");
    let mut tried = 0;
    for seed in 0..8 {
        for cut in 0..operations {
            let mut flash = requested.clone();
            flash.noise = seed;
            flash.power_on(Some(cut));
            let cut_off = boot(&mut flash, &C::LAYOUT);
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
        tried >= 8 * (operations - C::RECORD),
        "{tried} of {}",
        8 * operations
    );
}

fn a_cut_anywhere_on_the_way_back_leaves_one_program_whole<C: ChipCells>() {
    let (old, new) = programs();
    let mut on_trial = CutFlash::<C>::with(&old);
    receive(&mut on_trial, &new).expect("a whole image");
    start(&mut on_trial);
    let mut whole = on_trial.clone();
    start(&mut whole);
    for seed in 0..8 {
        for cut in 0..whole.operations {
            let mut flash = on_trial.clone();
            flash.noise = seed;
            flash.power_on(Some(cut));
            assert!(boot(&mut flash, &C::LAYOUT).is_err());
            assert_eq!(start(&mut flash), Started::Known);
            let what = format!("seed {seed}, cut {cut}");
            assert!(!runs_new(&flash, &old, &new, &what), "{what}");
        }
    }
}

fn a_cut_anywhere_in_a_transfer_leaves_the_old_program<C: ChipCells>() {
    let (old, new) = programs();
    let mut whole = CutFlash::<C>::with(&old);
    receive(&mut whole, &new).expect("a whole image");
    // All but the last unit, with which the request is whole.
    for cut in 0..whole.operations - 1 {
        let mut flash = CutFlash::<C>::with(&old);
        flash.power_on(Some(cut));
        assert!(receive(&mut flash, &new).is_err(), "cut {cut}");
        assert_eq!(start(&mut flash), Started::Known, "cut {cut}");
        assert_eq!(flash.bytes(&C::LAYOUT.program, old.len()), old, "cut {cut}");
    }
}

fn a_cut_in_a_confirmation_leaves_one_program_whole<C: ChipCells>() {
    let (old, new) = programs();
    let mut on_trial = CutFlash::<C>::with(&old);
    receive(&mut on_trial, &new).expect("a whole image");
    start(&mut on_trial);
    for cut in 0..C::RECORD {
        let mut flash = on_trial.clone();
        flash.power_on(Some(cut));
        assert!(confirm(&mut flash, &C::LAYOUT).is_err());
        assert_eq!(start(&mut flash), Started::Known);
        let what = format!("cut {cut}");
        let is_confirmed = stage(&flash, &C::LAYOUT) == Stage::Confirmed(image(&new));
        assert_eq!(runs_new(&flash, &old, &new, &what), is_confirmed, "{what}");
    }
}

fn a_journal_makes_room_and_a_cut_there_changes_nothing<C: ChipCells>() {
    let (old, new) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    let mut cut_flash = None;
    for update in 0..12 {
        receive(&mut flash, if update % 2 == 0 { &new } else { &old })
            .expect("room in the journal");
        assert_eq!(start(&mut flash), Started::OnTrial, "update {update}");
        confirm(&mut flash, &C::LAYOUT).expect("room in the journal");
        let before = flash.clone();
        start(&mut flash);
        if flash.operations > 0 {
            let program = image(if update % 2 == 0 { &new } else { &old });
            assert_eq!(stage(&flash, &C::LAYOUT), Stage::Confirmed(program));
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
            assert!(boot(&mut flash, &C::LAYOUT).is_err());
            assert_eq!(start(&mut flash), Started::Known);
            let what = format!("seed {seed}, cut {cut}");
            assert_eq!(runs_new(&flash, &old, &new, &what), is_new, "{what}");
        }
    }
}

fn cuts_one_after_another_leave_one_program_whole<C: ChipCells>() {
    let (old, new) = programs();
    for seed in 0..200 {
        let mut flash = CutFlash::<C>::with(&old);
        flash.noise = seed;
        receive(&mut flash, &new).expect("a whole image");
        for _ in 0..6 {
            let cut = flash.random() % 80;
            flash.power_on(Some(cut));
            if boot(&mut flash, &C::LAYOUT).is_ok() {
                runs_new(&flash, &old, &new, &format!("seed {seed}"));
            }
        }
        start(&mut flash);
        runs_new(&flash, &old, &new, &format!("seed {seed}"));
    }
}

fn an_image_that_is_damaged_in_its_slot_is_not_installed<C: ChipCells>() {
    let (old, new) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    receive(&mut flash, &new).expect("a whole image");
    flash.damage(C::LAYOUT.new.start + 8, 1);
    assert_eq!(start(&mut flash), Started::Known);
    assert_eq!(flash.bytes(&C::LAYOUT.program, old.len()), old);
    assert!(is_reverted(&flash));
}

fn blocks_come_in_their_order_and_the_checksum_is_that_of_the_flash<C: ChipCells>() {
    let (old, new) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    let mut receiver = Receiver::NONE;
    let first = receiver.block(&mut flash, &C::LAYOUT.new, 0, &new[..16]);
    assert_eq!(first, Err(ReceiveError::NotBegun));
    let long = WholeImage {
        length: C::LAYOUT.new.bytes() + 1,
        checksum: 0,
    };
    assert_eq!(
        receiver.begin(C::LAYOUT.new.bytes(), long),
        Err(ReceiveError::Length)
    );
    let none = WholeImage {
        length: 0,
        checksum: 0,
    };
    assert_eq!(
        receiver.begin(C::LAYOUT.new.bytes(), none),
        Err(ReceiveError::Length)
    );
    receiver
        .begin(C::LAYOUT.new.bytes(), image(&new))
        .expect("an image of this length");
    for (offset, length) in [(16, 16), (0, 15), (0, 0), (0, new.len() + 1)] {
        let bytes = vec![1; length];
        let refused = receiver.block(&mut flash, &C::LAYOUT.new, offset, &bytes);
        assert_eq!(
            refused,
            Err(ReceiveError::Offset { expected: 0 }),
            "{offset}, {length}"
        );
    }
    assert_eq!(flash.operations, 0);
    receiver
        .block(&mut flash, &C::LAYOUT.new, 0, &new[..16])
        .expect("the first block");
    let early = receiver.finish(&mut flash, &C::LAYOUT);
    assert_eq!(early, Err(ReceiveError::Offset { expected: 16 }));
    let mut wrong = new.clone();
    wrong[17] ^= 0x20;
    for block in wrong[16..].chunks(16) {
        receiver
            .block(&mut flash, &C::LAYOUT.new, receiver.received(), block)
            .expect("a block");
    }
    let found = checksum_behind(0, &wrong);
    assert_eq!(
        receiver.finish(&mut flash, &C::LAYOUT),
        Err(ReceiveError::Checksum { found })
    );
    assert_eq!(start(&mut flash), Started::Known);
    assert_eq!(stage(&flash, &C::LAYOUT), Stage::None);
}

fn a_journal_of_something_else_is_cleared<C: ChipCells>() {
    let (old, new) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    // An image that was flashed from the beginning of the flash on.
    let noise: Vec<u8> = (0..256).map(|index| (index * 37 % 251) as u8).collect();
    flash.put(&C::LAYOUT.journal, &noise);
    assert!(request(&mut flash, &C::LAYOUT, image(&new)).is_err());
    assert_eq!(start(&mut flash), Started::Known);
    receive(&mut flash, &new).expect("room in the journal");
    assert_eq!(start(&mut flash), Started::OnTrial);
}

/// Content of the program that is lost has no copy: the program is left alone.
#[test]
fn a_program_with_a_hole_is_not_replaced() {
    let (old, new) = programs();
    let mut flash = CutFlash::<G474>::with(&old);
    receive(&mut flash, &new).expect("a whole image");
    flash.lose(G474::LAYOUT.program.start + 16);
    assert_eq!(start(&mut flash), Started::Known);
    assert!(is_reverted(&flash));
}

/// An image that was longer was cut off behind the end of the one that came after it.
#[test]
fn lost_content_behind_an_image_does_not_count() {
    let (old, new) = programs();
    let mut flash = CutFlash::<G474>::with(&old);
    let short = &new[..40];
    receive(&mut flash, short).expect("a whole image");
    let slot = G474::LAYOUT.new;
    flash.lose(slot.start + slot.bytes() - 8);
    assert_eq!(start(&mut flash), Started::OnTrial);
    assert_eq!(flash.bytes(&G474::LAYOUT.program, short.len()), short);
}

/// A record that does not hold is written behind it.
#[test]
fn a_record_that_fails_has_another_place() {
    let (old, new) = programs();
    let mut flash = CutFlash::<G474>::with(&old);
    // Looks erased, and takes no content.
    flash.put(&G474::LAYOUT.journal, &[0xFF; 40]);
    receive(&mut flash, &new).expect("a place in the journal");
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

on_both_chips! {
    a_new_image_is_tried_once_and_stays_if_it_is_confirmed
    a_new_image_that_is_not_confirmed_goes
    a_cut_anywhere_in_an_installation_leaves_one_program_whole
    a_cut_anywhere_on_the_way_back_leaves_one_program_whole
    a_cut_anywhere_in_a_transfer_leaves_the_old_program
    a_cut_in_a_confirmation_leaves_one_program_whole
    a_journal_makes_room_and_a_cut_there_changes_nothing
    cuts_one_after_another_leave_one_program_whole
    an_image_that_is_damaged_in_its_slot_is_not_installed
    blocks_come_in_their_order_and_the_checksum_is_that_of_the_flash
    a_journal_of_something_else_is_cleared
}
