//! Ends of a link that do not have the same key, and the words with which a machine says so.

use std::io;

/// Reason why two ends do not come together, as the client finds it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum KeyRefusal {
    /// The machine has another key.
    #[error("the far end did not accept the key: it has another one")]
    Other,
    /// The machine has a key, the client has none.
    #[error("the far end expects a key: give its key file with --key")]
    Needed,
    /// The client has a key, the machine has none.
    #[error("the far end has no key: leave the key out, or give the far end the same one")]
    Unknown,
    /// The far end does not answer as a machine does.
    #[error("what answers there does not know how to use a key")]
    Foreign,
}

impl KeyRefusal {
    /// Words that a machine sends in place of its handshake. They prove nothing, and tell the user more than a closed line.
    const fn words(self) -> Option<&'static [u8]> {
        match self {
            Self::Other => Some(b"\x00\x11trirrr: other key"),
            Self::Needed => Some(b"\x00\x12trirrr: key needed"),
            Self::Unknown => Some(b"\x00\x13trirrr: no key here"),
            Self::Foreign => None,
        }
    }

    /// Returns what a machine sends to say so.
    pub(super) fn record(self) -> &'static [u8] {
        self.words().unwrap_or_default()
    }

    /// Returns the refusal in `error`, if it is one.
    pub fn of(error: &io::Error) -> Option<Self> {
        error.get_ref()?.downcast_ref().copied()
    }

    /// Returns the refusal as the error of a link.
    pub(super) fn error(self) -> io::Error {
        io::Error::new(io::ErrorKind::PermissionDenied, self)
    }
}

/// Returns the refusal whose words `matches` what was received.
pub(super) fn told(received: &[u8], matches: impl Fn(&[u8], &[u8]) -> bool) -> Option<KeyRefusal> {
    let all = [KeyRefusal::Other, KeyRefusal::Needed, KeyRefusal::Unknown];
    all.into_iter()
        .find(|refusal| matches(refusal.record(), received))
}

/// Returns true if the words of a refusal are complete.
pub(super) fn ends(received: &[u8]) -> bool {
    told(received, |words, received| words == received).is_some()
}

/// Watches the first bytes of a far end without a key for the words that it expects one.
#[derive(Default)]
pub(super) struct FirstBytes {
    matched: usize,
    is_over: bool,
}

impl FirstBytes {
    /// Looks at bytes as they come.
    ///
    /// # Errors
    /// The far end expects a key.
    pub(super) fn look(&mut self, bytes: &[u8]) -> io::Result<()> {
        if self.is_over {
            return Ok(());
        }
        let words = &KeyRefusal::Needed.record()[self.matched..];
        let length = words.len().min(bytes.len());
        self.is_over = words[..length] != bytes[..length];
        self.matched += length;
        match !self.is_over && length == words.len() {
            true => Err(KeyRefusal::Needed.error()),
            false => Ok(()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_a_refusal_have_their_length_in_front() {
        for refusal in [KeyRefusal::Other, KeyRefusal::Needed, KeyRefusal::Unknown] {
            let words = refusal.record();
            let length = usize::from(u16::from_be_bytes([words[0], words[1]]));
            assert_eq!(words.len(), 2 + length, "{refusal:?}");
            let mut first = FirstBytes::default();
            let ends = first.look(&words[..1]).and(first.look(&words[1..]));
            assert_eq!(ends.is_err(), refusal == KeyRefusal::Needed);
            assert!(first.look(b"\x00").is_ok() || refusal == KeyRefusal::Needed);
        }
    }
}
