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
    pub(crate) fn record(self) -> &'static [u8] {
        self.words().unwrap_or_default()
    }

    /// Returns the refusal in `error`, if it is one.
    pub fn of(error: &io::Error) -> Option<Self> {
        error.get_ref()?.downcast_ref().copied()
    }

    /// Returns the refusal as the error of a link.
    pub(crate) fn error(self) -> io::Error {
        io::Error::new(io::ErrorKind::PermissionDenied, self)
    }
}

/// Returns the refusal whose words `matches` what was received.
pub(crate) fn told(received: &[u8], matches: impl Fn(&[u8], &[u8]) -> bool) -> Option<KeyRefusal> {
    let all = [KeyRefusal::Other, KeyRefusal::Needed, KeyRefusal::Unknown];
    all.into_iter()
        .find(|refusal| matches(refusal.record(), received))
}

/// Returns true if the words of a refusal are complete.
pub(crate) fn ends(received: &[u8]) -> bool {
    told(received, |words, received| words == received).is_some()
}

/// The machine has another client.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error(
    "another client has the machine, which takes one at a time: end that client, or wait until it has gone"
)]
pub struct OtherClient;

impl OtherClient {
    /// Words that a machine sends to a client that it turns away, in place of an answer.
    pub(crate) const WORDS: &[u8] = b"\x00\x16trirrr: another client";

    /// Returns true if `error` says so.
    pub fn is_in(error: &io::Error) -> bool {
        error.get_ref().is_some_and(|inner| inner.is::<Self>())
    }

    fn error() -> io::Error {
        io::Error::new(io::ErrorKind::ResourceBusy, Self)
    }
}

/// Watches the first bytes of a far end for the words that it expects a key, or has another client.
#[derive(Default)]
pub(crate) struct FirstBytes {
    seen: Vec<u8>,
    is_over: bool,
}

impl FirstBytes {
    /// Looks at bytes as they come.
    ///
    /// # Errors
    /// The far end expects a key, or has another client.
    pub(crate) fn look(&mut self, bytes: &[u8]) -> io::Result<()> {
        let words = [KeyRefusal::Needed.record(), OtherClient::WORDS];
        if self.is_over {
            return Ok(());
        }
        let longest = words.iter().map(|words| words.len()).max().unwrap_or(0);
        let room = longest.saturating_sub(self.seen.len()).min(bytes.len());
        self.seen.extend_from_slice(&bytes[..room]);
        let [needed, other] = words.map(|words| self.seen.starts_with(words));
        self.is_over = !words.iter().any(|words| words.starts_with(&self.seen));
        match (needed, other) {
            (true, _) => Err(KeyRefusal::Needed.error()),
            (_, true) => Err(OtherClient::error()),
            _ => Ok(()),
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
        let words = OtherClient::WORDS;
        assert_eq!(usize::from(words[1]), words.len() - 2);
        let mut first = FirstBytes::default();
        assert!(first.look(&words[..9]).is_ok());
        let mut rest = words[9..].to_vec();
        rest.extend(b"more");
        assert!(OtherClient::is_in(&first.look(&rest).unwrap_err()));
        // Samples may hold the same bytes.
        let mut first = FirstBytes::default();
        assert!(first.look(b"\x05frame\x00").is_ok() && first.look(words).is_ok());
    }
}
