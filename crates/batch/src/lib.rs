//! Batches of machines and states on a host, over all of its cores.
//!
//! [`BatchMachine`] evaluates slices of states of one machine, [`BatchReactions`] the forces in its joints. The module `table`, a feature that is on by
//! default, evaluates a table, CSV or Arrow, with one machine and one instant in each row.
// The example of the README is a test.
#![cfg_attr(all(doctest, feature = "table"), doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod lanes;
mod reactions;
mod states;
#[cfg(feature = "table")]
pub mod table;

pub use lanes::Float;
pub use reactions::{BatchReactions, ReactionRow};
pub use states::{BatchMachine, DistanceRow, FailedRow, LengthError, MotorRows, StateRows};
