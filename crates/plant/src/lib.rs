//! The plant: the machine with its motors, transmissions and friction in forward dynamics, in
//! binary64, under the control of a scene. `docs/plant.md` has the equations.
//!
//! | module | what |
//! |---|---|
//! | [`mechanics`] | the rigid bodies: torques to accelerations, energies |
//! | [`friction`], [`motor`] | what acts in the joints |
//! | [`layout`], [`model`], `equations`, `system` | all together, as differential equations |
//! | [`outputs`] | what can be seen besides the state |
//! | [`watch`] | where they change or end |
//! | [`control`] | what commands the motors |
//! | [`path`], [`source`], [`sampled`] | the job in time, its ticks, and the drives' inner loops that follow them |
//! | [`simulate`] | a whole run |
//! | [`statistics`], [`table`] | what is gathered over a run |

pub mod control;
mod equations;
pub mod friction;
pub mod layout;
pub mod mechanics;
pub mod model;
pub mod motor;
pub mod outputs;
pub mod path;
pub mod refusal;
pub mod sampled;
pub mod simulate;
pub mod source;
mod stability;
pub mod statistics;
mod system;
pub mod table;
pub mod watch;

pub use model::{Control, Plant, layout_of};
pub use refusal::Refusal;
