//! Content that is damaged without a cut of the power, as of cells that wear out: programs, and records of the journal.

use crate::cut_flash::{ChipCells, CutFlash};
use crate::{image, programs, receive, start};
use trirrr_boot::{
    JournalError, Receiver, Slot, Stage, Started, WholeImage, boot, confirm, is_blank, request,
    stage,
};

/// A board whose new program is confirmed, and one that has gone back to the old one.
fn settled<C: ChipCells>() -> [(CutFlash<C>, Vec<u8>, Slot); 2] {
    let (old, new) = programs();
    let mut confirmed = CutFlash::<C>::with(&old);
    receive(&mut confirmed, &new).expect("a whole image");
    start(&mut confirmed);
    let mut reverted = confirmed.clone();
    confirm(&mut confirmed, &C::LAYOUT).expect("room in the journal");
    start(&mut reverted);
    [
        (confirmed, new, C::LAYOUT.new),
        (reverted, old, C::LAYOUT.old),
    ]
}

fn a_damaged_program_is_replaced_by_its_copy<C: ChipCells>() {
    for (mut flash, program, copy) in settled::<C>() {
        assert_eq!(start(&mut flash), Started::Known);
        assert_eq!(flash.operations, 0, "an intact program is left alone");
        for at in 0..program.len() as u32 {
            let mut damaged = flash.clone();
            damaged.damage(C::LAYOUT.program.start + at, 1 << (at % 8));
            assert_eq!(start(&mut damaged), Started::Known, "byte {at}");
            let bytes = damaged.bytes(&C::LAYOUT.program, program.len());
            assert_eq!(bytes, program, "byte {at}");
            assert_eq!(start(&mut damaged), Started::Known, "byte {at}");
            assert_eq!(damaged.operations, 0, "byte {at}");
        }
        flash.damage(C::LAYOUT.program.start + 9, 4);
        flash.damage(copy.start + 1, 4);
        assert_eq!(start(&mut flash), Started::Nothing);
        assert_eq!(flash.operations, 0);
    }
}

fn a_cut_while_a_program_is_replaced_by_its_copy_leaves_it_whole_in_the_end<C: ChipCells>() {
    for (mut flash, program, _) in settled::<C>() {
        flash.damage(C::LAYOUT.program.start + 5, 0x40);
        let mut whole = flash.clone();
        start(&mut whole);
        assert!(whole.operations > 8, "{}", whole.operations);
        for seed in 0..8 {
            for cut in 0..whole.operations {
                let mut flash = flash.clone();
                flash.noise = seed;
                flash.power_on(Some(cut));
                assert!(boot(&mut flash, &C::LAYOUT).is_err(), "{seed}, {cut}");
                assert_eq!(start(&mut flash), Started::Known, "{seed}, {cut}");
                let bytes = flash.bytes(&C::LAYOUT.program, program.len());
                assert_eq!(bytes, program, "{seed}, {cut}");
            }
        }
    }
}

/// The copy would be what the board goes back to.
fn a_damaged_program_is_not_replaced_by_an_update<C: ChipCells>() {
    let [(mut flash, new, _), _] = settled::<C>();
    let (old, _) = programs();
    receive(&mut flash, &old).expect("a whole image");
    flash.damage(C::LAYOUT.program.start, 1);
    assert_eq!(start(&mut flash), Started::Nothing);
    assert_eq!(stage(&flash, &C::LAYOUT), Stage::Reverted(image(&new)));
}

/// A board that was flashed by a probe, and one that another version of the boot loader has updated.
fn a_program_without_a_checksum_is_started<C: ChipCells>() {
    let (old, _) = programs();
    let mut flash = CutFlash::<C>::with(&old);
    flash.damage(C::LAYOUT.program.start + 3, 1);
    assert_eq!(start(&mut flash), Started::Known);
    // The kind "CONF", no length, no checksum, and the CRC-32 of these three words.
    let mut record = [0; 16];
    record[..4].copy_from_slice(&0x434F_4E46_u32.to_le_bytes());
    let sum = trirrr_boot::checksum_behind(0, &record[..12]);
    record[12..].copy_from_slice(&sum.to_le_bytes());
    flash.put(&C::LAYOUT.journal, &record);
    let unknown = Stage::Confirmed(WholeImage::UNKNOWN);
    assert_eq!(stage(&flash, &C::LAYOUT), unknown);
    assert_eq!(start(&mut flash), Started::Known);
}

fn a_journal_takes_records_up_to_its_last_byte<C: ChipCells>() {
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    let places = C::LAYOUT.journal.bytes() / 16;
    for number in 1..=places {
        let asked = WholeImage {
            length: number,
            checksum: 7,
        };
        request(&mut flash, &C::LAYOUT, asked).expect("a place in the journal");
        assert_eq!(stage(&flash, &C::LAYOUT), Stage::Requested(asked));
    }
    let full = request(&mut flash, &C::LAYOUT, WholeImage::UNKNOWN);
    assert_eq!(full, Err(JournalError::Full));
}

fn a_record_with_a_wrong_bit_counts_as_none<C: ChipCells>() {
    let of = |length| WholeImage {
        length,
        checksum: 0x1234_5678,
    };
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    for length in [5, 6] {
        request(&mut flash, &C::LAYOUT, of(length)).expect("a place in the journal");
    }
    for bit in 0..128 {
        let mut flash = flash.clone();
        let second = C::LAYOUT.journal.start + 16;
        flash.damage(second + bit / 8, 1 << (bit % 8));
        assert_eq!(
            stage(&flash, &C::LAYOUT),
            Stage::Requested(of(5)),
            "bit {bit}"
        );
    }
}

fn a_slot_is_blank_until_its_beginning_holds_something<C: ChipCells>() {
    let flash = CutFlash::<C>::with(&[1, 2, 3]);
    assert!(is_blank(&flash, &C::LAYOUT.new) && !is_blank(&flash, &C::LAYOUT.program));
}

fn the_image_that_comes_is_the_one_that_was_begun<C: ChipCells>() {
    let mut receiver = Receiver::NONE;
    assert_eq!(receiver.image(), None);
    let (_, new) = programs();
    let begun = receiver.begin(C::LAYOUT.new.bytes(), image(&new));
    assert_eq!((begun, receiver.image()), (Ok(()), Some(image(&new))));
}

on_both_chips! {
    a_damaged_program_is_replaced_by_its_copy
    a_cut_while_a_program_is_replaced_by_its_copy_leaves_it_whole_in_the_end
    a_damaged_program_is_not_replaced_by_an_update
    a_program_without_a_checksum_is_started
    a_journal_takes_records_up_to_its_last_byte
    a_record_with_a_wrong_bit_counts_as_none
    a_slot_is_blank_until_its_beginning_holds_something
    the_image_that_comes_is_the_one_that_was_begun
}
