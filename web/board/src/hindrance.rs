//! Reasons for which commands would do nothing.

use crate::BoardCommand;
use crate::talk::{BoardTalk, Talking};
use trirrr_protocol::message::{State, Transmit};

impl<N: Transmit> BoardTalk<N> {
    /// Reason why a command would do nothing now.
    pub(crate) fn hindrance(&self, command: BoardCommand) -> Option<&'static str> {
        const OFF: &str = "the drives are off: enable them first";
        const UNHOMED: &str = "the machine does not know where its motors are: home it first";
        const LOST: &str = "pose unknown after a fault: recover first";
        let (None, Some(status)) = (&self.closed, &self.status) else {
            return Some("no board is connected");
        };
        if self.is_silent {
            return Some("the board does not answer");
        }
        let state = status.state;
        let is_free = state == State::Idle && matches!(self.talking, Talking::Manual(_));
        let has_stop = status.inputs.emergency_stop.is_active();
        let stop = has_stop.then_some("the emergency stop is pressed, or its wire is broken");
        let ready = match state {
            State::Disabled | State::Enabling | State::Disabling => Some(OFF),
            State::Unhomed | State::Homing => Some(UNHOMED),
            State::Cleared | State::Recovering => Some(LOST),
            State::Fault | State::Reacting => Some("a fault is latched: acknowledge it first"),
            _ if !is_free => Some("the machine moves, or holds a job"),
            _ if status.inputs.door.is_active() => Some("the door is open"),
            _ => None,
        };
        match command {
            BoardCommand::Enable => match state {
                State::Disabled => stop,
                State::Fault | State::Reacting => Some("a fault is latched: acknowledge it first"),
                State::Enabling | State::Disabling => Some("the drives are being switched"),
                _ => Some("the drives are on"),
            },
            BoardCommand::Disable => {
                (state == State::Disabled).then_some("the drives are off already")
            }
            BoardCommand::Acknowledge => match state {
                State::Fault => stop,
                State::Reacting => Some("the machine comes to rest first"),
                State::Disabled
                    if status
                        .not_enabled
                        .is_some_and(|why| why.wants_acknowledgement()) =>
                {
                    stop
                }
                _ => Some("no fault is latched"),
            },
            BoardCommand::Home => match state {
                State::Unhomed | State::Cleared => None,
                State::Idle if is_free && self.has_homing => ready,
                State::Idle if is_free => {
                    Some("the scene has no homing: the machine knows where its motors are")
                }
                _ => ready,
            },
            BoardCommand::Run if self.work.items() == 0 => Some("the scene has no job"),
            BoardCommand::Step if ready.is_none() && status.end.is_none() => {
                Some("the machine has not said yet where it stands")
            }
            BoardCommand::Run | BoardCommand::Step => ready,
            BoardCommand::Hold => match state {
                State::Running => None,
                State::Slowing | State::Holding => Some("the machine holds already"),
                _ => Some("no job is under way"),
            },
            BoardCommand::Resume => match state {
                State::Slowing | State::Holding => None,
                _ => Some("nothing is held"),
            },
            BoardCommand::Stop => match state {
                State::Running
                | State::Slowing
                | State::Holding
                | State::Homing
                | State::Recovering
                | State::Reacting => None,
                _ if !matches!(self.talking, Talking::Manual(_)) => None,
                _ => Some("nothing is under way"),
            },
        }
    }
}
