//! A link: bytes to a far end and back.

use std::io;
use std::time::Duration;

/// Limit of a write: a far end that takes no byte for this long does not read.
pub(crate) const WRITE_TIMEOUT: Duration = Duration::from_secs(1);

/// Open link, used from one thread.
pub trait Link: Send {
    /// Waits up to `timeout` for bytes and reads at most as many as `buffer` holds. Returns the number of
    /// bytes, 0 if none came.
    ///
    /// # Errors
    /// The link is lost; [`io::ErrorKind::UnexpectedEof`] if the far end closed the link.
    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize>;

    /// Sends all of `bytes`.
    ///
    /// # Errors
    /// The link is lost; [`io::ErrorKind::TimedOut`] if the far end does not read.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;
}

/// Returns the error of a link that the far end closed.
pub(crate) fn closed() -> io::Error {
    io::Error::new(io::ErrorKind::UnexpectedEof, "closed by the far end")
}
