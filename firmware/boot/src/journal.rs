//! Journal of updates: records that are appended, of which the last counts.

use crate::flash::{program_bytes, read_bytes};
use crate::{Flash, FlashError, FlashUnit, Layout, Slot, checksum_behind};

/// An image by its length and its checksum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WholeImage {
    /// Bytes.
    pub length: u32,
    /// CRC-32 of the bytes.
    pub checksum: u32,
}

impl WholeImage {
    /// Nothing is known of the image.
    pub const UNKNOWN: Self = Self {
        length: 0,
        checksum: 0,
    };
}

/// Stage of the last update, with the image that is or will be in place of the program; of [`Saved`](Self::Saved) that of the old one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// There was none, or nothing is known of it.
    None,
    /// The new image is whole; the boot loader installs it at the next start.
    Requested(WholeImage),
    /// The program is saved in the slot of the old one.
    Saved(WholeImage),
    /// The new image is in place of the program, and was not started.
    Installed(WholeImage),
    /// The new program was started, and has not confirmed itself.
    OnTrial(WholeImage),
    /// The new program has confirmed itself.
    Confirmed(WholeImage),
    /// The old program is in its place again, or the new image was not installed.
    Reverted(WholeImage),
}

/// A record that could not be appended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum JournalError {
    /// No room: the boot loader makes some at the next start.
    Full,
    /// The flash.
    Flash(FlashError),
}

impl From<FlashError> for JournalError {
    fn from(error: FlashError) -> Self {
        Self::Flash(error)
    }
}

/// Words of a record: kind, length, checksum of the image, and checksum of these three.
const WORDS: u32 = 4;

/// Bytes of a record, a multiple of a unit's.
const BYTES: u32 = 4 * WORDS;

/// Places at which a record is tried.
const TRIES: u32 = 4;

impl Stage {
    fn record(self) -> [[u8; 4]; WORDS as usize] {
        // Kinds far from each other and from erased flash.
        let (kind, image) = match self {
            Self::None => (0, WholeImage::UNKNOWN),
            Self::Requested(image) => (0x5245_5155, image),
            Self::Saved(image) => (0x5341_5645, image),
            Self::Installed(image) => (0x494E_5354, image),
            Self::OnTrial(image) => (0x5452_4941, image),
            Self::Confirmed(image) => (0x434F_4E46, image),
            Self::Reverted(image) => (0x5245_5645, image),
        };
        let content = [kind, image.length, image.checksum];
        let [a, b, c] = content;
        [a, b, c, check(content)].map(u32::to_le_bytes)
    }

    fn of_record(words: [u32; WORDS as usize]) -> Option<Self> {
        let [kind, length, checksum, sum] = words;
        if sum != check([kind, length, checksum]) {
            return None;
        }
        let image = WholeImage { length, checksum };
        let stages = [
            Self::Requested(image),
            Self::Saved(image),
            Self::Installed(image),
            Self::OnTrial(image),
            Self::Confirmed(image),
            Self::Reverted(image),
        ];
        let is = |stage: &Self| stage.record()[0] == kind.to_le_bytes();
        stages.into_iter().find(is)
    }

    /// The image that is in place of the program, where nothing is left for the boot loader.
    pub(crate) fn settled(self) -> Option<WholeImage> {
        match self {
            Self::None => Some(WholeImage::UNKNOWN),
            Self::Confirmed(image) | Self::Reverted(image) => Some(image),
            _ => None,
        }
    }
}

fn check(content: [u32; 3]) -> u32 {
    content
        .iter()
        .fold(0, |sum, word| checksum_behind(sum, &word.to_le_bytes()))
}

fn records(journal: &Slot) -> impl DoubleEndedIterator<Item = u32> + use<> {
    let start = journal.start;
    (0..journal.bytes() / BYTES).map(move |index| start + BYTES * index)
}

/// Content of the record at `at`. `None` if it is lost.
fn read<F: Flash>(flash: &F, at: u32) -> Option<[u32; WORDS as usize]> {
    let mut bytes = [0; BYTES as usize];
    read_bytes(flash, at, &mut bytes)?;
    Some(words_of(&bytes))
}

