//! Addresses at which a server listens, and who may reach them.

use crate::failure::CliError;
use crate::terminal::say;
use clap::Args;
use std::net::{SocketAddr, ToSocketAddrs};
use std::path::{Path, PathBuf};
use trirrr_line::{Listener, SharedKey, listening};

/// Ports for a client and for watchers.
#[derive(Args, Clone, Debug)]
pub struct ListenArgs {
    /// Address to listen at: tcp:HOST:PORT; port 0 takes one that is free and prints it
    #[arg(long, value_name = "ADDRESS", default_value = "tcp:127.0.0.1:7333", value_parser = listening)]
    pub listen: String,
    /// Address for watchers, who get every frame that the machine sends and can send nothing [default: none]
    #[arg(long, value_name = "ADDRESS", value_parser = listening)]
    pub watch: Option<String>,
    /// Key file that clients and watchers need, too: 64 hexadecimal digits, as `trirrr key FILE` writes them
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
    /// Allow addresses that other computers reach; needs --key
    #[arg(long)]
    pub beyond_loopback: bool,
}

/// Open ports of a server.
pub(crate) struct Doors {
    /// Port for the client.
    pub(super) listen: Listener,
    /// Port for watchers.
    pub(super) watch: Option<Listener>,
    /// Words about both, a line each.
    lines: Vec<String>,
}

impl Doors {
    /// Returns the address of the port for the client.
    pub(crate) fn address(&self) -> SocketAddr {
        self.listen.address()
    }

    /// Returns what a user should know about the ports.
    pub(crate) fn lines(&self) -> &[String] {
        &self.lines
    }
}

impl ListenArgs {
    /// Opens the ports.
    ///
    /// # Errors
    /// Refused: an address that other computers reach, without leave or key; the key file. Failed: an address that cannot be listened at.
    pub(crate) fn open(&self) -> Result<Doors, CliError> {
        let key = self.key.as_deref().map(read_key).transpose()?;
        let mut lines = Vec::new();
        // Nothing is opened before all is allowed.
        for address in [Some(&self.listen), self.watch.as_ref()]
            .into_iter()
            .flatten()
        {
            if self.may_listen(address, key.is_some())? {
                lines.push(format!(
                    "tcp:{address} can be reached from other computers: who has the key gets in, nobody else"
                ));
            }
        }
        let open = |address: &String| -> Result<Listener, CliError> {
            let listener = Listener::bind(address)
                .map_err(|error| CliError::Failed(format!("tcp:{address}: {error}")))?;
            Ok(listener.with_key(key.clone()))
        };
        let listen = open(&self.listen)?;
        let watch = self.watch.as_ref().map(open).transpose()?;
        if let Some(watch) = &watch {
            lines.push(format!("tcp:{} takes watchers", watch.address()));
        }
        if let Some(file) = &self.key {
            let file = file.display();
            lines.push(format!("clients and watchers need the key of {file}"));
        }
        Ok(Doors {
            listen,
            watch,
            lines,
        })
    }

    /// Returns true if other computers reach `address`, which is allowed then.
    fn may_listen(&self, address: &str, has_key: bool) -> Result<bool, CliError> {
        let found = address
            .to_socket_addrs()
            .map_err(|error| CliError::Failed(format!("tcp:{address}: {error}")))?;
        let is_open = found
            .into_iter()
            .any(|address| !address.ip().to_canonical().is_loopback());
        let wanting = match (is_open, self.beyond_loopback, has_key) {
            (false, ..) | (true, true, true) => return Ok(is_open),
            (true, false, true) => "give --beyond-loopback, too",
            (true, true, false) => {
                "give a key with --key FILE, too; `trirrr key FILE` writes a new one, and each client needs a copy"
            }
            (true, false, false) => {
                "give --beyond-loopback and a key with --key FILE, too; `trirrr key FILE` writes a new one, and each \
                 client needs a copy"
            }
        };
        Err(CliError::Refused(format!(
            "tcp:{address} can be reached from other computers, and whoever reaches it could move the machine: listen at \
             tcp:127.0.0.1:PORT, which only this computer reaches, or {wanting}"
        )))
    }
}

/// Reads the key in `file`. Warns if others can read it, too.
///
/// # Errors
/// Refused: there is no such file, or no key in it. In `trirrr-full`: a key at all.
pub(crate) fn read_key(file: &Path) -> Result<SharedKey, CliError> {
    #[cfg(not(feature = "full"))]
    if file.exists() {
        return Err(CliError::InFull("--key"));
    }
    let key = SharedKey::read(file).map_err(|error| CliError::Refused(error.to_string()))?;
    if SharedKey::is_open_to_others(file) {
        let file = file.display();
        say(&format!(
            "{file}: other users of this computer can read this key; `chmod 600 {file}` keeps it from them"
        ));
    }
    Ok(key)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(address: &str, beyond_loopback: bool, has_key: bool) -> Result<bool, String> {
        let args = ListenArgs {
            listen: address.into(),
            watch: None,
            key: None,
            beyond_loopback,
        };
        let may = args.may_listen(address, has_key);
        may.map_err(|error| error.to_string())
    }

    #[test]
    fn beyond_loopback_needs_leave_and_a_key() {
        for inside in [
            "127.0.0.1:0",
            "127.9.9.9:0",
            "[::1]:0",
            "localhost:0",
            "[::ffff:127.0.0.1]:0",
        ] {
            assert_eq!(asked(inside, false, false), Ok(false), "{inside}");
        }
        for outside in [
            "0.0.0.0:7333",
            "[::]:7333",
            "192.168.1.2:0",
            "[::ffff:10.0.0.1]:0",
        ] {
            for (beyond, key, word) in [
                (false, false, "--beyond-loopback and a key with --key FILE"),
                (false, true, "or give --beyond-loopback"),
                (true, false, "or give a key with --key FILE"),
            ] {
                let error = asked(outside, beyond, key).unwrap_err();
                for part in [&format!("tcp:{outside}"), "from other computers", word] {
                    assert!(error.contains(part), "{part} in {error}");
                }
            }
            assert_eq!(asked(outside, true, true), Ok(true), "{outside}");
        }
    }
}
