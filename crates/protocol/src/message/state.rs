//! State of the machine.

use super::violation::Bounded;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// State of the machine. The tool is on only while the machine plays a job, [`State::is_running`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum State {
    /// Stands, nothing under way.
    Idle,
    /// Plays the job.
    Running,
    /// Running, on the way to a hold.
    Slowing,
    /// Comes to rest to drop the job.
    Stopping,
    /// Stands on the path.
    Holding,
    /// A fault is latched; the drives are off, or hold where the scene says so.
    Fault,
    /// Drives are on after a fault, the platform's pose is not known; waits for a recovery.
    Cleared,
    /// The motors move one by one to where they are at a pose.
    Recovering,
    /// Drives are on in a scene with homing: where the motors are is not known.
    Unhomed,
    /// The motors look for their switches or stops.
    Homing,
    /// Drives are off, until the host enables them: the state after every start and after every fault.
    Disabled,
    /// Drives are checked and go on where the motors are.
    Enabling,
    /// The motors stand and the brake engages; then the drives go off.
    Disabling,
    /// A fault is latched: the machine comes to rest on its path, then the drives go off or hold, as the scene says.
    Reacting,
}

/// Cause that keeps the machine from normal speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Acting {
    /// Nothing.
    Nothing,
    /// A hold that the host asked for.
    Hold,
    /// It is on the way back to normal speed.
    Resume,
    /// A stop that the host asked for.
    Stop,
    /// The host has been silent for too long. A job waits to be resumed; any other motion is given up.
    Silence,
    /// The queue ends while the machine moves: the machine waits for more.
    QueueDry,
    /// A limit of the scene: the one that the fault names.
    Limit(Bounded),
    /// The door is open, or was: the machine waits to be resumed once it is closed.
    Door,
    /// The contact of the probe has changed: the run is over.
    Probe,
}

impl State {
    /// Returns true if the machine plays the job, at any speed: only then may the tool be on.
    pub fn is_running(self) -> bool {
        matches!(self, Self::Running | Self::Slowing)
    }

    /// Returns true if the machine stands still and stays so until it is told otherwise.
    pub fn is_at_rest(self) -> bool {
        matches!(
            self,
            Self::Idle
                | Self::Holding
                | Self::Fault
                | Self::Cleared
                | Self::Unhomed
                | Self::Disabled
        )
    }

    /// Returns true if a fault is latched.
    pub fn has_fault(self) -> bool {
        matches!(self, Self::Fault | Self::Reacting)
    }
}
