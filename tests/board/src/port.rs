//! The line to the board: whole frames in, bytes out.

use anyhow::{Context, Result, bail};
use serde::Serialize;
use std::time::{Duration, Instant};
use trirrr_line::{Address, Frames, Link};
use trirrr_protocol::message::{Command, Message, Reply, Request, Transmit};

/// From one attempt to be heard to the next.
const ATTEMPTS_EVERY: Duration = Duration::from_millis(200);

/// Longest wait for an answer.
const ANSWER: Duration = Duration::from_millis(500);

/// An open line.
pub(crate) struct Port {
    address: Address,
    baud: u32,
    patience: Duration,
    link: Box<dyn Link>,
    /// Bytes behind the last zero.
    rest: Vec<u8>,
}

impl Port {
    /// Opens the line. Whatever is wrong with it may pass within `patience`, for a board that
    /// starts.
    pub(crate) fn open(address: &Address, baud: u32, patience: Duration) -> Result<Self> {
        let start = Instant::now();
        let link = loop {
            match trirrr_line::open(address, baud) {
                Ok(link) => break link,
                Err(error) if error.may_pass() && start.elapsed() < patience => {
                    std::thread::sleep(ATTEMPTS_EVERY);
                }
                Err(error) => return Err(error.into()),
            }
        };
        Ok(Self {
            address: address.clone(),
            baud,
            patience,
            link,
            rest: Vec::new(),
        })
    }

    /// Closes the line and opens it again.
    pub(crate) fn reopen(self) -> Result<Self> {
        let Self {
            address,
            baud,
            patience,
            link,
            ..
        } = self;
        drop(link);
        Self::open(&address, baud, patience)
    }

    /// Asks for the status, before any hello, until the board answers that it wants one: it has
    /// started, and what it sends from now on is whole.
    pub(crate) fn wait_for_board<N: Transmit>(&mut self) -> Result<()> {
        let start = Instant::now();
        let request = Request::<N> {
            sequence: u32::MAX,
            command: Command::Status,
        };
        let mut frame = vec![0];
        Frames::append(&request, &mut frame);
        while start.elapsed() < self.patience {
            self.send(&frame)?;
            let asked = Instant::now();
            while asked.elapsed() < ATTEMPTS_EVERY {
                for bytes in self.frames(Duration::from_millis(20))? {
                    if let Some(Message::<N>::Reply { .. }) = message(&bytes) {
                        return Ok(());
                    }
                }
            }
        }
        bail!(
            "{}: the board does not answer within {} s",
            self.address,
            self.patience.as_secs_f64()
        )
    }

    /// Sends a request and waits for its answer, half a second; none if it does not come.
    pub(crate) fn ask<N: Transmit>(
        &mut self,
        sequence: u32,
        command: Command<N>,
    ) -> Result<Option<Reply<N>>> {
        let mut bytes = vec![0];
        Frames::append(&Request { sequence, command }, &mut bytes);
        self.send(&bytes)?;
        let asked = Instant::now();
        while asked.elapsed() < ANSWER {
            for frame in self.frames(Duration::from_millis(20))? {
                match message::<N>(&frame) {
                    Some(Message::Reply {
                        sequence: to,
                        reply,
                    }) if to == sequence => return Ok(Some(reply)),
                    _ => {}
                }
            }
        }
        Ok(None)
    }

    /// Sends bytes.
    pub(crate) fn send(&mut self, bytes: &[u8]) -> Result<()> {
        self.link
            .send(bytes)
            .with_context(|| format!("{}: sending", self.address))
    }

    /// Waits up to `timeout` for bytes; the frames that are whole by then, each with its zero.
    pub(crate) fn frames(&mut self, timeout: Duration) -> Result<Vec<Vec<u8>>> {
        let mut bytes = [0; 4096];
        let length = self
            .link
            .receive(&mut bytes, timeout)
            .with_context(|| format!("{}: receiving", self.address))?;
        let mut frames = Vec::new();
        for &byte in &bytes[..length] {
            self.rest.push(byte);
            if byte == 0 {
                frames.push(std::mem::take(&mut self.rest));
            }
        }
        Ok(frames)
    }
}

/// The message in a frame; none where the frame is damaged.
pub(crate) fn message<N: Transmit>(frame: &[u8]) -> Option<Message<N>> {
    let mut found = None;
    Frames::default().receive(frame, |message| found = Some(message));
    found
}

/// The frame of a message or request.
pub(crate) fn frame<T: Serialize>(message: &T) -> Vec<u8> {
    let mut bytes = Vec::new();
    Frames::append(message, &mut bytes);
    bytes
}
