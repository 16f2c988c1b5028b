//! Batches of machines and states on a host, over all of its cores.
//!
//! [`BatchMachine`] evaluates slices of states of one machine. [`table`] evaluates a table, CSV or Arrow, with one machine and one instant in each row.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod lanes;
mod states;
pub mod table;

pub use states::{BatchMachine, FailedRow, Float, LengthError, MotorRows, StateRows};
