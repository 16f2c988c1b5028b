//! Refusals of the machine.

use super::{MachineDriver, PAUSE, Probing};
use std::time::Duration;
use trirrr_client::describe;
use trirrr_grbl::ProbeEnd;
use trirrr_protocol::message::{Command, Refusal, Transmit};

impl<N: Transmit> MachineDriver<N> {
    pub(super) fn on_refusal(&mut self, command: &Command<N>, refusal: Refusal<N>, now: Duration) {
        match (command, refusal) {
            // It is as a hold: what waits stays, and closing the door starts nothing.
            (_, Refusal::DoorOpen) => {
                self.is_door_hold = true;
                self.look = now;
            }
            (Command::Path(_), Refusal::MoveNumber { expected }) => self.piece = Some(expected),
            (Command::Path(_), Refusal::NoPaths) => {
                self.failure = Some(
                    "the machine plans no paths: its scene needs `plans_paths = true` in [service], and a number type with a floating point"
                        .into(),
                );
            }
            (Command::Hello(_), refusal) => {
                self.failure = Some(describe::refusal(&refusal, 0, &self.words));
            }
            (
                Command::Path(_),
                Refusal::QueueFull
                | Refusal::Busy
                | Refusal::Undecided
                | Refusal::Retargeting
                | Refusal::StartVelocity
                | Refusal::State(_),
            ) => {
                self.pause = now + PAUSE;
                self.look = self.pause;
            }
            (Command::Path(_), refusal) => {
                self.refuse(describe::refusal(&refusal, 0, &self.words));
            }
            // The tick takes one order at a time: none is lost. Holds and resumes are asked anew as they are needed.
            (
                Command::Stop
                | Command::Disable
                | Command::Enable
                | Command::Home
                | Command::Recover(_)
                | Command::ClearFault
                | Command::FeedOverride { .. }
                | Command::Telemetry { .. }
                | Command::Output { .. },
                Refusal::Busy,
            ) => {
                let is_newer = |order: &Command<N>| {
                    matches!(
                        (order, command),
                        (Command::FeedOverride { .. }, Command::FeedOverride { .. })
                    )
                };
                if !self.orders.iter().any(is_newer) {
                    self.orders.push_front(*command);
                }
                self.busy = now + PAUSE;
                self.look = self.look.min(self.busy);
            }
            (Command::Output { .. }, refusal)
            | (Command::OutputsAt(_), refusal @ Refusal::NoOutput { .. }) => {
                self.refuse(describe::refusal(&refusal, 0, &self.words));
            }
            (
                Command::Probe { .. },
                Refusal::NoProbe
                | Refusal::ProbeTouches
                | Refusal::ProbeOpen
                | Refusal::LimitSwitch { .. },
            ) => {
                let why = describe::refusal(&refusal, 0, &self.words);
                self.probing = Some(Probing::Ended(ProbeEnd::Refused(why)));
                self.feed.clear();
                self.piece = None;
                self.order(Command::Stop);
            }
            (Command::Start, Refusal::LimitSwitch { .. }) => {
                self.refuse(describe::refusal(&refusal, 0, &self.words));
            }
            // Too early or too late: the next status says what holds. More of the path comes before another start.
            _ => {
                if let (
                    Command::Start | Command::Probe { .. },
                    Refusal::Undecided | Refusal::EndsMoving,
                ) = (command, refusal)
                {
                    self.early = self.status.map(|status| status.next);
                }
                self.pause = now + PAUSE;
                self.look = self.pause;
            }
        }
    }
}
