//! Opening of links by their address.

use crate::sealed::{PlainLink, SealedLink};
use crate::{Address, KeyRefusal, Link, SharedKey, serial, tcp};
use std::io;

/// Suggestion for a name that looks like an address of TCP; empty for others.
fn tcp_hint(address: &Address) -> String {
    let Address::Serial(name) = address else {
        return String::new();
    };
    match format!("tcp:{name}").parse::<Address>() {
        Ok(meant) => format!("; did you mean {meant}?"),
        Err(_) => String::new(),
    }
}

/// Reason why a link cannot be opened.
#[derive(Debug, thiserror::Error)]
pub enum OpenError {
    /// The serial port does not exist: the cable is out, or the name is wrong.
    #[error("{0}: no such port{hint}", hint = tcp_hint(.0))]
    Missing(Address),
    /// Another program has the port.
    #[error("{0}: busy, another program has it open")]
    Busy(Address),
    /// The user may not open it.
    #[error("{0}: not allowed to open it; on Linux, the user has to be in the group of the port")]
    Forbidden(Address),
    /// No program listens at that address.
    #[error("{0}: nothing listens there; `trirrr device` does, or an emulated board")]
    Refused(Address),
    /// The far end and this one do not have the same key.
    #[error("{address}: {refusal}")]
    Key {
        /// Address of the link.
        address: Address,
        /// Reason.
        refusal: KeyRefusal,
    },
    /// The far end has closed the link before it answered the handshake.
    #[error("{0}: closed before it answered: it may have another client")]
    Closed(Address),
    /// A serial port has no key.
    #[error("{0}: a serial port has no key; leave the key out")]
    KeyOnSerial(Address),
    /// Another error, in the words of the system.
    #[error("{address}: cannot be opened: {reason}")]
    Other {
        /// Address of the link.
        address: Address,
        /// Reason, in the words of the system.
        reason: String,
    },
}

impl OpenError {
    /// Returns true if a later attempt may succeed with the same request: after a cable was put in again,
    /// or a device started again.
    pub fn may_pass(&self) -> bool {
        match self {
            Self::Missing(_)
            | Self::Busy(_)
            | Self::Refused(_)
            | Self::Closed(_)
            | Self::Other { .. } => true,
            Self::Forbidden(_) | Self::Key { .. } | Self::KeyOnSerial(_) => false,
        }
    }
}

/// Opens the link to `address`; `baud` is the rate of a serial port.
///
/// # Errors
/// [`OpenError`].
pub fn open(address: &Address, baud: u32) -> Result<Box<dyn Link>, OpenError> {
    match address {
        Address::Tcp(host_and_port) => tcp::connect(host_and_port)
            .map(|link| Box::new(PlainLink::new(link)) as Box<dyn Link>)
            .map_err(|error| classify_tcp(address, &error)),
        Address::Serial(path) => serial::open(path, baud)
            .map(|link| Box::new(link) as Box<dyn Link>)
            .map_err(|error| classify_serial(address, &error)),
    }
}

/// Opens the link to `address`, whose far end has the same `key`. Waits some seconds at most for its answer.
///
/// # Errors
/// [`OpenError`].
pub fn open_keyed(
    address: &Address,
    baud: u32,
    key: &SharedKey,
) -> Result<Box<dyn Link>, OpenError> {
    let Address::Tcp(host_and_port) = address else {
        // A port that cannot be opened at all is the greater error.
        open(address, baud)?;
        return Err(OpenError::KeyOnSerial(address.clone()));
    };
    let link = tcp::connect(host_and_port).map_err(|error| classify_tcp(address, &error))?;
    match SealedLink::greet(link, key) {
        Ok(link) => Ok(Box::new(link)),
        Err(error) => Err(classify_greeting(address, &error)),
    }
}

/// Opens the link to `address`, with `key` where there is one.
///
/// # Errors
/// [`OpenError`].
pub fn open_link(
    address: &Address,
    baud: u32,
    key: Option<&SharedKey>,
) -> Result<Box<dyn Link>, OpenError> {
    match key {
        Some(key) => open_keyed(address, baud, key),
        None => open(address, baud),
    }
}

