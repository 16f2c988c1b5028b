//! Plant of a redundant machine: rigid bodies under sampled loops round motors and sliders.
//!
//! The coordinates are the pose of the platform and the positions of the sliders. Their forces Q follow from the torques of
//! the motors and the forces of the sliders by virtual work. What a motion needs is linear in the accelerations, so that
//!
//! ```text
//! Q(q, q', q'') = M(q) q'' + h(q, q'),     h = Q(q, q', 0),     column k of M = Q(q, q', e_k) - h
//! ```
//! and the accelerations under given torques and forces solve M q'' = Q - h. The energies are those of the bodies, so that
//! the balance of energy judges M and h.

mod bodies;
mod dynamics;
mod run;

pub use run::{RedundantOutcome, RedundantRow, simulate};

/// Most sliders of a machine.
const SLIDERS: usize = 3;
/// Coordinates: pose and sliders.
const COORDINATES: usize = 3 + SLIDERS;
