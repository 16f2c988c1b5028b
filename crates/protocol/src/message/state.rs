//! State of the machine.

use super::violation::Bounded;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};

/// State of the service. The tool is on only while the machine plays a job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum State {
    /// Stands, no job.
    Idle,
    /// Plays the job.
    Running,
    /// Plays the job, on the ramp to a hold.
    Slowing,
    /// On the ramp to rest, the job is dropped.
    Stopping,
    /// Stands on the path.
    Holding,
    /// A fault is latched; the drives are off, or hold where the scene says so.
    Fault,
    /// The drives are on after a fault, the platform's pose is not known; waits for a recovery.
    Cleared,
    /// Each motor moves by itself to its angle at a pose.
    Recovering,
    /// The drives are on, motor angles are unknown: in a scene with homing.
    Unhomed,
    /// The motors search for their switches or hard stops.
    Homing,
    /// The drives are off until the host enables them: after every start and every fault.
    Disabled,
    /// The drives are checked, and go on where the motors are.
    Enabling,
    /// The motors stand and the brake engages; then the drives go off.
    Disabling,
    /// A fault is latched: the machine comes to rest on its path, then the drives go off, or hold, as the scene says.
    Reacting,
}

/// Reason why the machine is not at normal speed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Acting {
    /// Nothing.
    Nothing,
    /// A hold that the host asked for.
    Hold,
    /// The ramp back to normal speed.
    Resume,
    /// A stop that the host asked for.
    Stop,
    /// Host timeout. A job waits to be resumed; any other motion is given up.
    Silence,
    /// The queue ends with a velocity: the machine waits for more moves.
    QueueDry,
    /// A limit of the scene, named by the fault.
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
