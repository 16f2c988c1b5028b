//! Holds: the program stands, and nothing is handed to the machine.

use super::Dialect;
use crate::state::{DoorState, State};
use crate::view::{MachineAct, MachinePhase, MachineView};
use std::time::Duration;

/// Reason for which nothing moves before the user goes on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Held {
    /// `!`, or a pause of the program.
    Feed,
    /// 0x84, or the door itself.
    Door,
}

impl Dialect {
    /// Holds, in every state but a jog, which ends.
    pub(super) fn hold(&mut self, why: Held) {
        if self.is_jog {
            return self.cancel_jog();
        }
        // A door outlasts a hold.
        if self.held != Some(Held::Door) {
            self.held = Some(why);
        }
        self.is_restoring = false;
        self.acts.push(MachineAct::Hold);
    }

    /// Goes on, unless the door is open.
    pub(super) fn resume(&mut self, view: &MachineView) {
        let Some(held) = self.held else {
            return;
        };
        if view.contacts.door {
            return self.message("the door is open: close it, then ~ goes on");
        }
        self.is_restoring = held == Held::Door;
        self.held = None;
        self.acts.push(MachineAct::Resume);
    }

    /// Looks at the door itself. It holds after a jog, too.
    pub(super) fn watch_door(&mut self, view: &MachineView) {
        let is_open = view.contacts.door && view.phase != MachinePhase::Lost;
        if (is_open || view.is_door_hold) && self.held != Some(Held::Door) {
            // What `~` has just cleared is still in the view.
            if !is_open && self.acts.contains(&MachineAct::Resume) {
                return;
            }
            if self.is_jog {
                self.cancel_jog();
                self.is_jog = false;
            }
            self.message("Check Door");
            self.hold(Held::Door);
        }
        if view.stands && view.phase != MachinePhase::Holding {
            self.is_restoring = false;
        }
    }

    /// Lets the time of stands and waits not pass in a hold.
    pub(super) fn stand_still(&mut self, passed: Duration) {
        if let Some(wait) = &mut self.wait {
            wait.put_off(passed);
        }
    }

    /// State of a machine that is held, or goes on after a door.
    pub(super) fn held_state(&self, view: &MachineView) -> Option<State> {
        let is_holding = matches!(view.phase, MachinePhase::Slowing | MachinePhase::Holding);
        match self.held {
            Some(Held::Feed) => Some(State::Hold(!view.stands)),
            Some(Held::Door) if !view.stands => Some(State::Door(DoorState::Slowing)),
            Some(Held::Door) if view.contacts.door => Some(State::Door(DoorState::Open)),
            Some(Held::Door) => Some(State::Door(DoorState::Closed)),
            None if self.is_restoring && is_holding => Some(State::Door(DoorState::Restoring)),
            None => None,
        }
    }
}
