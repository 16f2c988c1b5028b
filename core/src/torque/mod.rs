//! Motor torques by virtual work, solved for the three motors at once.
//!
//! With P_i the force that leg i puts on the platform at C_i, split along and across its distal
//! link, P_i = f_i r2_i - q_i E r2_i:
//!
//! ```text
//! q_i    = Q2_i / l2_i^2                                 the distal link's own inertia
//! sum P_i       = F = m (aG - g) - W                     the platform's balance, forces
//! sum c_i x P_i = M = I alphaddot + s x m (aG - g) - Walpha        and moments about D
//! tau_i  = Q1_i + D_i f_i - q_i (r1_i . r2_i)            the proximal link's balance
//! ```
//!
//! with s = D -> centre of mass, D_i = r1 x r2, and Q1_i, Q2_i the inertia and weight of the two
//! links against their angles. Nothing is divided by a joint rate or by D_i: torque is finite at
//! rest and up to full stretch. Only det A = 0, the parallel singularity, is singular.
//!
//! The source's own formula (thesis (4.15) to (4.20)) gives each motor the power of the whole
//! platform; see the repository's `docs/errata.md`.
//!
//! [`demand`] is F and M, [`payload`] makes them, [`links`] adds the share of the legs, [`lines`] holds the geometry,
//! [`balance`] solves. A [kinematic model](crate::model::Kinematic) uses none of them.

pub mod balance;
pub mod demand;
#[cfg(test)]
mod energy;
pub mod lines;
pub mod links;
pub mod payload;
