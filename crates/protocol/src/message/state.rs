//! What the machine is doing.

use super::violation::Bounded;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// What the machine is doing. The four states that the tool knows are idle, running, holding and
/// fault: it is on in running only, [`State::is_running`]; the other states lie between.
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

/// What keeps the machine from normal speed.
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
    /// What is queued ends moving: it waits for more.
    QueueDry,
    /// A limit of the scene: the one that the fault names.
    Limit(Bounded),
}

impl State {
    /// Whether the job is played, at whatever speed: the only states in which the tool may be on.
    pub fn is_running(self) -> bool {
        matches!(self, Self::Running | Self::Slowing)
    }

    /// Whether the machine stands still and stays so until it is told otherwise.
    pub fn is_at_rest(self) -> bool {
        matches!(
            self,
            Self::Idle | Self::Holding | Self::Fault | Self::Cleared | Self::Unhomed
        )
    }
}