/// Words of a record's bytes.
fn words_of(bytes: &[u8; BYTES as usize]) -> [u32; WORDS as usize] {
    let (words, _) = bytes.as_chunks();
    let mut all = [0; WORDS as usize];
    for (to, from) in all.iter_mut().zip(words) {
        *to = u32::from_le_bytes(*from);
    }
    all
}

/// Returns true if the record is erased. Nearly all are, and a start looks at each: no checksum, and no content byte by byte.
fn is_free<F: Flash>(flash: &F, at: u32) -> bool {
    let mut units = (at..at + BYTES).step_by(F::Unit::BYTES as usize);
    units.all(|at| flash.unit(at) == Some(F::Unit::ERASED))
}

/// Returns the stage of the last update.
pub fn stage<F: Flash>(flash: &F, layout: &Layout) -> Stage {
    last(flash, layout, Some).unwrap_or(Stage::None)
}

/// Looks at the stages, the last first, until `look` finds something.
pub(crate) fn last<F: Flash, T>(
    flash: &F,
    layout: &Layout,
    look: impl Fn(Stage) -> Option<T>,
) -> Option<T> {
    let used = records(&layout.journal)
        .rev()
        .filter(|at| !is_free(flash, *at));
    let mut stages = used.filter_map(|at| Stage::of_record(read(flash, at)?));
    stages.find_map(look)
}

/// Appends a record.
pub(crate) fn append<F: Flash>(
    flash: &mut F,
    layout: &Layout,
    stage: Stage,
) -> Result<(), JournalError> {
    // Behind the last that is not erased: one that was cut takes its place for good.
    let used = records(&layout.journal)
        .rev()
        .find(|at| !is_free(flash, *at));
    let mut at = used.map_or(layout.journal.start, |used| used + BYTES);
    let mut record = [0; BYTES as usize];
    for (to, from) in record.iter_mut().zip(stage.record().as_flattened()) {
        *to = *from;
    }
    let mut result = Err(JournalError::Full);
    for _ in 0..TRIES {
        if at + BYTES > layout.journal.start + layout.journal.bytes() {
            break;
        }
        let Err(error) = program_bytes(flash, at, &record) else {
            return Ok(());
        };
        // An erasure that was cut may leave what looks erased and takes no content. It shall not look so again.
        let _ = flash.program(at + BYTES - F::Unit::BYTES, F::Unit::CLEARED);
        result = Err(JournalError::Flash(error));
        at += BYTES;
    }
    result
}

/// Erases a journal that is more than half full, and whose stage is `settled`. A cut of the power may forget that.
pub(crate) fn make_room<F: Flash>(
    flash: &mut F,
    layout: &Layout,
    settled: Stage,
) -> Result<(), JournalError> {
    let half = layout.journal.start + layout.journal.bytes() / 2;
    let used = |flash: &F, at: u32| !is_free(flash, at);
    if !records(&layout.journal).any(|at| at >= half && used(flash, at)) {
        return Ok(());
    }
    // An erasure that is cut may leave any of them. So none is valid when it begins; the last to go is the last, which is settled.
    for at in records(&layout.journal) {
        if used(flash, at) {
            flash.program(at + BYTES - F::Unit::BYTES, F::Unit::CLEARED)?;
        }
    }
    for sector in layout.journal.sectors() {
        flash.erase(sector)?;
    }
    match settled {
        Stage::None => Ok(()),
        stage => append(flash, layout, stage),
    }
}

/// Asks the boot loader to install the new image at the next start.
///
/// # Errors
/// The journal is full, or the flash fails.
pub fn request<F: Flash>(
    flash: &mut F,
    layout: &Layout,
    image: WholeImage,
) -> Result<(), JournalError> {
    append(flash, layout, Stage::Requested(image))
}

/// Confirms the program that runs. Does nothing unless it is on trial.
///
/// # Errors
/// The journal is full, or the flash fails.
pub fn confirm<F: Flash>(flash: &mut F, layout: &Layout) -> Result<(), JournalError> {
    match stage(flash, layout) {
        Stage::OnTrial(image) => append(flash, layout, Stage::Confirmed(image)),
        _ => Ok(()),
    }
}

/// Returns true if there is no program in the slot.
pub fn is_blank<F: Flash>(flash: &F, slot: &Slot) -> bool {
    is_free(flash, slot.start)
}
