//! TCP links of a client, with a key and without.

use crate::refusal::FirstBytes;
use crate::seal::{PLAIN, Seal};
use crate::tcp::TcpLink;
use crate::{Link, SharedKey};
use std::io;
use std::time::{Duration, Instant};

/// Longest wait for the far end to answer a greeting.
const GREETING_TIMEOUT: Duration = Duration::from_secs(5);

/// Bytes that are read of a far end that has closed the line.
const LAST: usize = 256;

/// Connection without a key.
pub(crate) struct PlainLink {
    link: TcpLink,
    first: FirstBytes,
}

impl PlainLink {
    pub(crate) fn new(link: TcpLink) -> Self {
        Self {
            link,
            first: FirstBytes::default(),
        }
    }
}

impl Link for PlainLink {
    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let length = self.link.receive(buffer, timeout)?;
        self.first.look(&buffer[..length])?;
        Ok(length)
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let sent = self.link.send(bytes);
        sent.map_err(|error| said_at_last(self, error))
    }
}

/// Connection under a key.
pub(crate) struct SealedLink {
    link: TcpLink,
    seal: Seal,
    first: FirstBytes,
}

impl SealedLink {
    /// Greets the far end of `link`, and waits for its answer.
    ///
    /// # Errors
    /// [`KeyRefusal`](super::KeyRefusal); [`io::ErrorKind::TimedOut`] if no answer comes; as [`Link`].
    pub(crate) fn greet(link: TcpLink, key: &SharedKey) -> io::Result<Self> {
        let seal = Seal::of_client(key)?;
        let first = FirstBytes::default();
        let mut link = Self { link, seal, first };
        let end = Instant::now() + GREETING_TIMEOUT;
        link.send_sealed()?;
        while !link.seal.is_open() {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                let reason = "it does not answer to a key: it may have none";
                return Err(io::Error::new(io::ErrorKind::TimedOut, reason));
            }
            link.read(left)?;
            link.seal.greet()?;
        }
        link.send_sealed()?;
        Ok(link)
    }

    /// Reads what comes within `timeout`. Returns false if nothing came.
    fn read(&mut self, timeout: Duration) -> io::Result<bool> {
        let mut bytes = [0; PLAIN];
        let room = self.seal.room().min(bytes.len());
        let length = self.link.receive(&mut bytes[..room], timeout)?;
        self.seal.take(&bytes[..length]);
        Ok(length > 0)
    }

    fn send_sealed(&mut self) -> io::Result<()> {
        self.link.send(self.seal.outgoing())?;
        self.seal.sent(self.seal.outgoing().len());
        Ok(())
    }
}

impl Link for SealedLink {
    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let end = Instant::now() + timeout;
        loop {
            let length = self.seal.open(buffer)?;
            self.first.look(&buffer[..length])?;
            if length > 0 || !self.read(end.saturating_duration_since(Instant::now()))? {
                return Ok(length);
            }
        }
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let sealed = bytes.chunks(PLAIN).try_for_each(|bytes| {
            self.seal.seal(bytes)?;
            self.send_sealed()
        });
        sealed.map_err(|error| said_at_last(self, error))
    }
}

/// Returns the reason that a far end has given before it closed the line, or else `error`.
fn said_at_last(link: &mut impl Link, error: io::Error) -> io::Error {
    match link.receive(&mut [0; LAST], Duration::ZERO) {
        Err(why) if why.get_ref().is_some() => why,
        _ => error,
    }
}
