//! TCP port of a server: who comes, and who has the key.

use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use trirrr_line::{Listener, ServedLink};

/// Time in which somebody who comes has to show that he has the key, or a first request.
pub(super) const GREETING: Duration = Duration::from_secs(5);

/// Links in their handshake. One more takes the place of the oldest.
const PENDING: usize = 8;

/// Link in its handshake.
struct Pending {
    link: ServedLink,
    from: SocketAddr,
    since: Instant,
}

/// TCP port of a server.
pub(super) struct Door {
    listener: Listener,
    /// Word for who comes here.
    who: &'static str,
    pending: Vec<Pending>,
}

impl Door {
    pub(super) fn new(listener: Listener, who: &'static str) -> Self {
        Self {
            listener,
            who,
            pending: Vec::new(),
        }
    }

    /// Accepts a connection, if one has come, and goes on with the handshakes. Returns one that is through. Never waits, and does the work of
    /// one handshake at most.
    ///
    /// # Errors
    /// The port is lost.
    pub(super) fn next(
        &mut self,
        notes: &mut Vec<String>,
    ) -> io::Result<Option<(ServedLink, SocketAddr)>> {
        if let Some((link, from)) = self.listener.accept()? {
            if self.pending.len() >= PENDING {
                let oldest = self.pending.remove(0);
                notes.push(self.refused(oldest.from, "others came before it showed a key"));
            }
            self.pending.push(Pending {
                link,
                from,
                since: Instant::now(),
            });
        }
        let mut index = 0;
        while let Some(pending) = self.pending.get_mut(index) {
            let from = pending.from;
            match pending.link.is_through() {
                Ok(true) => return Ok(Some((self.pending.remove(index).link, from))),
                Ok(false) if pending.since.elapsed() < GREETING => {
                    index += 1;
                    continue;
                }
                Ok(false) => {
                    pending.link.ask_for_key();
                    notes.push(self.refused(from, "it showed no key"));
                }
                Err(error) => notes.push(self.refused(from, &error.to_string())),
            }
            self.pending.remove(index);
        }
        Ok(None)
    }

    fn refused(&self, from: SocketAddr, why: &str) -> String {
        format!("{} {from} is turned away: {why}", self.who)
    }
}
