//! The client of a device: its link, what it says, what waits to be sent to it.

use std::collections::VecDeque;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use trirrr_client::transport::{Frames, TcpLink};
use trirrr_protocol::message::{Message, Reply, Request, Transmit};
use trirrr_protocol::wire::FrameError;

/// Bytes that may wait for a client. Beyond this it gets no samples, and its requests wait on the line: who does not read is not
/// heard, and takes no more memory.
const WAITING: usize = 1 << 16;

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// A client that is connected.
pub(super) struct Client {
    link: TcpLink,
    from: SocketAddr,
    frames: Frames,
    waiting: VecDeque<u8>,
    frame: Vec<u8>,
    /// Samples that were dropped because the client does not read.
    dropped: u32,
    heard: Instant,
    /// A request was executed.
    is_known: bool,
}

impl Client {
    pub(super) fn new(link: TcpLink, from: SocketAddr) -> Self {
        Self {
            link,
            from,
            frames: Frames::default(),
            waiting: VecDeque::new(),
            frame: Vec::new(),
            dropped: 0,
            heard: Instant::now(),
            is_known: false,
        }
    }

    /// Takes note of a request that was executed: the client is one of this machine.
    pub(super) fn is_heard(&mut self) {
        self.is_known = true;
        self.heard = Instant::now();
    }

    /// Returns true if the client has had a request executed within the last `time`.
    pub(super) fn is_heard_within(&self, time: Duration) -> bool {
        self.heard.elapsed() <= time
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
    pub(super) fn requests<N: Transmit>(&mut self) -> io::Result<Vec<Request<N>>> {
        let mut requests = Vec::new();
        if self.waiting.len() > WAITING {
            return Ok(requests);
        }
        let mut bytes = [0; CHUNK];
        let length = self.link.receive_now(&mut bytes)?;
        self.frames
            .receive(&bytes[..length], |request| requests.push(request));
        if !self.is_known && self.damaged() > 0 {
            // A browser that was sent here by some page, or a tool of another protocol: not even its valid frames count.
            let reason = "it does not speak the protocol of docs/wire.md";
            return Err(io::Error::new(io::ErrorKind::InvalidData, reason));
        }
        Ok(requests)
    }

    /// Puts `message` behind what waits.
    pub(super) fn put<N: Transmit>(&mut self, mut message: Message<N>) {
        let is_sample = matches!(message, Message::Telemetry(_) | Message::Drives(_));
        if is_sample && self.waiting.len() > WAITING {
            self.dropped = self.dropped.wrapping_add(1);
            return;
        }
        // Samples that were lost here are lost as those that were lost in the machine.
        match &mut message {
            Message::Telemetry(sample) => sample.lost = sample.lost.wrapping_add(self.dropped),
            Message::Reply {
                reply: Reply::Status(status),
                ..
            } => status.lost = status.lost.wrapping_add(self.dropped),
            _ => {}
        }
        self.frame.clear();
        Frames::append(&message, &mut self.frame);
        self.waiting.extend(&self.frame);
    }

    /// Sends what goes without waiting.
    ///
    /// # Errors
    /// It is gone.
    pub(super) fn flush(&mut self) -> io::Result<()> {
        while !self.waiting.is_empty() {
            let sent = self.link.send_now(self.waiting.as_slices().0)?;
            if sent == 0 {
                break;
            }
            self.waiting.drain(..sent);
        }
        Ok(())
    }
}
