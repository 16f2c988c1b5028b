//! Lines of machines: to a board over a port, and to a machine that this program simulates.

use std::collections::VecDeque;
use std::io;
use std::time::{Duration, Instant};
use trirrr_client::local::LocalService;
use trirrr_line::{Address, Frames, Link, OpenError, SharedKey, open_link};
use trirrr_protocol::message::{Message, Request, Transmit};
use trirrr_service::{InterlockReadings, ServiceNumber};

/// Bytes taken from a port at a time.
const CHUNK: usize = 1 << 14;

/// Slices of work below the tick between two looks at a simulated machine.
const SLICES: u32 = 256;

/// Wait while a simulated machine has work below the tick.
const SOON: Duration = Duration::from_millis(1);

/// Delay beyond which a simulated machine gives its schedule up: this computer is too slow for it.
const BEHIND: Duration = Duration::from_secs(1);

/// Line of a machine.
pub(crate) trait MachineLine<N: Transmit> {
    /// Opens the line, anew where it was open.
    ///
    /// # Errors
    /// The reason, and true if a later attempt may succeed.
    fn open(&mut self) -> Result<(), (String, bool)>;

    /// Sends a request.
    ///
    /// # Errors
    /// The line is lost.
    fn send(&mut self, request: &Request<N>) -> io::Result<()>;

    /// Waits up to `timeout`, and hands what the machine has sent to `take`.
    ///
    /// # Errors
    /// The line is lost.
    fn receive(&mut self, timeout: Duration, take: &mut dyn FnMut(Message<N>)) -> io::Result<()>;
}

/// Line over a port.
pub(crate) struct BoardLine {
    address: Address,
    baud: u32,
    key: Option<SharedKey>,
    link: Option<Box<dyn Link>>,
    frames: Frames,
    frame: Vec<u8>,
}

impl BoardLine {
    pub(crate) fn new(address: Address, baud: u32, key: Option<SharedKey>) -> Self {
        Self {
            address,
            baud,
            key,
            link: None,
            frames: Frames::default(),
            frame: Vec::new(),
        }
    }

    fn link(&mut self) -> io::Result<&mut Box<dyn Link>> {
        self.link
            .as_mut()
            .ok_or_else(|| io::ErrorKind::NotConnected.into())
    }
}

impl<N: Transmit> MachineLine<N> for BoardLine {
    fn open(&mut self) -> Result<(), (String, bool)> {
        // The port is given back first: it opens once only.
        self.link = None;
        let opened = open_link(&self.address, self.baud, self.key.as_ref());
        let told = |error: OpenError| (error.to_string(), error.may_pass());
        let mut link = opened.map_err(told)?;
        // A zero ends what the line held.
        link.send(&[0])
            .map_err(|error| (format!("{}: {error}", self.address), true))?;
        self.frames = Frames::default();
        self.link = Some(link);
        Ok(())
    }

    fn send(&mut self, request: &Request<N>) -> io::Result<()> {
        let mut frame = std::mem::take(&mut self.frame);
        frame.clear();
        Frames::append(request, &mut frame);
        let sent = self.link()?.send(&frame);
        self.frame = frame;
        sent
    }

    fn receive(&mut self, timeout: Duration, take: &mut dyn FnMut(Message<N>)) -> io::Result<()> {
        let mut bytes = [0; CHUNK];
        let length = self.link()?.receive(&mut bytes, timeout)?;
        self.frames.receive(&bytes[..length], take);
        Ok(())
    }
}

/// Line to a machine that is simulated in this thread, in real time. The machine computes the ticks that are due each time when it is listened to.
pub(crate) struct SimulatedLine<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    rate_hz: f64,
    /// Time of tick 0.
    start: Instant,
    ticks: u64,
    /// Answers, and the tick behind which each goes: as on a line, none comes before the tick has heard of the request.
    answers: VecDeque<(u64, Message<N>)>,
    is_busy: bool,
}

impl<'a, N: ServiceNumber> SimulatedLine<'a, N> {
    /// The line to `machine`, which ticks `rate_hz` times a second.
    pub(crate) fn new(machine: &'a mut dyn LocalService<N>, rate_hz: f64) -> Self {
        Self {
            machine,
            rate_hz,
            start: Instant::now(),
            ticks: 0,
            answers: VecDeque::new(),
            is_busy: false,
        }
    }

    /// Number of ticks that are due. Where the computer is too slow the schedule begins anew, and the ticks that were left out never are.
    fn due(&mut self) -> u64 {
        let elapsed = self.start.elapsed();
        let scheduled = Duration::from_secs_f64(self.ticks as f64 / self.rate_hz);
        if elapsed > scheduled + BEHIND {
            self.start += elapsed - scheduled;
            self.machine.count_late();
            return self.ticks;
        }
        // From float to integer the cast saturates.
        (elapsed.as_secs_f64() * self.rate_hz) as u64 + 1
    }
}

impl<N: ServiceNumber> MachineLine<N> for SimulatedLine<'_, N> {
    fn open(&mut self) -> Result<(), (String, bool)> {
        Ok(())
    }

    fn send(&mut self, request: &Request<N>) -> io::Result<()> {
        let sequence = request.sequence;
        let reply = self.machine.receive(request);
        let mut answered = Some((sequence, reply));
        while let Some((sequence, reply)) = answered {
            let answer = Message::Reply { sequence, reply };
            self.answers.push_back((self.ticks, answer));
            answered = self.machine.receive_kept();
        }
        Ok(())
    }

    fn receive(&mut self, timeout: Duration, take: &mut dyn FnMut(Message<N>)) -> io::Result<()> {
        // An answer goes behind the next tick.
        let next = Duration::from_secs_f64(self.ticks as f64 / self.rate_hz);
        let next = next.saturating_sub(self.start.elapsed());
        std::thread::sleep(match (self.is_busy, self.answers.is_empty()) {
            (true, _) => timeout.min(SOON),
            (false, false) => timeout.min(next),
            (false, true) => timeout,
        });
        for _ in self.ticks..self.due() {
            let begin = Instant::now();
            // Nobody presses anything here.
            self.machine.sense(InterlockReadings::default());
            self.machine.tick();
            let took = u32::try_from(begin.elapsed().as_nanos());
            self.machine.report_timing(took.unwrap_or(u32::MAX));
            self.ticks += 1;
            self.is_busy = (0..SLICES).all(|_| self.machine.work());
            // After each tick: there is room for 63 samples.
            while let Some(message) = self.machine.outgoing() {
                take(message);
            }
        }
        let heard = |(tick, _): &(u64, _)| *tick < self.ticks;
        while self.answers.front().is_some_and(heard) {
            if let Some((_, answer)) = self.answers.pop_front() {
                take(answer);
            }
        }
        if self.is_busy {
            self.is_busy = (0..SLICES).all(|_| self.machine.work());
        }
        Ok(())
    }
}
