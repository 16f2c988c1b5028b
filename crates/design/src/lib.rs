//! Design questions of a planar 3-RRR manipulator: where it can work, in which working mode it does a job, and what its
//! motors and its platform do to each other.
#![forbid(unsafe_code)]

pub mod assembly;
pub mod interval;
pub mod loads;
pub mod modes;
pub mod motors;
#[cfg(feature = "optimise")]
pub mod optimise;
pub mod ratios;
pub mod reactions;
pub mod workspace;
