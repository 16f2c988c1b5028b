//! The service between a host and the motors: it takes commands, checks every move before it starts,
//! runs them without a missed tick, stops in a defined way, and reports what it does.
//!
//! No device, no clock: whoever owns it calls [`Foreground::tick`] once per tick from the highest
//! priority that there is, and hands to [`Background`] what the line brings. The two halves are
//! joined by queues with one end each ([`Channels`]): neither waits for the other, neither locks,
//! neither allocates. `docs/service.md` has states, commands, faults and times.
//!
//! ```text
//!  line ──> Background::receive ──> admission ──moves──> Foreground::tick ──> motors, tool
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
mod channels;
mod coefficients;
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
mod stop;
#[cfg(test)]
mod tests;
mod tool;

pub use background::{Background, check_offer, longest_move};
pub use channels::{Channels, ServiceError};
pub use coefficients::Coefficients;
pub use contact::{
    ContactCoefficients, ContactModel, ContactObserver, ContactParameters, ContactThresholds,
    Deviation,
};
pub use curves::PlayedCurves;
pub use digital::DigitalParameters;
pub use feature::{ChannelMemory, Feature, On, Optional, Present};
pub use feedback::{FeedbackCoefficients, FeedbackParameters, Readings, WatchLimits};
pub use foreground::{Foreground, Output, Power};
pub use handoff::{QueuedMove, Recover};
pub use homing::{
    Contact, HomingAxis, HomingCoefficients, HomingMotor, HomingParameters, HomingTimes,
};
pub use interlock::{
    ButtonInput, Door, EmergencyStop, InterlockParameters, InterlockReadings, LimitInputs,
    ProbeInput, input_bits,
};
pub use levels::check_levels;
pub use number::ServiceNumber;
pub use own_job::{FOREVER, JobStart, OwnHoming, OwnJob, OwnJobParts};
pub use pace::{MovePaces, Pace, Ramp};
pub use planner::{PathPlanner, PathStep, Planning};
pub use scene::{
    Adjustable, CommandOf, Compiled, CurvesOf, ImageSlot, Machine, ModelOf, NoImage, PartOf, Parts,
    RequestOf, Scene, SceneParts, SceneValues, StepperValues, check_image, command_of,
    needs_of_model,
};
pub use service::{Played, Service};
pub use settings::{PowerTimes, Reactions, SceneIdentity, Settings, StopCategory, key, name};
pub use stop::{PacedMove, PathPlace, StopJob, Stops};
pub use tool::Tool;
