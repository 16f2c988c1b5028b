//! Watchers: they get every frame that the machine sends, and can send nothing.

use super::client::{WAITING, flush};
use super::door::Door;
use super::{FrameKind, notes};
use std::collections::VecDeque;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use trirrr_line::{Listener, ServedLink};

/// Most watchers at a time.
const MOST: usize = 16;

/// Time without a byte read after which a watcher for whom something waits has to go.
const STUCK: Duration = Duration::from_secs(30);

/// A watcher that is connected.
struct Watcher {
    link: ServedLink,
    from: SocketAddr,
    waiting: VecDeque<u8>,
    /// Frames that were dropped because the watcher does not read.
    dropped: u64,
    /// Time at which it has last read, or had nothing to read.
    read: Instant,
}

impl Watcher {
    fn put(&mut self, frame: &[u8]) {
        match self.waiting.len() + frame.len() > WAITING {
            true => self.dropped += 1,
            false => self.waiting.extend(frame),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        if flush(&mut self.link, &mut self.waiting)? > 0 || self.waiting.is_empty() {
            self.read = Instant::now();
        }
        match self.read.elapsed() > STUCK {
            true => Err(io::Error::new(io::ErrorKind::TimedOut, "it does not read")),
            false => Ok(()),
        }
    }

    /// Looks whether it is still there.
    fn listen(&mut self) -> io::Result<()> {
        let mut bytes = [0; 64];
        let length = self.link.receive_now(&mut bytes)?;
        // Zeros end frames: alone they say nothing, but to a port that expects a key.
        match bytes[..length].iter().all(|byte| *byte == 0) {
            true => Ok(()),
            false => {
                let reason = "a watcher sends nothing, and it did";
                Err(io::Error::new(io::ErrorKind::InvalidData, reason))
            }
        }
    }

    fn gone(&self, error: &io::Error) -> String {
        let dropped = notes::counted(self.dropped, "frames dropped, for it did not read");
        format!("watcher {} is gone: {error}{dropped}", self.from)
    }
}

/// Port for watchers, and those who have come.
pub(super) struct Watchers {
    door: Door,
    all: Vec<Watcher>,
    /// The watcher that is listened to next: one at a time, so that many cost no more than one.
    next: usize,
    /// Frames of the last identity and the last state, for a watcher that comes later.
    identity: Vec<u8>,
    state: Vec<u8>,
}

impl Watchers {
    pub(super) fn new(listener: Listener) -> Self {
        Self {
            door: Door::new(listener, "watcher"),
            all: Vec::new(),
            next: 0,
            identity: Vec::new(),
            state: Vec::new(),
        }
    }

    /// Lets a watcher in, if one has come.
    ///
    /// # Errors
    /// The port is lost.
    pub(super) fn accept(&mut self, notes: &mut Vec<String>) -> io::Result<()> {
        let Some((link, from)) = self.door.next(notes)? else {
            return Ok(());
        };
        if self.all.len() >= MOST {
            let why = format!("{MOST} others watch");
            notes.push(format!("watcher {from} is turned away: {why}"));
            return Ok(());
        }
        notes.push(format!("watcher {from} is connected"));
        let mut watcher = Watcher {
            link,
            from,
            waiting: VecDeque::new(),
            dropped: 0,
            read: Instant::now(),
        };
        watcher.put(&self.identity);
        watcher.put(&self.state);
        self.all.push(watcher);
        Ok(())
    }

    /// Puts `frame` behind what waits for each watcher that has room for it.
    pub(super) fn put(&mut self, frame: &[u8], kind: FrameKind) {
        let kept = match kind {
            FrameKind::Identity => Some(&mut self.identity),
            FrameKind::State => Some(&mut self.state),
            FrameKind::Sample | FrameKind::Other => None,
        };
        if let Some(kept) = kept {
            kept.clear();
            kept.extend_from_slice(frame);
        }
        for watcher in &mut self.all {
            watcher.put(frame);
        }
    }

    /// Sends what goes without waiting, and looks after one of them.
    pub(super) fn flush(&mut self, notes: &mut Vec<String>) {
        self.next = (self.next + 1) % self.all.len().max(1);
        let mut index = 0;
        let next = self.next;
        self.all.retain_mut(|watcher| {
            let listens = index == next;
            index += 1;
            let done = match (watcher.flush(), listens) {
                (Ok(()), true) => watcher.listen(),
                (done, _) => done,
            };
            match done {
                Ok(()) => true,
                Err(error) => {
                    notes.push(watcher.gone(&error));
                    false
                }
            }
        });
    }
}
