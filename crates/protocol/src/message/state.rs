//! State of the machine.

use super::violation::Bounded;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// State of the machine. The tool knows four states: idle, running, holding and fault.
/// The tool is on in running only, [`State::is_running`]. The other states lie between.
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
    /// A fault is latched, the drives are off.
    Fault,
    /// The fault was acknowledged, the drives hold; waits for a recovery.
    Cleared,
    /// The motors move one by one to where they are at a pose.
    Recovering,
    /// Switched on, or after a fault, in a scene with homing: where the motors are is not known.
    Unhomed,
    /// The motors look for their switches or stops.
    Homing,
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
    /// The host has been silent for too long.
    Silence,
    /// The queue ends while the machine moves: the machine waits for more.
    QueueDry,
    /// A limit of the scene: the one that the fault names.
    Limit(Bounded),
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
            Self::Idle | Self::Holding | Self::Fault | Self::Cleared | Self::Unhomed
        )
    }
}
