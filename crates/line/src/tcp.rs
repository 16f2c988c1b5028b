//! TCP, from the end of a client.

use crate::{Link, WRITE_TIMEOUT, closed};
use std::io::{self, Read, Write};
use std::net::{TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Limit of the wait for an address that does not answer.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// Open connection of a client.
#[derive(Debug)]
pub(crate) struct TcpLink {
    stream: TcpStream,
    /// The read timeout that is set; setting it costs a system call.
    timeout: Option<Duration>,
}

/// Connects to `HOST:PORT`, to the first of the host's addresses that answers.
pub(crate) fn connect(address: &str) -> io::Result<TcpLink> {
    let mut last = io::Error::new(io::ErrorKind::NotFound, "the host has no address");
    for address in address.to_socket_addrs()? {
        match TcpStream::connect_timeout(&address, CONNECT_TIMEOUT) {
            Ok(stream) => return TcpLink::new(stream),
            Err(error) => last = error,
        }
    }
    Err(last)
}

impl TcpLink {
    fn new(stream: TcpStream) -> io::Result<Self> {
        // Frames are short and each is waited for.
        stream.set_nodelay(true)?;
        stream.set_nonblocking(false)?;
        stream.set_write_timeout(Some(WRITE_TIMEOUT))?;
        Ok(Self {
            stream,
            timeout: None,
        })
    }

    fn receive_now(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_nonblocking(true)?;
        let read = self.stream.read(buffer);
        self.stream.set_nonblocking(false)?;
        taken(read)
    }
}

impl Link for TcpLink {
    fn receive(&mut self, buffer: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if timeout.is_zero() {
            return self.receive_now(buffer);
        }
        if self.timeout != Some(timeout) {
            self.stream.set_read_timeout(Some(timeout))?;
            self.timeout = Some(timeout);
        }
        taken(self.stream.read(buffer))
    }

    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.stream.write_all(bytes).map_err(|error| {
            // Linux calls a write timeout "would block".
            match is_for_want_of_time(&error) {
                true => io::ErrorKind::TimedOut.into(),
                false if is_closed(&error) => closed(),
                false => error,
            }
        })
    }
}

/// Converts the result of a read to that of [`Link::receive`].
pub(crate) fn taken(read: io::Result<usize>) -> io::Result<usize> {
    match read {
        Ok(0) => Err(closed()),
        Err(error) if is_for_want_of_time(&error) => Ok(0),
        Err(error) if is_closed(&error) => Err(closed()),
        read => read,
    }
}

/// Returns true if the far end closed the connection. A far end that has not read everything resets the
/// connection.
pub(crate) fn is_closed(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::BrokenPipe
    )
}

pub(crate) fn is_for_want_of_time(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}
