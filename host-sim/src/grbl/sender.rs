//! Line to the sender: a TCP port, or a pseudo terminal.

use crate::failure::CliError;
#[cfg(unix)]
use serialport::{SerialPort, TTYPort};
use std::io::{self, ErrorKind, Read, Write};
use std::net::{TcpListener, TcpStream, ToSocketAddrs};

/// Bytes taken at a time.
const CHUNK: usize = 16 * 1024;

/// Bytes that wait for a sender that does not read: more, and it is cut off.
const MOST_WAITING: usize = 64 * 1024;

/// Place where senders come.
pub(super) enum SenderDoor {
    /// TCP port.
    Tcp(TcpListener),
    /// Pseudo terminal, with the end that keeps it open.
    #[cfg(unix)]
    Terminal(Option<TTYPort>, TTYPort),
}

/// Sender that is there.
pub(super) struct Sender {
    line: SenderLine,
    waiting: Vec<u8>,
}

enum SenderLine {
    Tcp(TcpStream),
    #[cfg(unix)]
    Terminal(TTYPort),
}

impl SenderDoor {
    /// Listens at `address`, on this computer.
    ///
    /// # Errors
    /// Refused: an address that others reach. Failed: it cannot be listened at.
    pub(super) fn listen(address: &str) -> Result<Self, CliError> {
        let failed = |error: io::Error| CliError::Failed(format!("tcp:{address}: {error}"));
        let mut found = address.to_socket_addrs().map_err(failed)?;
        if found.any(|each| !each.ip().to_canonical().is_loopback()) {
            return Err(CliError::Refused(format!(
                "tcp:{address} can be reached from other computers, and senders of G-code know no key: listen at \
                 tcp:127.0.0.1:PORT, and bring it elsewhere by a tunnel such as `ssh -L`"
            )));
        }
        let listener = TcpListener::bind(address).map_err(failed)?;
        listener.set_nonblocking(true).map_err(failed)?;
        Ok(Self::Tcp(listener))
    }

    /// Makes a pseudo terminal.
    ///
    /// # Errors
    /// Failed: the system has none left.
    #[cfg(unix)]
    pub(super) fn terminal() -> Result<Self, CliError> {
        let failed =
            |error: serialport::Error| CliError::Failed(format!("no pseudo terminal: {error}"));
        let (mut near, far) = TTYPort::pair().map_err(failed)?;
        near.set_timeout(std::time::Duration::from_millis(1))
            .map_err(failed)?;
        Ok(Self::Terminal(Some(near), far))
    }

    /// Name by which a sender finds it.
    pub(super) fn name(&self) -> String {
        match self {
            Self::Tcp(listener) => match listener.local_addr() {
                Ok(address) => format!("tcp:{address}"),
                Err(error) => format!("tcp: {error}"),
            },
            #[cfg(unix)]
            Self::Terminal(_, far) => far.name().unwrap_or_default(),
        }
    }

    /// Sender that has come. A second one is turned away while `is_taken`.
    ///
    /// # Errors
    /// The port is lost.
    pub(super) fn next(&mut self, is_taken: bool) -> io::Result<Option<Sender>> {
        let line = match self {
            Self::Tcp(listener) => match listener.accept() {
                Ok((mut stream, _)) if is_taken => {
                    // It may be gone already.
                    let _ = stream.write_all(b"[MSG:another sender is connected]\r\n");
                    None
                }
                Ok((stream, _)) => {
                    stream.set_nonblocking(true)?;
                    stream.set_nodelay(true)?;
                    Some(SenderLine::Tcp(stream))
                }
                Err(error) if error.kind() == ErrorKind::WouldBlock => None,
                Err(error) => return Err(error),
            },
            #[cfg(unix)]
            Self::Terminal(near, _) => near.take().map(SenderLine::Terminal),
        };
        Ok(line.map(|line| Sender {
            line,
            waiting: Vec::new(),
        }))
    }
}

impl Sender {
    /// Bytes that have come, a bounded number at a time. Never waits long.
    ///
    /// # Errors
    /// The sender is gone, and all that it has sent is read.
    pub(super) fn receive(&mut self) -> io::Result<Vec<u8>> {
        let mut bytes = [0; CHUNK];
        let read = match &mut self.line {
            SenderLine::Tcp(stream) => match stream.read(&mut bytes) {
                Ok(0) => return Err(ErrorKind::ConnectionReset.into()),
                read => read,
            },
            #[cfg(unix)]
            SenderLine::Terminal(port) => match port.bytes_to_read() {
                Ok(0) => Ok(0),
                Ok(_) => port.read(&mut bytes),
                Err(error) => Err(error.into()),
            },
        };
        match read {
            Ok(length) => Ok(bytes[..length].to_vec()),
            Err(error) if is_passing(&error) => Ok(Vec::new()),
            Err(error) => Err(error),
        }
    }

    /// Sends what goes without waiting, behind what waits.
    ///
    /// # Errors
    /// The sender is gone, or does not read.
    pub(super) fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.waiting.extend_from_slice(bytes);
        while !self.waiting.is_empty() {
            let written = match &mut self.line {
                SenderLine::Tcp(stream) => stream.write(&self.waiting),
                #[cfg(unix)]
                SenderLine::Terminal(port) => port.write(&self.waiting),
            };
            match written {
                Ok(length) => drop(self.waiting.drain(..length)),
                Err(error) if is_passing(&error) => break,
                Err(error) => return Err(error),
            }
        }
        match self.waiting.len() > MOST_WAITING {
            true => Err(io::Error::other("the sender does not read")),
            false => Ok(()),
        }
    }
}

fn is_passing(error: &io::Error) -> bool {
    matches!(
        error.kind(),
        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
    )
}
