//! Scenes that come over the line.

use crate::cut_flash::{ChipCells, CutFlash};
use crate::image;
use trirrr_boot::{FlashError, FlashUnit as _, ReceiveError, Receiver, boot, keep, kept, spare};

/// Program that takes the scenes.
const OWNER: u32 = 0x1234_5678;

/// Takes `content` as a program does.
fn take<C: ChipCells>(
    flash: &mut CutFlash<C>,
    content: &[u8],
    owner: u32,
) -> Result<(), ReceiveError> {
    let slot = spare(flash, &C::LAYOUT.scenes, owner);
    let mut receiver = Receiver::NONE;
    receiver.begin(slot.room(), image(content))?;
    for block in content.chunks(8) {
        receiver.block(flash, &slot, receiver.received(), block)?;
    }
    let content = receiver.whole()?;
    Ok(keep(flash, &C::LAYOUT.scenes, &slot, owner, content)?)
}

/// Contents of `owner`, the newer first.
fn contents<C: ChipCells>(flash: &CutFlash<C>, owner: u32) -> Vec<Vec<u8>> {
    let read = |kept: trirrr_boot::Kept| {
        let mut room = [0; 64];
        let content = kept.read(flash, &mut room).expect("room for a slot");
        content.to_vec()
    };
    kept(flash, &C::LAYOUT.scenes, owner).map(read).collect()
}

/// Content number `number`, of any length up to the room, which ends within a word.
fn content(number: u8) -> Vec<u8> {
    let length = 3 + usize::from(number) * 7 % 37;
    (0..length as u8).map(|byte| byte ^ number).collect()
}

fn the_newer_content_counts_and_the_other_stays_behind_it<C: ChipCells>() {
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    assert_eq!(contents(&flash, OWNER), Vec::<Vec<u8>>::new());
    for number in 0..20 {
        take(&mut flash, &content(number), OWNER).expect("a flash with power");
        let expected: Vec<Vec<u8>> = (number.saturating_sub(1)..=number)
            .rev()
            .map(content)
            .collect();
        assert_eq!(contents(&flash, OWNER), expected);
    }
    // The boot loader leaves them alone.
    boot(&mut flash, &C::LAYOUT).expect("a flash with power");
    assert_eq!(contents(&flash, OWNER), [content(19), content(18)]);
}

fn a_cut_anywhere_leaves_the_old_content_or_the_new_one<C: ChipCells>() {
    let mut first = CutFlash::<C>::with(&[1, 2, 3]);
    for number in 0..3 {
        take(&mut first, &content(number), OWNER).expect("a flash with power");
    }
    let (old, new) = (content(2), content(3));
    let mut whole = first.clone();
    whole.power_on(None);
    take(&mut whole, &new, OWNER).expect("a flash with power");
    let operations = whole.operations;
    // An erasure, 24 bytes of content, a record of five words behind one that stays erased.
    assert_eq!(
        operations,
        1 + 24 / C::Unit::BYTES + 20u32.div_ceil(C::Unit::BYTES)
    );
    for seed in 0..200 {
        for cut in 0..operations {
            let mut flash = first.clone();
            flash.noise = seed;
            flash.power_on(Some(cut));
            assert!(take(&mut flash, &new, OWNER).is_err());
            flash.power_on(None);
            let newest = contents(&flash, OWNER).swap_remove(0);
            assert!(newest == old || newest == new, "seed {seed}, cut {cut}");
            // The last unit may have been programmed in spite of the cut.
            assert!(
                newest == old || cut + 1 == operations,
                "seed {seed}, cut {cut}"
            );
            // The next one is none the worse.
            let after = content(4);
            take(&mut flash, &after, OWNER).expect("a flash with power");
            assert_eq!(contents(&flash, OWNER)[0], after, "seed {seed}, cut {cut}");
        }
    }
}

fn cuts_one_after_another_leave_one_content_whole<C: ChipCells>() {
    for seed in 0..200 {
        let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
        flash.noise = seed;
        take(&mut flash, &content(0), OWNER).expect("a flash with power");
        for number in 1..8 {
            let before = contents(&flash, OWNER).swap_remove(0);
            let cut = flash.random() % 20;
            flash.power_on(Some(cut));
            let taken = take(&mut flash, &content(number), OWNER);
            flash.power_on(None);
            let newest = contents(&flash, OWNER).swap_remove(0);
            let is_new = newest == content(number);
            assert!(is_new || newest == before, "seed {seed}, {number}");
            assert!(is_new || taken.is_err(), "seed {seed}, {number}");
        }
    }
}

fn content_of_another_program_does_not_count_and_is_the_first_to_go<C: ChipCells>() {
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    take(&mut flash, &content(0), OWNER + 1).expect("a flash with power");
    take(&mut flash, &content(1), OWNER).expect("a flash with power");
    assert_eq!(contents(&flash, OWNER), [content(1)]);
    assert_eq!(contents(&flash, OWNER + 1), [content(0)]);
    for number in 2..4 {
        take(&mut flash, &content(number), OWNER).expect("a flash with power");
    }
    assert_eq!(contents(&flash, OWNER), [content(3), content(2)]);
    assert_eq!(contents(&flash, OWNER + 1), Vec::<Vec<u8>>::new());
}

fn content_that_is_damaged_does_not_count<C: ChipCells>() {
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    for number in 0..2 {
        take(&mut flash, &content(number), OWNER).expect("a flash with power");
    }
    let slot = C::LAYOUT.scenes[1];
    for address in [
        slot.start,
        slot.start + slot.room() + 4,
        slot.start + slot.room() + 12,
    ] {
        let mut damaged = flash.clone();
        damaged.damage(address, 1 << 7);
        assert_eq!(contents(&damaged, OWNER), [content(0)], "{address:#x}");
    }
}

fn content_has_the_room_of_a_slot_without_its_record<C: ChipCells>() {
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    let room = C::LAYOUT.scenes[0].room() as usize;
    assert_eq!(room, 40);
    let longest: Vec<u8> = (0..room as u8).collect();
    take(&mut flash, &longest, OWNER).expect("room");
    assert_eq!(contents(&flash, OWNER), [longest]);
    let longer = take(&mut flash, &vec![1; room + 1], OWNER);
    assert_eq!(longer, Err(ReceiveError::Length));
    let kept = kept(&flash, &C::LAYOUT.scenes, OWNER)
        .next()
        .expect("content");
    assert_eq!(kept.read(&flash, &mut [0; 39]), None);
}

fn a_flash_that_fails_is_told<C: ChipCells>() {
    let mut flash = CutFlash::<C>::with(&[1, 2, 3]);
    flash.power_on(Some(0));
    let failed = take(&mut flash, &content(0), OWNER);
    let sector = C::LAYOUT.scenes[0].first_sector;
    let error = FlashError {
        place: sector.into(),
        status: 0,
    };
    assert_eq!(failed, Err(error.into()));
}

on_both_chips! {
    the_newer_content_counts_and_the_other_stays_behind_it
    a_cut_anywhere_leaves_the_old_content_or_the_new_one
    cuts_one_after_another_leave_one_content_whole
    content_of_another_program_does_not_count_and_is_the_first_to_go
    content_that_is_damaged_does_not_count
    content_has_the_room_of_a_slot_without_its_record
    a_flash_that_fails_is_told
}
