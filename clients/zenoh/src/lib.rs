//! Machines on [Zenoh](https://zenoh.io): state, telemetry and events as keys, commands as queryables.
//!
//! One program carries any number of machines. Each has a thread of its own, which holds the conversation with the machine:
//!
//! ```text
//! Zenoh queries ──> command log (each number once) ──> conversation ──> line of a board, or a simulated machine
//! Zenoh keys    <── samples and events, numbered, with a history to fetch what was missed
//! ```
//! [`keys`] names the keys, [`records`] the layout of telemetry; `docs/fleet.md` is the manual.

#![forbid(unsafe_code)]

mod answer;
mod args;
mod command;
mod command_log;
mod control;
mod error;
mod fleet;
mod history;
mod joint_states;
pub mod keys;
mod line;
mod machine;
mod outlet;
pub mod records;
pub mod session;
mod task;

pub use args::{FleetArgs, RouterArgs};
pub use error::ZenohError;
pub use fleet::run;
