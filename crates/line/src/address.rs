//! Address of a board, as the command line has it.

use std::fmt;
use std::str::FromStr;

/// Prefix of a TCP address.
const TCP: &str = "tcp:";

/// Far end of a link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Address {
    /// TCP port, `HOST:PORT`.
    Tcp(String),
    /// Serial port, by the name that the system gives it.
    Serial(String),
}

impl FromStr for Address {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        match text.strip_prefix(TCP) {
            Some(address) => tcp_address(address).map(Self::Tcp),
            None if text.is_empty() => Err("a port is /dev/tty... or tcp:HOST:PORT".into()),
            None => Ok(Self::Serial(text.into())),
        }
    }
}

/// Checks `HOST:PORT` as far as it can be without asking a name server.
fn tcp_address(address: &str) -> Result<String, String> {
    let (host, port) = address
        .rsplit_once(':')
        .ok_or("expected tcp:HOST:PORT, the second colon is missing")?;
    if host.is_empty() {
        return Err("expected tcp:HOST:PORT, the host is missing".into());
    }
    match port.parse::<u16>() {
        Ok(_) => Ok(address.into()),
        Err(_) => Err(format!(
            "expected tcp:HOST:PORT, {port:?} is no port from 0 to 65535"
        )),
    }
}

/// Reads the address at which a device listens: TCP only.
///
/// # Errors
/// Part of the address that is wrong.
pub fn listening(text: &str) -> Result<String, String> {
    match text.parse()? {
        Address::Tcp(address) => Ok(address),
        Address::Serial(_) => Err("a device listens at tcp:HOST:PORT; \
            tcp:127.0.0.1:0 takes any port that is free and prints it"
            .into()),
    }
}

impl fmt::Display for Address {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Tcp(address) => write!(f, "{TCP}{address}"),
            Self::Serial(path) => f.write_str(path),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn addresses_are_read_and_written_alike() {
        for (text, expected) in [
            ("tcp:localhost:7333", Address::Tcp("localhost:7333".into())),
            ("tcp:[::1]:0", Address::Tcp("[::1]:0".into())),
            ("/dev/ttyACM0", Address::Serial("/dev/ttyACM0".into())),
            ("COM3", Address::Serial("COM3".into())),
        ] {
            let address: Address = text.parse().unwrap();
            assert_eq!(address, expected);
            assert_eq!(address.to_string(), text);
        }
    }

    #[test]
    fn what_is_wrong_with_an_address_is_said() {
        for (text, reason) in [
            ("tcp:localhost", "second colon is missing"),
            ("tcp::7333", "host is missing"),
            ("tcp:localhost:http", "\"http\" is no port"),
            ("tcp:localhost:65536", "\"65536\" is no port"),
            ("", "/dev/tty"),
        ] {
            let error = text.parse::<Address>().unwrap_err();
            assert!(error.contains(reason), "{text}: {error}");
        }
        assert_eq!(listening("tcp:127.0.0.1:0").unwrap(), "127.0.0.1:0");
        assert!(listening("/dev/ttyUSB0").is_err());
    }
}
