//! Holds of the sender and of the door: the machine comes to rest, and nothing is started.

use super::{MachineDriver, STATUS_EVERY};
use std::time::Duration;
use trirrr_protocol::message::{Acting, Command, State, Status, Transmit};

/// Holds, as the driver knows them.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Holds {
    /// The sender holds.
    held: bool,
    /// The sender has gone on, and the machine still stands for the reason before.
    resumes: bool,
}

impl<N: Transmit> MachineDriver<N> {
    /// Nothing may be started.
    pub(super) fn is_held(&self) -> bool {
        self.holds.held || self.is_door_hold
    }

    /// Holds from now on. A machine that is on its path is told at once: it may be about to go on.
    pub(super) fn hold(&mut self) {
        self.holds = Holds {
            held: true,
            resumes: false,
        };
        self.is_door_hold = false;
        if self
            .status
            .is_some_and(|status| status.state == State::Running)
        {
            self.order(Command::Hold);
        }
    }

    /// Goes on.
    pub(super) fn resume(&mut self) {
        self.orders.retain(|order| *order != Command::Hold);
        self.is_door_hold = false;
        self.holds = Holds {
            held: false,
            resumes: true,
        };
    }

    /// Forgets all holds: the machine drops what it has.
    pub(super) fn drop_holds(&mut self) {
        self.holds = Holds::default();
        self.is_door_hold = false;
    }

    /// Holds what was started while the hold came.
    pub(super) fn started(&mut self) {
        if self.is_held() {
            self.orders.push_front(Command::Hold);
        }
    }

    /// Looks at the door: the machine itself holds behind it, and whoever closes it starts nothing.
    pub(super) fn watch_door(&mut self, status: &Status<N>) {
        let is_open = status.inputs.door.is_active();
        let stands = match status.state {
            State::Slowing | State::Holding => true,
            State::Stopping | State::Unhomed | State::Cleared => self.waking.is_some(),
            _ => false,
        };
        let is_by_door = status.acting == Acting::Door;
        self.holds.resumes &= is_by_door && stands && !is_open;
        self.is_door_hold |= is_open || (is_by_door && stands && !self.holds.resumes);
    }

    /// Order that brings a held machine to rest, or lets one go on that stands for a hold that is over.
    pub(super) fn hold_order(&mut self, status: &Status<N>, now: Duration) -> Option<Command<N>> {
        if !self.is_fresh() {
            return None;
        }
        let on_path = matches!(status.state, State::Slowing | State::Holding);
        let goes_on_later = matches!(status.acting, Acting::Hold | Acting::Door);
        if self.is_held() {
            return match status.state {
                State::Running => Some(Command::Hold),
                // It waits for something else, and would go on by itself.
                _ if on_path && !goes_on_later => Some(Command::Hold),
                State::Homing | State::Recovering => Some(Command::Stop),
                _ => None,
            };
        }
        // A machine that was cut off waits for its host, not for the sender.
        let waits = on_path && (goes_on_later || status.waits_for_host());
        waits.then(|| {
            self.pause = now + STATUS_EVERY;
            Command::Resume
        })
    }
}
