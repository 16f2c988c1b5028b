//! States of GRBL, and the `$` commands that each of them allows.

use crate::fault;
use std::fmt;

/// State in the words of GRBL.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum State {
    Idle,
    Run,
    /// Held; `true`: on the way to rest.
    Hold(bool),
    Jog,
    Alarm,
    Door(DoorState),
    Check,
    Home,
    Sleep,
}

/// Part of a stop by the door.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum DoorState {
    /// Stands, the door is closed: `~` goes on.
    Closed = 0,
    /// Stands, the door is open.
    Open = 1,
    /// On the way to rest.
    Slowing = 2,
    /// Going on.
    Restoring = 3,
}

impl fmt::Display for State {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Hold(moves) => write!(f, "Hold:{}", u8::from(*moves)),
            Self::Door(door) => write!(f, "Door:{}", *door as u8),
            // The names are GRBL's.
            plain => write!(f, "{plain:?}"),
        }
    }
}

impl State {
    /// Checks that GRBL carries out a `$` command in this state. `letter`: the first behind the `$`.
    ///
    /// # Errors
    /// The number of GRBL.
    pub(crate) fn allows(self, letter: Option<char>) -> Result<(), u8> {
        use State::{Alarm, Hold, Idle, Jog, Run, Sleep};
        let is_allowed = match letter {
            None | Some('G' | 'X') => true,
            Some('$') => !matches!(self, Run | Hold(_)),
            Some('J') => matches!(self, Idle | Jog),
            Some('C') => matches!(self, Idle | Self::Check),
            // A machine that sleeps is one whose drives are off, as in an alarm.
            Some(_) => matches!(self, Idle | Alarm | Sleep),
        };
        match is_allowed {
            true => Ok(()),
            false => Err(fault::NOT_IDLE),
        }
    }
}
