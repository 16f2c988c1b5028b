//! Effect of the other answers: executed, or refused and why.

use super::JobClient;
use super::phase::Phase;
use crate::JobFailure;
use std::time::Duration;
use trirrr_protocol::message::scene::Section;
use trirrr_protocol::message::{Acting, Command, Identity, Refusal, State, Transmit};

impl<N: Transmit> JobClient<N> {
    pub(super) fn on_hello(&mut self, identity: Identity) {
        self.last_taken = None;
        self.schedule.adapt_to(&identity);
        self.progress.set_batch(identity.batch);
        self.progress.set_level_room(identity.levels);
        self.identity = Some(identity);
        self.phase = match self.status {
            None if self.tools.is_some() && self.approach.attachment.is_none() => Phase::Checking,
            None => Phase::Meeting,
            Some(_) => Phase::Surveying,
        };
    }

    /// The machine has told a part of its scene: the platform that was asked for.
    pub(super) fn on_section(&mut self, section: &Section) {
        if let (Phase::Checking, Section::Platform(platform), Some(tools)) =
            (&self.phase, section, &self.tools)
        {
            let found = tools.found(platform);
            self.phase = match found == Some(tools.wanted()) {
                true => Phase::Meeting,
                false => Phase::Finished(Err(JobFailure::OtherTool(found))),
            };
        }
    }

