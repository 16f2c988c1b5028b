//! The client of a server: its link, what it says, what waits to be sent to it.

use super::door::GREETING;
use serde::de::DeserializeOwned;
use std::collections::VecDeque;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use trirrr_line::{Frames, ServedLink};
use trirrr_protocol::wire::FrameError;

/// Bytes that may wait for a client. Beyond this it gets no samples, and its requests wait on the line: who does not read is not
/// heard, and takes no more memory.
pub(super) const WAITING: usize = 1 << 16;

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// Bytes that a client may send before one of its requests is executed: more than hellos and a window of requests have.
const UNKNOWN: usize = 1 << 14;

/// Hellos that a client may say before another request of it is executed.
const HELLOS: u32 = 8;

/// A client that is connected.
pub(super) struct Client {
    link: ServedLink,
    from: SocketAddr,
    frames: Frames,
    waiting: VecDeque<u8>,
    /// Samples that were dropped because the client does not read.
    dropped: u32,
    heard: Instant,
    /// A valid request has come. Who has said nothing gets nothing: it may be no client.
    speaks: bool,
    /// A request that was no hello was executed: the client knows the machine's numbers.
    is_known: bool,
    /// Bytes and hellos of a client that is not known.
    bytes: usize,
    hellos: u32,
}

impl Client {
    pub(super) fn new(link: ServedLink, from: SocketAddr) -> Self {
        Self {
            link,
            from,
            frames: Frames::default(),
            waiting: VecDeque::new(),
            dropped: 0,
            heard: Instant::now(),
            speaks: false,
            is_known: false,
            bytes: 0,
            hellos: 0,
        }
    }

    /// Takes note of a request that was not refused.
    pub(super) fn is_heard(&mut self) {
        self.heard = Instant::now();
    }

    /// Takes note of a request that was executed and no hello: the client is one of this machine.
    pub(super) fn is_executed(&mut self) {
        self.is_known = true;
    }

    /// Returns true if the machine has executed a request of the client.
    pub(super) fn is_known(&self) -> bool {
        self.is_known
    }

    /// Counts a hello. Returns false beyond the limit.
    pub(super) fn may_greet(&mut self) -> bool {
        self.hellos += u32::from(!self.is_known);
        self.hellos <= HELLOS
    }

    /// Returns true if the client keeps its place: it had a request answered within the last `silence`. Who is not known keeps it for
    /// some seconds at most.
    pub(super) fn keeps_its_place(&self, silence: Duration) -> bool {
        let limit = match self.is_known {
            true => silence,
            false => silence.min(GREETING),
        };
        self.heard.elapsed() <= limit
    }

    /// Address of the client.
    pub(super) fn from(&self) -> SocketAddr {
        self.from
    }

    /// Telemetry samples that were dropped because the client does not read.
    pub(super) fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Frames that were damaged.
    pub(super) fn damaged(&self) -> u32 {
        let counters = self.frames.counters();
        // Two zeros in a row are no damage: a client may begin with one.
        counters.errors() - counters.of(FrameError::Empty)
    }

    /// Takes the requests that have come, without waiting.
    ///
    /// # Errors
    /// It is gone.
    pub(super) fn requests<R: DeserializeOwned>(&mut self) -> io::Result<Vec<R>> {
        let mut requests = Vec::new();
        if self.waiting.len() > WAITING {
            return Ok(requests);
        }
        let mut bytes = [0; CHUNK];
        let length = self.link.receive_now(&mut bytes)?;
        self.frames
            .receive(&bytes[..length], |request| requests.push(request));
        self.speaks |= !requests.is_empty();
        if !self.is_known {
            self.bytes += length;
            if self.damaged() > 0 || self.bytes > UNKNOWN {
                // A browser that was sent here by some page, or a tool of another protocol: not even its valid frames count.
                let reason = "it does not speak the protocol of docs/wire.md";
                return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
            }
        }
        Ok(requests)
    }

    /// Puts `frame` behind what waits. A sample is dropped where too much waits.
    pub(super) fn put(&mut self, frame: &[u8], is_sample: bool) {
        if !self.speaks {
            return;
        }
        if is_sample && self.waiting.len() > WAITING {
            self.dropped = self.dropped.wrapping_add(1);
            return;
        }
        self.waiting.extend(frame);
    }

    /// Sends what goes without waiting.
    ///
    /// # Errors
    /// It is gone.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        flush(&mut self.link, &mut self.waiting).map(|_| ())
    }
}

/// Sends of `waiting` what goes without waiting. Returns the number of bytes.
///
/// # Errors
/// The far end is gone.
pub(super) fn flush(link: &mut ServedLink, waiting: &mut VecDeque<u8>) -> io::Result<usize> {
    let mut total = 0;
    link.flush_now()?;
    while !waiting.is_empty() {
        let sent = link.send_now(waiting.as_slices().0)?;
        if sent == 0 {
            break;
        }
        waiting.drain(..sent);
        total += sent;
    }
    Ok(total)
}
