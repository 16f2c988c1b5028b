//! Line to a machine that this program simulates.

use std::collections::VecDeque;
use std::time::{Duration, Instant};
use trirrr_client::local::LocalService;
use trirrr_line::{Line, LostLine, Reopening};
use trirrr_protocol::message::{Message, Request};
use trirrr_service::ServiceNumber;
use trirrr_service::board::InterlockReadings;

/// Slices of work below the tick between two looks at a simulated machine.
const SLICES: u32 = 256;

/// Wait while a simulated machine has work below the tick.
const SOON: Duration = Duration::from_millis(1);

/// Delay beyond which a simulated machine gives its schedule up: this computer is too slow for it.
const BEHIND: Duration = Duration::from_secs(1);

/// Line to a machine that is simulated in this thread, in real time. The machine computes the ticks that are due each time when it is listened to.
pub(crate) struct SimulatedLine<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    rate_hz: f64,
    begun: Instant,
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
            begun: Instant::now(),
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

impl<N: ServiceNumber> Line<N> for SimulatedLine<'_, N> {
    fn now(&self) -> Duration {
        self.begun.elapsed()
    }

    fn send(&mut self, request: &Request<N>) -> Result<(), LostLine> {
        let sequence = request.sequence;
        let reply = self.machine.answer(request);
        let mut answered = Some((sequence, reply));
        while let Some((sequence, reply)) = answered {
            let answer = Message::Reply { sequence, reply };
            self.answers.push_back((self.ticks, answer));
            answered = self.machine.answer_kept();
        }
        Ok(())
    }

    fn receive(&mut self, timeout: Duration) -> Result<Vec<Message<N>>, LostLine> {
        // An answer goes behind the next tick.
        let next = Duration::from_secs_f64(self.ticks as f64 / self.rate_hz);
        let next = next.saturating_sub(self.start.elapsed());
        std::thread::sleep(match (self.is_busy, self.answers.is_empty()) {
            (true, _) => timeout.min(SOON),
            (false, false) => timeout.min(next),
            (false, true) => timeout,
        });
        let mut messages = Vec::new();
        for _ in self.ticks..self.due() {
            let begin = Instant::now();
            // Nobody presses anything here.
            self.machine.sense(InterlockReadings::default());
            self.machine.tick();
            let took = u32::try_from(begin.elapsed().as_nanos());
            self.machine.report_timing(took.unwrap_or(u32::MAX));
            self.ticks += 1;
            self.is_busy = (0..SLICES).all(|_| self.machine.step());
            // After each tick: there is room for 63 samples.
            messages.extend(std::iter::from_fn(|| self.machine.outgoing()));
        }
        let heard = |(tick, _): &(u64, _)| *tick < self.ticks;
        while self.answers.front().is_some_and(heard) {
            if let Some((_, answer)) = self.answers.pop_front() {
                messages.push(answer);
            }
        }
        if self.is_busy {
            self.is_busy = (0..SLICES).all(|_| self.machine.step());
        }
        Ok(messages)
    }

    /// A machine of this program has no line to lose.
    fn reopen(&mut self, _: &LostLine, _: bool) -> Reopening {
        Reopening::Open
    }
}
