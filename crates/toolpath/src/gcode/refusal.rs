//! Refusals of lines, with their kinds.
use crate::{PathFault, short};

/// Refusal of a line of G-code.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{fault}")]
pub struct GcodeRefusal {
    /// Kind of the fault.
    pub kind: RefusalKind,
    /// Place and reason, in words.
    pub fault: PathFault,
}

/// Kind of the fault of a line. Programs tell by it what is wrong, and people by the words.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RefusalKind {
    /// Something stands where a letter was expected.
    Letter,
    /// A letter without a number.
    Number,
    /// A value that may not be negative is.
    Negative,
    /// The line is too long.
    TooLong,
    /// A letter, a code or a value that is not supported.
    Unsupported,
    /// Two codes of one modal group.
    ModalGroup,
    /// A motion at the feed has none.
    NoFeed,
    /// A code with a fraction that it does not have.
    NotWhole,
    /// Two codes take the axis words.
    AxisConflict,
    /// A letter stands twice.
    Repeated,
    /// A code needs axis words.
    NoAxes,
    /// A line number that is none.
    LineNumber,
    /// A code needs a word.
    MissingWord,
    /// There is no such coordinate system.
    NoSystem,
    /// G53 needs G0 or G1.
    FixedFrame,
    /// Axis words without a motion mode.
    NoMotionMode,
    /// An arc cannot end there.
    ArcTarget,
    /// The radius of an arc is too small.
    ArcRadius,
    /// An arc has no centre.
    NoCentre,
    /// No code uses the word.
    Unused,
    /// A value is too large.
    TooLarge,
}

/// Refusal of a word. A word longer than 40 characters is cut.
pub(super) fn refusal(kind: RefusalKind, line: u32, word: &str, reason: &str) -> GcodeRefusal {
    let word = short(word);
    let reason = reason.to_owned();
    GcodeRefusal {
        kind,
        fault: PathFault { line, word, reason },
    }
}
