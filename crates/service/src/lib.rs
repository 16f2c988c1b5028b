//! The service between a host and the motors: it takes commands, checks every move before it starts,
//! runs them without a missed tick, stops in a defined way, and reports what it does.
//!
//! No device, no clock: whoever owns it calls [`Foreground::tick`](board::Foreground::tick) once per tick from the highest
//! priority that there is, and hands to [`Background`](board::Background) what the line brings. The two halves are
//! joined by queues with one end each ([`Channels`]): neither waits for the other, neither locks,
//! neither allocates. `docs/service.md` has states, commands, faults and times.
//!
//! ```text
//!  line ──> Background::answer ───> admission ──moves──> Foreground::tick ──> motors, tool
//!                 │                                            │
//!                 └───────────────orders──────────────────────>│
//!  line <── Background::outgoing <────reports, telemetry───────┘
//! ```
//!
//! What is promised:
//! - At normal speed the setpoints are [`Segment::at`](trirrr_core::setpoint::Segment::at) tick by tick,
//!   in the bits, over any number of moves.
//! - A hold, a stop and a resume leave neither the path nor the limits: only the time along the path
//!   changes its feed scale. Time along the path is a whole number; it neither rounds nor drifts.
//! - What is queued may end moving; then the machine comes to rest before its end, and goes on when
//!   there is more.
//! - Nothing goes out that is beyond a limit: it is a fault instead. A fault is latched, the drives
//!   and the tool are off.
//! - The tool is on only while the job runs, in proportion to its speed along the path or, where a move says so, at
//!   the same power at every speed.
//! - A host that is silent for too long ends in a controlled stop.
#![no_std]
// A comparison with what is not a number is false. Guards are written `!(x > limit)` so that such a
// value is refused, which `x <= limit` would let pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

#[cfg(test)]
extern crate std;

pub mod admission;
mod background;
mod built;
mod channels;
mod contact;
mod curves;
mod digital;
mod feature;
mod feed;
mod feedback;
mod foreground;
mod guard;
mod handoff;
mod homing;
mod interlock;
mod levels;
mod number;
mod offered;
mod own_job;
mod pace;
mod planner;
mod queue;
mod retreat;
mod scene;
mod service;
mod settings;
mod splice;
mod states;
mod stop;
#[cfg(test)]
mod tests;
mod tool;

pub use channels::{Channels, ServiceError};
pub use foreground::{Output, Power};
pub use number::ServiceNumber;
pub use scene::{Adjustable, Machine, Parts, Scene, SceneParts};
pub use service::{Played, Service};
pub use settings::{PowerTimes, Reactions, SceneIdentity, Settings, StopCategory, key, name};
pub use tool::Tool;

#[cfg(test)]
use crate::{board::*, coefficients::*, features::*, paces::*};

/// The two halves of a service, for a board that gives each its own priority, and what passes between them.
pub mod board {
    pub use crate::background::Background;
    pub use crate::feedback::Readings;
    pub use crate::foreground::Foreground;
    pub use crate::handoff::{QueuedMove, Recover};
    pub use crate::interlock::InterlockReadings;
    pub use crate::scene::{CommandOf, Compiled, CurvesOf, ModelOf, PartOf, RequestOf, command_of};
}

/// What a scene may have or lack, and the parameters of each.
pub mod features {
    pub use crate::contact::{
        ContactModel, ContactObserver, ContactParameters, ContactThresholds, Deviation,
    };
    pub use crate::curves::PlayedCurves;
    pub use crate::digital::DigitalParameters;
    pub use crate::feature::{ChannelMemory, Feature, On, Optional, Present};
    pub use crate::feedback::{FeedbackParameters, WatchLimits};
    pub use crate::homing::{Contact, HomingAxis, HomingMotor, HomingParameters, HomingTimes};
    pub use crate::interlock::{
        ButtonInput, Door, EmergencyStop, InterlockParameters, LimitInputs, ProbeInput, input_bits,
    };
    pub use crate::levels::check_levels;
    pub use crate::own_job::{FOREVER, JobStart, OwnHoming, OwnJob, OwnJobParts};
    pub use crate::planner::{PathPlanner, PathStep, Planning};
    pub use crate::scene::{ImageSlot, NoImage, check_image};
}

/// Numbers that whoever builds an image computes beforehand.
pub mod coefficients {
    pub use crate::built::Coefficients;
    pub use crate::contact::ContactCoefficients;
    pub use crate::feedback::FeedbackCoefficients;
    pub use crate::homing::HomingCoefficients;
    pub use crate::scene::{SceneValues, StepperValues, needs_of_model};
}

/// Rates at which the pace along a path changes, and the time and the way of stops.
pub mod paces {
    pub use crate::background::{check_offer, longest_move};
    pub use crate::pace::{MovePaces, Pace, Ramp};
    pub use crate::stop::{PacedMove, PathPlace, StopJob, Stops};
}