    /// The machine has executed `command`.
    pub(super) fn on_done(&mut self, command: &Command<N>, now: Duration) {
        match command {
            Command::Telemetry { .. } if self.drives.is_some() => self.phase = Phase::Sampling,
            Command::Telemetry { .. } | Command::Drives { .. } => self.begin(),
            Command::Enable | Command::Home | Command::Recover(_) => {
                self.approach.wake.ordered(command);
                match command {
                    Command::Enable => self.approach.is_enabling = true,
                    _ => self.approach.recovery_s = None,
                }
                self.phase = Phase::Awaiting;
                self.schedule.look_at(now);
            }
            Command::ClearFault => {
                self.approach.wake.ordered(command);
                self.phase = Phase::Surveying;
            }
            Command::Move(way) if self.phase == Phase::Waking(*command) => {
                self.approach.way = Some(*way);
                self.phase = Phase::Underway;
                self.schedule.look_at(now);
            }
            Command::Start if self.phase == Phase::Waking(Command::Start) => {
                self.phase = Phase::Underway;
                self.schedule.look_at(now);
            }
            Command::Levels(_) => {
                self.progress.confirm_levels();
                if self.progress.waits() && !self.offers() {
                    self.schedule.look_at(now);
                }
            }
            Command::OutputsAt(_) if self.progress.waits() && !self.offers() => {
                self.schedule.look_at(now);
            }
            Command::Move(_)
            | Command::Quintic(_)
            | Command::Moves(_)
            | Command::Listed(_)
            | Command::Path(_) => {
                self.progress.count_taken(command);
                if let Some(status) = &mut self.status {
                    match command.offered() {
                        Some(moves) => status.next = moves.next(),
                        None => status.piece = status.piece.wrapping_add(1),
                    }
                }
                // The verdict on the last move takes a moment.
                if self.progress.waits() && !self.offers() {
                    self.schedule.look_at(now);
                }
            }
            // It waits for its host no more, which a status may not know yet.
            Command::Hold => {
                if let Some(status) = &mut self.status
                    && status.acting == Acting::Silence
                {
                    status.acting = Acting::Hold;
                }
                self.schedule.look_at(now);
            }
            Command::Resume => {
                if let Some(status) = &mut self.status {
                    status.acting = Acting::Resume;
                }
                // The tick has to take it before a status knows of it.
                self.schedule.wait(now);
            }
            Command::Job(_) => {
                self.is_named = true;
                self.phase = Phase::Streaming;
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
        self.phase = match self.beside() {
            Some(recovery) => Phase::Waking(Command::Recover(recovery)),
            None if self.progress.has_taken() == 0 => Phase::Naming,
            None => Phase::Streaming,
        };
    }

    /// The machine has refused `command`.
    pub(super) fn on_refusal(&mut self, command: &Command<N>, refusal: Refusal<N>, now: Duration) {
        let is_of_job =
            command.brings_moves() || matches!(command, Command::Path(_) | Command::Start);
        if self.phase == Phase::Streaming
            && is_of_job
            && self.schedule.refused(now) > self.exchange.patience().total()
        {
            // Whatever the machine waits for does not come.
            return self.end_refused(command, refusal);
        }
        match (command, refusal) {
            (Command::Hello(_), refusal) => {
                self.phase = Phase::Finished(Err(JobFailure::Refused {
                    index: None,
                    refusal,
                }));
            }
            // The machine was switched off and on, or another client came between.
            (_, Refusal::HelloFirst | Refusal::Sequence { .. } | Refusal::SequenceReused) => {
                self.user.commands.recall();
                self.phase = match self.phase {
                    Phase::Ending(failure) => Phase::Finished(Err(failure)),
                    _ => Phase::Greeting,
                };
            }
            // Not now: the status will say when.
            (_, Refusal::Busy) => {
                self.user.commands.recall();
                self.schedule.wait(now);
            }
            (Command::Start, Refusal::Undecided | Refusal::NothingQueued | Refusal::EndsMoving) => {
                self.schedule.wait(now)
            }
            // Another client has moved it meanwhile.
            (Command::Move(_), Refusal::MoveNumber { .. } | Refusal::StartPose)
                if self.phase == Phase::Waking(*command) =>
            {
                self.phase = Phase::Surveying;
            }
            (_, Refusal::QueueFull) => {
                self.progress.is_full();
                self.schedule.wait(now);
            }
            // No room yet: what is behind the piece was not taken either.
            (Command::Levels(piece), Refusal::LevelsFull) => {
                self.progress.go_back_to_level(piece.first);
                self.progress.is_full();
                self.schedule.wait(now);
            }
            // The machine counts its levels in another way, or has not taken some: it says where to go on.
            (Command::Levels(_) | Command::Listed(_), Refusal::LevelNumber { expected }) => {
                self.progress.go_back_to_level(expected);
                self.progress.is_full();
                self.schedule.look_at(now);
            }
            // The machine has not taken one before: the status says from where to go on.
            (Command::OutputsAt(_), Refusal::MoveNumber { .. } | Refusal::OutputsFull) => {
                self.progress.is_full();
                self.schedule.look_at(now);
            }
            (Command::OutputsAt(_), Refusal::State(_)) if self.progress.has_taken() > 0 => {
                self.progress.is_full();
                self.schedule.wait(now);
            }
            (_, Refusal::MoveNumber { .. }) if command.offered().is_some() => {
                self.progress.is_full();
                self.schedule.look_at(now);
            }
            // The machine counts its pieces in another way: the status says how.
            (Command::Path(_), Refusal::MoveNumber { .. }) => self.phase = Phase::Surveying,
            // It stops meanwhile: the status says why.
            (_, Refusal::State(_))
                if command.offered().is_some() && self.progress.has_taken() > 0 =>
            {
                self.progress.is_full();
                self.schedule.wait(now);
            }
            // Its image tells nothing of its drives: the job goes without.
            (Command::Drives { .. }, Refusal::NoFeedback) => self.begin(),
            // Another client has enabled the machine.
            (Command::Enable, Refusal::State(_)) => self.phase = Phase::Surveying,
            // The user's command came too late or too early, which does no harm.
            (Command::Hold | Command::Resume, _) => {
                self.user.commands.settle(command);
                // The status is older than what refuses it.
                self.schedule.wait(now);
            }
            (_, refusal) => match self.phase {
                Phase::Ending(failure) => self.phase = Phase::Finished(Err(failure)),
                _ => {
                    self.user.commands.settle(command);
                    self.end_refused(command, refusal);
                }
            },
        }
    }

    /// Ends the job by the refusal of `command`.
    fn end_refused(&mut self, command: &Command<N>, refusal: Refusal<N>) {
        let index = match (command.offered(), command) {
            (Some(moves), _) => self.progress.index(moves.number),
            (None, Command::Path(_)) => Some(self.progress.has_taken()),
            _ => None,
        };
        self.enter(Phase::Ending(JobFailure::Refused { index, refusal }));
    }
}
