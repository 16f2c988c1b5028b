//! Plays a job on a machine in the same program: its client, its background and its clock in one
//! thread.

use super::End;
use crate::histogram::Histogram;
use crate::pace::{Deadlines, Pacer};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::SyncSender;
use std::time::{Duration, Instant};
use trirrr_client::describe::{self, Units};
use trirrr_client::local::{self, LocalService};
use trirrr_client::records::is_of_a_job;
use trirrr_protocol::message::{
    Command, Message, Move, Refusal, Reply, Request, Status, Telemetry, Violation,
};
use trirrr_scene::Scene;
use trirrr_service::ServiceNumber;

/// A job on its way through a machine.
pub(super) struct Player<'a, N: ServiceNumber> {
    machine: &'a mut dyn LocalService<N>,
    units: Units,
    moves: Vec<Move<N>>,
    /// Moves that the machine has taken.
    offered: usize,
    sequence: u32,
}

/// What playing a job gives, besides the samples.
pub(super) struct Played {
    pub(super) end: End,
    pub(super) elapsed: Duration,
    pub(super) computation: Histogram,
    pub(super) deadlines: Option<Deadlines>,
}

/// Whether a job goes on.
enum After {
    Tick,
    End(End),
}

impl<'a, N: ServiceNumber> Player<'a, N> {
    /// Of `moves`, the job of a scene that `machine` was built from.
    pub(super) fn new(
        machine: &'a mut dyn LocalService<N>,
        moves: Vec<Move<N>>,
        units: Units,
    ) -> Self {
        Self {
            machine,
            units,
            moves,
            offered: 0,
            sequence: 0,
        }
    }

    /// Plays the job, each tick when it is due if `paced`, and sends the sample of each.
    pub(super) fn play(
        mut self,
        scene: &Scene,
        paced: bool,
        stop: &AtomicBool,
        samples: SyncSender<Telemetry<N>>,
    ) -> Played {
        let mut computation = Histogram::default();
        let prepared = self.prepare(scene);
        let start = Instant::now();
        let mut pacer = paced.then(|| Pacer::start(scene.tick_rate_hz));
        let end = match prepared {
            Err(why) => End::Refused(why),
            Ok(()) => (0..)
                .find_map(|tick| {
                    let go_on = match &mut pacer {
                        Some(pacer) => pacer.wait(tick, stop),
                        None => !stop.load(Ordering::Relaxed),
                    };
                    if !go_on {
                        return Some(End::Stopped);
                    }
                    let begin = Instant::now();
                    self.machine.tick();
                    computation.push(begin.elapsed());
                    if let Some(pacer) = &mut pacer {
                        pacer.done(tick);
                    }
                    match self.after_tick(&samples) {
                        After::Tick => None,
                        After::End(end) => Some(end),
                    }
                })
                .unwrap_or(End::Stopped),
        };
        if end == End::Complete && scene.plant.is_some() {
            self.stand(&samples);
        }
        Played {
            end,
            elapsed: start.elapsed(),
            computation,
            deadlines: pacer.map(Pacer::finish),
        }
    }

    /// Everything before the first tick of the job: moves as many as the machine takes, judged.
    ///
    /// # Errors
    /// Why the job cannot start, in words.
    fn prepare(&mut self, scene: &Scene) -> Result<(), String> {
        self.done(Command::Hello(local::hello::<N>(scene)))?;
        self.done(Command::Telemetry { every: 1 })?;
        // The machine takes one order per tick.
        self.machine.tick();
        self.feed()?;
        while self.machine.outgoing().is_some() {}
        self.done(Command::Start)
    }

    /// What there is to do between a tick and the next.
    fn after_tick(&mut self, samples: &SyncSender<Telemetry<N>>) -> After {
        while let Some(message) = self.machine.outgoing() {
            let Message::Telemetry(sample) = message else {
                continue;
            };
            if !is_of_a_job(sample.state) {
                continue;
            }
            let is_last = self.is_last(&sample);
            // The recorder has gone: it says why when it is joined.
            if samples.send(sample).is_err() {
                return After::End(End::Stopped);
            }
            if is_last {
                return After::End(End::Complete);
            }
        }
        // Also so that the machine does not take its host for lost.
        match self.status() {
            Some(Status {
                fault: Some(fault), ..
            }) => return After::End(End::Fault(describe::fault(&fault, &self.units))),
            Some(_) => {}
            None => return After::End(End::Stopped),
        }
        match self.feed() {
            Ok(()) => After::Tick,
            Err(why) => After::End(End::Refused(why)),
        }
    }

    /// Sends the sample of the tick after the job, in which the machine stands: its plant goes on.
    fn stand(&mut self, samples: &SyncSender<Telemetry<N>>) {
        self.machine.tick();
        while let Some(message) = self.machine.outgoing() {
            if let Message::Telemetry(sample) = message {
                // The recorder has gone: it says why when it is joined.
                let _ = samples.send(sample);
            }
        }
    }

    /// Whether the sample is the last of the job: at the end of its last move.
    fn is_last(&self, sample: &Telemetry<N>) -> bool {
        self.moves.last().is_some_and(|last| {
            sample.number == last.number && sample.at == last.ticks && sample.part == 0
        })
    }

    /// Offers moves as long as there is room for them and has all of them judged.
    ///
    /// # Errors
    /// Why a move is refused, in words.
    fn feed(&mut self) -> Result<(), String> {
        while let Some(next) = self.moves.get(self.offered).copied() {
            match self.ask(Command::Move(next)) {
                Reply::Refused(Refusal::QueueFull) => break,
                Reply::Refused(refusal) => {
                    let why = describe::refusal(&refusal, next.ticks, &self.units);
                    return Err(format!("move {} is refused: {why}", next.number + 1));
                }
                _ => self.offered += 1,
            }
        }
        while self.machine.work() {}
        let refused = self.status().and_then(|status| status.refused);
        match refused.and_then(|verdict| Some((verdict.number, verdict.violation?))) {
            Some((number, violation)) => Err(self.inadmissible(number, &violation)),
            None => Ok(()),
        }
    }

    fn inadmissible(&self, number: u32, violation: &Violation<N>) -> String {
        let about = self.moves.get(number as usize);
        let ticks = about.map_or(0, |about| about.ticks);
        let why = describe::violation(violation, ticks, &self.units);
        format!("move {} is not admitted: {why}", number + 1)
    }

    fn status(&mut self) -> Option<Status<N>> {
        match self.ask(Command::Status) {
            Reply::Status(status) => Some(status),
            _ => None,
        }
    }

    /// Asks for something that has to be done.
    ///
    /// # Errors
    /// Why it is not, in words.
    fn done(&mut self, command: Command<N>) -> Result<(), String> {
        match self.ask(command) {
            Reply::Refused(refusal) => Err(describe::refusal(&refusal, 0, &self.units)),
            _ => Ok(()),
        }
    }

    fn ask(&mut self, command: Command<N>) -> Reply<N> {
        let request = Request {
            sequence: self.sequence,
            command,
        };
        if !matches!(command, Command::Hello(_)) {
            self.sequence = self.sequence.wrapping_add(1);
        }
        self.machine.receive(&request)
    }
}
