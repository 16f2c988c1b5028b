//! Readers of the tables that scenes of every kind of machine share.

pub use crate::job::{PlacedJob, PlacedMove, read_job_with};
pub use crate::kind::read_kind;
pub use crate::machine::{MachineTables, read_machine};
pub use crate::whole::read_rate;
