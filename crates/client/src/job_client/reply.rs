//! Effect of the other answers: executed, or refused and why.

use super::JobClient;
use super::phase::Phase;
use crate::JobFailure;
use std::time::Duration;
use trirrr_protocol::message::{Command, Identity, Refusal, State, Transmit};

impl<N: Transmit> JobClient<N> {
    pub(super) fn on_hello(&mut self, identity: Identity) {
        self.schedule.adapt_to(&identity);
        self.identity = Some(identity);
        self.phase = match self.status {
            None => Phase::Meeting,
            Some(_) => Phase::Surveying,
        };
    }

    /// The machine has executed `command`.
    pub(super) fn on_done(&mut self, command: &Command<N>, now: Duration) {
        match command {
            Command::Telemetry { .. } if self.drives.is_some() => self.phase = Phase::Sampling,
            Command::Telemetry { .. } | Command::Drives { .. } => self.begin(),
            Command::Enable => {
                (self.approach.enabled, self.approach.is_enabling) = (true, true);
                self.phase = Phase::Awaiting;
                self.schedule.look_at(now);
            }
            Command::Home | Command::Recover(_) => {
                self.approach.recovery_s = None;
                self.phase = Phase::Awaiting;
                self.schedule.look_at(now);
            }
            Command::ClearFault => {
                self.approach.acknowledged = true;
                self.phase = Phase::Surveying;
            }
            Command::Move(_) | Command::Quintic(_) | Command::Path(_) => {
                if let Some(status) = &mut self.status {
                    match command {
                        Command::Path(_) => status.piece = status.piece.wrapping_add(1),
                        _ => status.next = status.next.wrapping_add(1),
                    }
                }
                // The verdict on the last move takes a moment.
                if self.progress.count_offered() {
                    self.schedule.look_at(now);
                }
            }
            Command::Start => {
                if let Some(status) = &mut self.status {
                    status.state = State::Running;
                }
            }
            Command::Stop | Command::Disable => match &self.phase {
                Phase::Ending(failure) => self.phase = Phase::Finished(Err(*failure)),
                _ => {
                    self.user.has_stopped = true;
                    self.schedule.look_at(now);
                }
            },
            _ => {}
        }
    }

    /// The machine is set up: it goes to the start of the job, or begins.
    fn begin(&mut self) {
        self.phase = self.beside().map_or(Phase::Streaming, Phase::Recovering);
    }

    /// The machine has refused `command`.
    pub(super) fn on_refusal(&mut self, command: &Command<N>, refusal: Refusal<N>, now: Duration) {
        match (command, refusal) {
            (Command::Hello(_), refusal) => {
                self.phase = Phase::Finished(Err(JobFailure::Refused {
                    index: None,
                    refusal,
                }));
            }
            // The machine was switched off and on, or another client came between.
            (_, Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused) => {
                self.phase = match self.phase {
                    Phase::Ending(failure) => Phase::Finished(Err(failure)),
                    _ => Phase::Greeting,
                };
            }
            (Command::Path(_), Refusal::QueueFull) => {
                self.progress.is_full();
                self.schedule.wait(now);
            }
            // Not now: the status will say when.
            (_, Refusal::Busy)
            | (Command::Move(_) | Command::Quintic(_), Refusal::QueueFull)
            | (Command::Start, Refusal::Undecided | Refusal::NothingQueued | Refusal::EndsMoving) => {
                self.schedule.wait(now)
            }
            // The machine counts its moves in another way: the status says how.
            (
                Command::Move(_) | Command::Quintic(_) | Command::Path(_),
                Refusal::MoveNumber { .. },
            ) => self.phase = Phase::Surveying,
            // Its image tells nothing of its drives: the job goes without.
            (Command::Drives { .. }, Refusal::NoFeedback) => self.begin(),
            // Another client has enabled the machine.
            (Command::Enable, Refusal::State(_)) => self.phase = Phase::Surveying,
            // The user's command came too late or too early, which does no harm.
            (Command::Hold | Command::Resume, _) => {}
            (_, refusal) => match self.phase {
                Phase::Ending(failure) => self.phase = Phase::Finished(Err(failure)),
                _ => {
                    let offered = self.progress.offered();
                    let is_offer =
                        command.offered().is_some() || matches!(command, Command::Path(_));
                    let index = is_offer.then_some(offered);
                    self.enter(Phase::Ending(JobFailure::Refused { index, refusal }));
                }
            },
        }
    }
}
