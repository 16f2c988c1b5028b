//! The client of a device: its link, what it says, what waits to be sent to it.

use std::collections::VecDeque;
use std::io;
use std::net::SocketAddr;
use std::time::{Duration, Instant};
use trirrr_client::transport::{Frames, TcpLink};
use trirrr_protocol::message::{Message, Request, Transmit};

/// Bytes that may wait for a client. Beyond this it gets no telemetry; what a client asked for
/// waits in any case.
const WAITING: usize = 1 << 20;

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// A client that is connected.
pub(super) struct Client {
    link: TcpLink,
    from: SocketAddr,
    frames: Frames,
    waiting: VecDeque<u8>,
    frame: Vec<u8>,
    dropped: u64,
    heard: Instant,
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
        }
    }

    /// Returns true if the client has sent a byte within the last `time`.
    pub(super) fn is_heard_within(&self, time: Duration) -> bool {
        self.heard.elapsed() <= time
    }

    /// Address of the client.
    pub(super) fn from(&self) -> SocketAddr {
        self.from
    }

    /// Telemetry samples that were dropped because the client does not read.
    pub(super) fn dropped(&self) -> u64 {
        self.dropped
    }

    /// Frames that were damaged.
    pub(super) fn damaged(&self) -> u32 {
        self.frames.counters().errors()
    }

    /// Takes the requests that have come, without waiting.
    ///
    /// # Errors
    /// It is gone.
    pub(super) fn requests<N: Transmit>(&mut self) -> io::Result<Vec<Request<N>>> {
        let mut requests = Vec::new();
        let mut bytes = [0; CHUNK];
        let length = self.link.receive_now(&mut bytes)?;
        if length > 0 {
            self.heard = Instant::now();
        }
        self.frames
            .receive(&bytes[..length], |request| requests.push(request));
        Ok(requests)
    }

    /// Puts `message` behind what waits.
    pub(super) fn put<N: Transmit>(&mut self, message: &Message<N>) {
        if matches!(message, Message::Telemetry(_)) && self.waiting.len() > WAITING {
            self.dropped += 1;
            return;
        }
        self.frame.clear();
        Frames::append(message, &mut self.frame);
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
