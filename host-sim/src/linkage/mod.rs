//! `host-sim linkage`: a planar mechanism described by links and joints, decomposed into Assur
//! groups and solved over its motion.
//!
//! A file is read and checked ([`Linkage`]), Gruebler's count against its drives
//! ([`Mobility`]); its links are ordered into groups ([`Group`]): driven links, dyads, and what
//! is beyond dyads. [`track()`] solves them in that order at every step: dyads in closed form by
//! the core, others by Newton-Raphson.

mod chain;
mod command;
mod constraint;
mod dependence;
mod description;
mod draw;
mod dyad;
#[cfg(test)]
mod example;
mod groups;
mod matrix;
mod mobility;
mod newton;
mod rail;
mod read;
mod report;
mod solve;
mod state;
mod table;
mod track;

pub use command::{command, write};
pub use description::{Drive, FRAME, Joint, JointKind, Link, Linkage, Motion, PointRef, Prismatic};
pub use groups::{Dyad, Group, GroupKind};
pub use mobility::Mobility;
pub use solve::{Position, Reason, Solved, Unsolved};
pub use state::State;
pub use track::{Stop, Track, track};
