//! Errors of a frame, and counters of how often each occurred.

use core::fmt;

/// Reason that the bytes between two zeros are not a message.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FrameError {
    /// Nothing: two zeros in a row.
    Empty,
    /// More bytes than the decoder holds; everything up to the next zero was skipped.
    TooLong,
    /// Too few bytes for a checksum with anything before it.
    Truncated,
    /// Bad COBS: the frame ends inside a block.
    Stuffing,
    /// The checksum is not that of the bytes.
    Checksum,
    /// The bytes are whole but not a message of the type that was asked for: an unknown
    /// discriminant, a number too large for its type, an end too early.
    Message,
    /// Bytes are left over behind a message that is whole in itself.
    Trailing,
}

impl FrameError {
    /// All of them, in the order of [`Counters::errors`].
    pub const ALL: [Self; 7] = [
        Self::Empty,
        Self::TooLong,
        Self::Truncated,
        Self::Stuffing,
        Self::Checksum,
        Self::Message,
        Self::Trailing,
    ];
}

impl fmt::Display for FrameError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Empty => "empty frame",
            Self::TooLong => "frame longer than any message",
            Self::Truncated => "frame too short for its checksum",
            Self::Stuffing => "frame ends inside a COBS block",
            Self::Checksum => "checksum of the frame is wrong",
            Self::Message => "frame holds no message of this protocol",
            Self::Trailing => "bytes left over behind the message of a frame",
        })
    }
}

impl core::error::Error for FrameError {}

/// Counts of the frames that a decoder has seen. Every counter stops at its largest value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Frames that were messages.
    pub messages: u32,
    /// Frames that were not, by [`FrameError::ALL`].
    errors: [u32; FrameError::ALL.len()],
}

impl Counters {
    /// Nothing seen.
    pub(super) const ZERO: Self = Self {
        messages: 0,
        errors: [0; FrameError::ALL.len()],
    };

    /// Returns how often the decoder met `error`.
    pub fn of(&self, error: FrameError) -> u32 {
        self.errors[error as usize]
    }

    /// Frames that were not messages, of whatever kind.
    pub fn errors(&self) -> u32 {
        self.errors.iter().fold(0, |sum, n| sum.saturating_add(*n))
    }

    pub(super) fn count<T>(&mut self, frame: &Result<T, FrameError>) {
        let counter = match frame {
            Ok(_) => &mut self.messages,
            Err(error) => &mut self.errors[*error as usize],
        };
        *counter = counter.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_error_has_a_counter_and_a_text_of_its_own() {
        let mut counters = Counters::default();
        for (index, error) in FrameError::ALL.into_iter().enumerate() {
            assert_eq!(error as usize, index);
            for _ in 0..=index {
                counters.count::<()>(&Err(error));
            }
        }
        for (index, error) in FrameError::ALL.into_iter().enumerate() {
            assert_eq!(counters.of(error), index as u32 + 1);
            for other in &FrameError::ALL[..index] {
                assert_ne!(std::format!("{error}"), std::format!("{other}"));
            }
        }
        assert_eq!(counters.errors(), 28);
        assert_eq!(counters.messages, 0);
    }

    #[test]
    fn counters_stop_at_their_largest_value() {
        let mut counters = Counters {
            messages: u32::MAX,
            errors: [u32::MAX; 7],
        };
        counters.count(&Ok(()));
        counters.count::<()>(&Err(FrameError::Stuffing));
        assert_eq!(counters.messages, u32::MAX);
        assert_eq!(counters.of(FrameError::Stuffing), u32::MAX);
        assert_eq!(counters.errors(), u32::MAX);
    }
}
