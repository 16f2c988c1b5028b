//! TCP, from both ends.

use super::{Link, WRITE_TIMEOUT, closed};
use std::io::{self, Read, Write};
use std::net::{SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::time::Duration;

/// Limit of the wait for an address that does not answer.
const CONNECT_TIMEOUT: Duration = Duration::from_secs(5);

/// Open connection.
#[derive(Debug)]
pub struct TcpLink {
    stream: TcpStream,
    /// The read timeout that is set; setting it costs a system call.
    timeout: Option<Duration>,
}

/// Connects to `HOST:PORT`, to the first of the host's addresses that answers.
pub(super) fn connect(address: &str) -> io::Result<TcpLink> {
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

    /// Reads the bytes that have come, without waiting. Returns 0 if none have come.
    ///
    /// # Errors
    /// As [`Link::receive`].
    pub fn receive_now(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        self.stream.set_nonblocking(true)?;
        let read = self.stream.read(buffer);
        self.stream.set_nonblocking(false)?;
        taken(read)
    }

    /// Sends as many of `bytes` as possible without waiting. Returns their number.
    ///
    /// # Errors
    /// As [`Link::send`].
    pub fn send_now(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.stream.set_nonblocking(true)?;
        let written = self.stream.write(bytes);
        self.stream.set_nonblocking(false)?;
        match written {
            Err(error) if is_for_want_of_time(&error) => Ok(0),
            Err(error) if is_closed(&error) => Err(closed()),
            written => written,
        }
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
fn taken(read: io::Result<usize>) -> io::Result<usize> {
    match read {
        Ok(0) => Err(closed()),
        Err(error) if is_for_want_of_time(&error) => Ok(0),
        Err(error) if is_closed(&error) => Err(closed()),
        read => read,
    }
}

/// Returns true if the far end closed the connection. A far end that has not read everything resets the
/// connection.
fn is_closed(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::ConnectionReset
            | io::ErrorKind::ConnectionAborted
            | io::ErrorKind::BrokenPipe
    )
}

fn is_for_want_of_time(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut | io::ErrorKind::Interrupted
    )
}

/// TCP port that waits for clients.
#[derive(Debug)]
pub struct Listener {
    listener: TcpListener,
    address: SocketAddr,
}

impl Listener {
    /// Listens at `HOST:PORT`. Port 0 takes a free one.
    ///
    /// # Errors
    /// The address does not belong to this computer, or is taken.
    pub fn bind(address: &str) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        listener.set_nonblocking(true)?;
        let address = listener.local_addr()?;
        Ok(Self { listener, address })
    }

    /// Returns the address of the port.
    pub fn address(&self) -> SocketAddr {
        self.address
    }

    /// Returns a client that has come, if any.
    ///
    /// # Errors
    /// The port is lost. A client that has left again is no error.
    pub fn accept(&self) -> io::Result<Option<(TcpLink, SocketAddr)>> {
        match self.listener.accept() {
            Ok((stream, from)) => Ok(TcpLink::new(stream).ok().map(|link| (link, from))),
            Err(error) if is_for_want_of_time(&error) => Ok(None),
            Err(error) if error.kind() == io::ErrorKind::ConnectionAborted => Ok(None),
            Err(error) => Err(error),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_see_the_other_go() {
        let listener = Listener::bind("127.0.0.1:0").unwrap();
        assert!(listener.accept().unwrap().is_none());
        let mut client = connect(&listener.address().to_string()).unwrap();
        let mut board = loop {
            if let Some((link, _)) = listener.accept().unwrap() {
                break link;
            }
        };
        let mut buffer = [0; 16];
        assert_eq!(board.receive_now(&mut buffer).unwrap(), 0, "nothing yet");
        client.send(b"hello").unwrap();
        let length = board.receive(&mut buffer, Duration::from_secs(10)).unwrap();
        assert_eq!(&buffer[..length], b"hello");
        assert_eq!(board.send_now(b"welcome").unwrap(), 7);
        let length = client
            .receive(&mut buffer, Duration::from_secs(10))
            .unwrap();
        assert_eq!(&buffer[..length], b"welcome");
        drop(client);
        let gone = board
            .receive(&mut buffer, Duration::from_secs(10))
            .unwrap_err();
        assert_eq!(gone.kind(), io::ErrorKind::UnexpectedEof);
    }

    #[test]
    fn a_far_end_that_does_not_read_holds_nobody_up() {
        let listener = Listener::bind("127.0.0.1:0").unwrap();
        let client = connect(&listener.address().to_string()).unwrap();
        let mut board = loop {
            if let Some((link, _)) = listener.accept().unwrap() {
                break link;
            }
        };
        // Far more than the system's buffers hold: at some point nothing more goes.
        let block = vec![0; 1 << 20];
        while board.send_now(&block).unwrap() > 0 {}
        drop(client);
    }
}
