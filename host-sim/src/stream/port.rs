//! The port to the board: opened, and opened anew when it is lost.

use super::PortArgs;
use crate::failure::CliError;
use crate::serve::read_key;
use std::io;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use trirrr_line::{Address, Frames, KeyRefusal, Link, OpenError, SharedKey, open_link};
use trirrr_protocol::message::{Message, Reply, Request, Transmit};

/// From one attempt to open a port to the next.
const ATTEMPTS_EVERY: Duration = Duration::from_millis(100);

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// A port that is put up with for a while.
pub(crate) struct Port {
    address: Address,
    baud: u32,
    key: Option<SharedKey>,
    patience: Duration,
    link: Box<dyn Link>,
    frames: Frames,
    bytes: Vec<u8>,
    /// Time of the last answer of the board, hellos apart.
    heard: Instant,
    /// The board was heard since the port was opened.
    answered: bool,
    opened_anew: u64,
    damaged: u64,
    /// The far end expects a key: to open the port anew does not help.
    refused: Option<KeyRefusal>,
    /// Reason for which the port was opened anew last, while nothing was heard since.
    told: Option<String>,
}

impl Port {
    /// Opens the port of `line`. Without a sign of the board for `patience` it is given up.
    ///
    /// # Errors
    /// Refused: the key file. Failed: the port cannot be opened.
    pub(crate) fn open(line: &PortArgs, patience: Duration) -> Result<Self, CliError> {
        let key = line.key.as_deref().map(read_key).transpose()?;
        let link = open_link(&line.port, line.baud, key.as_ref());
        Ok(Self {
            address: line.port.clone(),
            baud: line.baud,
            key,
            patience,
            link: link.map_err(|error| CliError::Failed(error.to_string()))?,
            frames: Frames::default(),
            bytes: Vec::new(),
            heard: Instant::now(),
            answered: false,
            opened_anew: 0,
            damaged: 0,
            refused: None,
            told: None,
        })
    }

    /// Number of times that the port was opened again.
    pub(crate) fn opened_anew(&self) -> u64 {
        self.opened_anew
    }

    /// Frames that were damaged or cut off.
    pub(crate) fn damaged(&self) -> u64 {
        self.damaged + u64::from(self.frames.counters().errors())
    }

    /// Sends a request.
    ///
    /// # Errors
    /// The link is gone.
    pub(crate) fn send<N: Transmit>(&mut self, request: &Request<N>) -> io::Result<()> {
        self.bytes.clear();
        Frames::append(request, &mut self.bytes);
        self.link.send(&self.bytes)
    }

    /// Waits up to `timeout`, and a millisecond at least, for something to come. Returns it.
    ///
    /// # Errors
    /// The link is gone.
    pub(crate) fn receive<N: Transmit>(
        &mut self,
        timeout: Duration,
    ) -> io::Result<Vec<Message<N>>> {
        // A wait of nothing would make a caller's loop spin; what comes ends any wait.
        let timeout = timeout.max(Duration::from_millis(1));
        let mut bytes = [0; CHUNK];
        let received = self.link.receive(&mut bytes, timeout);
        let length = received.inspect_err(|error| self.refused = KeyRefusal::of(error))?;
        let mut messages = Vec::new();
        self.frames
            .receive(&bytes[..length], |message| messages.push(message));
        // A board that says hello and then nothing is as good as silent.
        let is_answer = |message: &Message<N>| match message {
            Message::Reply { reply, .. } => !matches!(reply, Reply::Hello(_)),
            _ => false,
        };
        if messages.iter().any(is_answer) {
            self.heard = Instant::now();
            self.told = None;
        }
        self.answered |= !messages.is_empty();
        Ok(messages)
    }

    /// Returns the words for a user before the port is opened anew because of `why`, once for each reason.
    pub(crate) fn reopening(&mut self, why: &str) -> Option<String> {
        let is_told = self.told.as_deref() == Some(why);
        self.told = Some(why.into());
        (!is_told).then(|| format!("{why}; opening the port anew"))
    }

    /// Opens the port anew, trying until the board was not heard for as long as the patience
    /// lasts, or `stop` is raised. `why`: what was wrong with it.
    ///
    /// # Errors
    /// What is wrong with it, in words.
    pub(crate) fn reopen(&mut self, why: &str, stop: &AtomicBool) -> Result<(), String> {
        self.forget_frames();
        let mut why = match self.answered {
            false if why.contains("closed") => format!(
                "{}: {why} before it answered: it may have another client",
                self.address
            ),
            _ => format!("{}: {why}", self.address),
        };
        self.answered = false;
        if self.refused.is_some() {
            return Err(why);
        }
        loop {
            let silent = self.heard.elapsed();
            if silent >= self.patience || stop.load(Ordering::Relaxed) {
                let seconds = silent.as_secs_f64();
                return Err(format!("{why}; nothing was heard for {seconds:.1} s"));
            }
            // Also before the first attempt: who closed the line does not want to be called at
            // once.
            std::thread::sleep(ATTEMPTS_EVERY.min(self.patience - silent));
            match open_link(&self.address, self.baud, self.key.as_ref()) {
                Ok(link) => {
                    self.take(link);
                    return Ok(());
                }
                Err(error) if error.may_pass() => why = error.to_string(),
                Err(error) => return Err(error.to_string()),
            }
        }
    }

    /// Opens the port anew in the background: one attempt.
    pub(crate) fn open_anew(&self) -> JoinHandle<Result<Box<dyn Link>, OpenError>> {
        let (address, baud, key) = (self.address.clone(), self.baud, self.key.clone());
        std::thread::spawn(move || {
            // Who closed the line does not want to be called at once.
            std::thread::sleep(ATTEMPTS_EVERY);
            open_link(&address, baud, key.as_ref())
        })
    }

    /// Takes a link that was opened anew.
    pub(crate) fn take(&mut self, link: Box<dyn Link>) {
        self.forget_frames();
        self.link = link;
        self.opened_anew += 1;
    }

    fn forget_frames(&mut self) {
        self.damaged += u64::from(self.frames.counters().errors());
        self.frames = Frames::default();
    }
}
