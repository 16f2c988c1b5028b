//! Plant of the planar 3-RRR manipulator: the machine with its motors, transmissions and friction in
//! forward dynamics, in binary64, under the control of a scene. `docs/plant.md` has the equations.
//!
//! [`PlantRun`] follows the ticks of a service and simulates what the machine makes of them.
//! [`Plant`] is the system of differential equations alone, for a run of one's own.
//!
//! | module | contents |
//! |---|---|
//! | [`mechanics`], [`leg`] | rigid bodies: torques to accelerations, energies |
//! | [`friction`], [`motor`] | moments in the joints |
//! | [`scalar`] | numbers of the equations, with derivatives or without |
//! | [`layout`], [`model`], `equations`, `system` | differential equations of the whole |
//! | [`outputs`] | quantities besides the state |
//! | [`watch`], `events` | instants at which the equations change or the run ends |
//! | [`control`], [`path`] | continuous controller and its setpoints |
//! | `drives`, `driven`, `joint_control`, `steppers`, `driver` | drives as on a board, between ticks and motors |
//! | [`loop_drives`], [`power_stage`] | amplifiers and encoders around the loops of a board |
//! | [`bus`], `bus_drives`, `bus_settings` | drives on a bus as state machines, and the wire |
//! | `sampling` | measurements of the drives, and their commands |
//! | [`run`], [`job`], [`outcome`], `ledger` | a whole run, and its energies |
//! | [`statistics`], [`table`] | results gathered over a run |
//! | [`moved`] | the machine under torques from outside |
//! | [`redundant`] | plant of a redundant machine: rigid bodies and sampled loops |
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

pub mod bus;
mod bus_drives;
mod bus_settings;
mod clock;
pub mod control;
mod driven;
mod driver;
mod drives;
mod equations;
mod events;
pub mod friction;
pub mod job;
mod joint_control;
pub mod layout;
mod ledger;
pub mod leg;
pub mod loop_drives;
mod mass_matrix;
pub mod mechanics;
mod method;
pub mod model;
pub mod motor;
pub mod moved;
pub mod outcome;
pub mod outputs;
pub mod path;
pub mod power_stage;
pub mod redundant;
pub mod refusal;
pub mod run;
mod sampling;
pub mod scalar;
mod scene_drives;
mod stability;
pub mod statistics;
mod steppers;
mod system;
pub mod table;
pub mod watch;

pub use bus_drives::{BusModels, models as bus_models};
pub use model::{Control, Plant, layout_of};
pub use outcome::{EnergyLoss, Outcome, PlantEnd};
pub use refusal::Refusal;
pub use run::{PlantRun, control_of};