/// Opens the link to a port for watchers at `address`, who send nothing else.
///
/// # Errors
/// [`OpenError`].
pub fn open_watched(
    address: &Address,
    key: Option<&SharedKey>,
) -> Result<Box<dyn Link>, OpenError> {
    match key {
        Some(key) => open_keyed(address, 0, key),
        None => {
            let mut link = open(address, 0)?;
            // A port that expects a key says so to who begins without one. A link that is lost shows when it is read.
            let _ = link.send(&[0; 2]);
            Ok(link)
        }
    }
}

fn classify_greeting(address: &Address, error: &io::Error) -> OpenError {
    let address = address.clone();
    match (KeyRefusal::of(error), error.kind()) {
        (Some(refusal), _) => OpenError::Key { address, refusal },
        (None, io::ErrorKind::UnexpectedEof) => OpenError::Closed(address),
        (None, _) => OpenError::Other {
            address,
            reason: error.to_string(),
        },
    }
}

fn classify_tcp(address: &Address, error: &io::Error) -> OpenError {
    match error.kind() {
        io::ErrorKind::ConnectionRefused => OpenError::Refused(address.clone()),
        _ => OpenError::Other {
            address: address.clone(),
            reason: error.to_string(),
        },
    }
}

fn classify_serial(address: &Address, error: &serialport::Error) -> OpenError {
    use serialport::ErrorKind;
    let address = address.clone();
    match error.kind {
        ErrorKind::Io(io::ErrorKind::NotFound) => OpenError::Missing(address),
        ErrorKind::Io(io::ErrorKind::PermissionDenied) => OpenError::Forbidden(address),
        // A port that is locked; one that is not there has a kind of its own.
        ErrorKind::NoDevice => OpenError::Busy(address),
        _ => OpenError::Other {
            address,
            reason: error.description.clone(),
        },
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Listener;
    use std::time::Duration;

    fn refusal(address: &str) -> OpenError {
        match open(&address.parse().unwrap(), 115_200) {
            Ok(_) => panic!("{address} was opened"),
            Err(error) => error,
        }
    }

    #[test]
    fn why_a_port_cannot_be_opened_is_said_by_name() {
        let missing = refusal("/dev/tty-that-is-not-there");
        assert!(matches!(missing, OpenError::Missing(_)), "{missing:?}");
        assert_eq!(
            missing.to_string(),
            "/dev/tty-that-is-not-there: no such port"
        );
        assert_eq!(
            refusal("127.0.0.1:7333").to_string(),
            "127.0.0.1:7333: no such port; did you mean tcp:127.0.0.1:7333?"
        );
        // A port that was free a moment ago, and that nothing listens at.
        let port = Listener::bind("127.0.0.1:0").unwrap().address();
        let refused = refusal(&format!("tcp:{port}"));
        assert!(matches!(refused, OpenError::Refused(_)), "{refused:?}");
        let unknown = refusal("tcp:no-such-host.invalid:1");
        assert!(matches!(unknown, OpenError::Other { .. }), "{unknown:?}");
        assert!(unknown.to_string().contains("no-such-host.invalid:1"));
    }

    #[cfg(unix)]
    #[test]
    fn a_serial_port_is_opened_once() {
        use serialport::SerialPort;
        // A pseudo-terminal: its far end is a serial port like any other.
        let (mut near, far) = serialport::TTYPort::pair().unwrap();
        let name = far.name().unwrap();
        drop(far);
        let mut link = open(&name.parse().unwrap(), 115_200).unwrap();
        let busy = refusal(&name);
        assert!(matches!(busy, OpenError::Busy(_)), "{busy:?}");

        link.send(b"to the board").unwrap();
        let mut buffer = [0; 64];
        let length = io::Read::read(&mut near, &mut buffer).unwrap();
        assert_eq!(&buffer[..length], b"to the board");
        io::Write::write_all(&mut near, b"\x00\r\n\x11\xff").unwrap();
        let length = link.receive(&mut buffer, Duration::from_secs(10)).unwrap();
        assert_eq!(&buffer[..length], b"\x00\r\n\x11\xff", "untouched");
        assert_eq!(link.receive(&mut buffer, Duration::ZERO).unwrap(), 0);
        drop(near);
        assert!(link.receive(&mut buffer, Duration::from_secs(10)).is_err());
    }
}
