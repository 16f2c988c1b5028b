//! Port to a machine: opened, and opened anew when it is lost.

use crate::{
    Address, Frames, KeyRefusal, Line, Link, LostLine, OpenError, OtherClient, Reopening, is_answer,
};
use crate::{SharedKey, open_link};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};
use trirrr_protocol::message::{Message, Request, Transmit};

/// From one attempt to open a port to the next.
const ATTEMPTS_EVERY: Duration = Duration::from_millis(100);

/// Wait while the port is opened anew, before its owner is heard.
const IDLE: Duration = Duration::from_millis(1);

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// Attempts to open a lost port anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Retry {
    /// None.
    Never,
    /// Until the board was not heard for this time.
    For(Duration),
    /// Always, once the board has answered.
    Always,
}

/// Port to a machine.
pub struct Port {
    address: Address,
    baud: u32,
    key: Option<SharedKey>,
    retry: Retry,
    link: Option<Box<dyn Link>>,
    frames: Frames,
    bytes: Vec<u8>,
    begun: Instant,
    /// Time of the last answer of the board, hellos apart.
    heard: Instant,
    /// The board was heard since the port was opened, or ever.
    answered: bool,
    is_known: bool,
    opened_anew: u64,
    damaged: u64,
    /// The far end expects a key: to open the port anew does not help.
    refused: Option<KeyRefusal>,
    /// Reason for which the port is opened anew, and the attempt under way.
    lost: Option<String>,
    opening: Option<JoinHandle<Result<Box<dyn Link>, OpenError>>>,
}

impl Port {
    /// Creates a port that its owner opens.
    pub fn new(address: Address, baud: u32, key: Option<SharedKey>, retry: Retry) -> Self {
        Self {
            address,
            baud,
            key,
            retry,
            link: None,
            frames: Frames::default(),
            bytes: Vec::new(),
            begun: Instant::now(),
            heard: Instant::now(),
            answered: false,
            is_known: false,
            opened_anew: 0,
            damaged: 0,
            refused: None,
            lost: None,
            opening: None,
        }
    }

    /// Opens the port.
    ///
    /// # Errors
    /// The port cannot be opened.
    pub fn opened(mut self) -> Result<Self, OpenError> {
        self.link = Some(open_link(&self.address, self.baud, self.key.as_ref())?);
        Ok(self)
    }

    /// Sets the attempts to open a lost port anew.
    #[must_use]
    pub fn retrying(self, retry: Retry) -> Self {
        Self { retry, ..self }
    }

    /// Returns the number of times that the port was opened again.
    pub fn opened_anew(&self) -> u64 {
        self.opened_anew
    }

    /// Returns the number of frames that were damaged or cut off.
    pub fn damaged(&self) -> u64 {
        self.damaged + u64::from(self.frames.counters().errors())
    }

    /// Begins an attempt to open the port, in the background: it may take long.
    fn begin_opening(&mut self, pause: Duration) {
        let (address, baud, key) = (self.address.clone(), self.baud, self.key.clone());
        self.opening = Some(std::thread::spawn(move || {
            std::thread::sleep(pause);
            let mut link = open_link(&address, baud, key.as_ref())?;
            // A zero ends what the line held. A link that is lost at once is opened anew.
            let _ = link.send(&[0]);
            Ok(link)
        }));
    }

    /// Drops the link, which is lost for the reason `why`: a port opens once only. Returns false if no attempt follows.
    fn lose(&mut self, why: &LostLine) -> bool {
        self.damaged = self.damaged();
        self.frames = Frames::default();
        let was_open = self.link.take().is_some();
        let lost = match why {
            LostLine::Broken(error) if self.retry == Retry::Never && !OtherClient::is_in(error) => {
                format!("the port is lost: {error}")
            }
            why if self.retry == Retry::Never => why.to_string(),
            why if !self.answered && why.to_string().contains("closed") => format!(
                "{}: {why} before it answered: it may have another client",
                self.address
            ),
            why => format!("{}: {why}", self.address),
        };
        (self.answered, self.lost) = (false, Some(lost));
        if self.retry == Retry::Never || (self.refused.is_some() && !self.comes_back()) {
            return false;
        }
        // The far end that closed the line gets a pause.
        self.begin_opening(match was_open {
            true => ATTEMPTS_EVERY,
            false => Duration::ZERO,
        });
        true
    }

    /// Returns true if the board is waited for, whatever is at its port.
    fn comes_back(&self) -> bool {
        self.retry == Retry::Always && self.is_known
    }

    fn given_up(&mut self) -> Reopening {
        self.opening = None;
        Reopening::GivenUp(LostLine::NotOpen(self.lost.take().unwrap_or_default()))
    }
}

impl<N: Transmit> Line<N> for Port {
    fn now(&self) -> Duration {
        self.begun.elapsed()
    }

    fn send(&mut self, request: &Request<N>) -> Result<(), LostLine> {
        let link = self.link.as_mut().ok_or(LostLine::Silent)?;
        self.bytes.clear();
        Frames::append(request, &mut self.bytes);
        Ok(link.send(&self.bytes)?)
    }

    /// Waits a millisecond at least: a wait of nothing would make a caller's loop spin.
    fn receive(&mut self, timeout: Duration) -> Result<Vec<Message<N>>, LostLine> {
        let link = self.link.as_mut().ok_or(LostLine::Silent)?;
        let mut bytes = [0; CHUNK];
        let received = link.receive(&mut bytes, timeout.max(IDLE));
        let length = received.inspect_err(|error| self.refused = KeyRefusal::of(error))?;
        let mut messages = Vec::new();
        self.frames
            .receive(&bytes[..length], |message| messages.push(message));
        if messages.iter().any(is_answer) {
            self.heard = Instant::now();
        }
        self.answered |= !messages.is_empty();
        self.is_known |= self.answered;
        Ok(messages)
    }

    fn reopen(&mut self, why: &LostLine, is_stopped: bool) -> Reopening {
        if self.lost.is_none() && !self.lose(why) {
            return self.given_up();
        }
        let silent = self.heard.elapsed();
        if let Retry::For(patience) = self.retry
            && (is_stopped || silent >= patience)
        {
            let (why, seconds) = (self.lost.take(), silent.as_secs_f64());
            let why = why.unwrap_or_default();
            self.lost = Some(format!("{why}; nothing was heard for {seconds:.1} s"));
            return self.given_up();
        }
        let Some(opening) = self.opening.take_if(|opening| opening.is_finished()) else {
            std::thread::sleep(IDLE);
            return Reopening::Pending;
        };
        // A panic there is a bug and goes on here.
        let opened = opening.join();
        match opened.unwrap_or_else(|panic| std::panic::resume_unwind(panic)) {
            Ok(link) => {
                (self.link, self.lost) = (Some(link), None);
                self.opened_anew += 1;
                Reopening::Open
            }
            Err(error) => {
                self.lost = Some(error.to_string());
                if !error.may_pass() && !self.comes_back() {
                    return self.given_up();
                }
                self.begin_opening(ATTEMPTS_EVERY);
                Reopening::Failed(LostLine::NotOpen(error.to_string()))
            }
        }
    }

    fn is_open(&self) -> bool {
        self.link.is_some()
    }
}
