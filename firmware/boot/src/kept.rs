//! Content in two slots, of which the newer whole one counts: a scene that has come over the line.
//!
//! The content lies at the beginning of its slot, and its record at the end, which is written behind it. So a slot counts
//! once its last unit is there. New content goes into the slot that does not count: the other stays whole until then.

use crate::boot::is_whole;
use crate::flash::{program_bytes, read_bytes};
use crate::journal::WholeImage;
use crate::{Flash, FlashError, Slot, checksum_behind};

/// Words of a record: one that stays erased, number, owner, length and checksum of the content, and checksum of these four. With the first
/// they are a number of units on every chip.
const WORDS: usize = 6;

/// Content that a slot keeps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kept {
    slot: Slot,
    /// Counts the contents, modulo 2^32.
    number: u32,
    /// Program that has taken it.
    owner: u32,
    content: WholeImage,
}

impl Slot {
    /// Most bytes of content beside its record.
    pub const fn room(&self) -> u32 {
        self.bytes() - 4 * WORDS as u32
    }

    /// Address of the record.
    fn record(&self) -> u32 {
        self.start + self.room()
    }
}

fn check(content: [u32; 4]) -> u32 {
    content
        .iter()
        .fold(0, |sum, word| checksum_behind(sum, &word.to_le_bytes()))
}

impl Kept {
    /// Content of `slot`. `None` if there is none, or it is not whole.
    fn of<F: Flash>(flash: &F, slot: &Slot) -> Option<Self> {
        let mut words = [[0; 4]; WORDS];
        read_bytes(flash, slot.record(), words.as_flattened_mut())?;
        let [_, number, owner, length, checksum, sum] = words.map(u32::from_le_bytes);
        if sum != check([number, owner, length, checksum]) || length > slot.room() {
            return None;
        }
        let content = WholeImage { length, checksum };
        is_whole(flash, slot, content).then_some(Self {
            slot: *slot,
            number,
            owner,
            content,
        })
    }

    fn is_newer_than(&self, other: &Self) -> bool {
        // Half of all numbers are behind any of them.
        self.number.wrapping_sub(other.number) as i32 > 0
    }

    /// Reads the content into the beginning of `room`. `None` if it is longer.
    pub fn read<'b, F: Flash>(&self, flash: &F, room: &'b mut [u8]) -> Option<&'b [u8]> {
        read(flash, &self.slot, self.content.length, room)
    }
}

/// Reads the first `length` bytes of `slot` into the beginning of `room`. `None` if there is no room for them, or one is lost.
pub fn read<'b, F: Flash>(
    flash: &F,
    slot: &Slot,
    length: u32,
    room: &'b mut [u8],
) -> Option<&'b [u8]> {
    let bytes = room.get_mut(..length as usize)?;
    read_bytes(flash, slot.start, bytes)?;
    Some(bytes)
}

/// Contents of both slots, the newer first.
fn contents<F: Flash>(flash: &F, slots: &[Slot; 2]) -> [Option<Kept>; 2] {
    let [a, b] = slots.each_ref().map(|slot| Kept::of(flash, slot));
    match (&a, &b) {
        (Some(first), Some(second)) if second.is_newer_than(first) => [b, a],
        (None, Some(_)) => [b, a],
        _ => [a, b],
    }
}

/// Whole contents that the program `owner` has taken, the newer first.
pub fn kept<F: Flash>(
    flash: &F,
    slots: &[Slot; 2],
    owner: u32,
) -> impl Iterator<Item = Kept> + use<F> {
    let contents = contents(flash, slots).into_iter().flatten();
    contents.filter(move |content| content.owner == owner)
}

/// Slot for new content: not that of the content that counts for the program `owner`, or, where none does, of the newer one.
pub fn spare<F: Flash>(flash: &F, slots: &[Slot; 2], owner: u32) -> Slot {
    let counts = kept(flash, slots, owner).next();
    let counts = counts.or(contents(flash, slots)[0]);
    match counts {
        Some(kept) if kept.slot == slots[0] => slots[1],
        _ => slots[0],
    }
}

/// Writes the record of the `content` in `slot`, one of both: from the last unit on it counts, and the other does no more.
///
/// # Errors
/// The flash fails: then the other counts as before.
pub fn keep<F: Flash>(
    flash: &mut F,
    slots: &[Slot; 2],
    slot: &Slot,
    owner: u32,
    content: WholeImage,
) -> Result<(), FlashError> {
    let newest = contents(flash, slots)[0].map_or(0, |kept| kept.number);
    let number = newest.wrapping_add(1);
    let WholeImage { length, checksum } = content;
    let sum = check([number, owner, length, checksum]);
    let words = [u32::MAX, number, owner, length, checksum, sum].map(u32::to_le_bytes);
    program_bytes(flash, slot.record(), words.as_flattened())
}
