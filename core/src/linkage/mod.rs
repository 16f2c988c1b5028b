//! Planar linkages by Assur groups: the dyads, groups of two links and three joints that have no
//! freedom of their own. Given the motion of its two outer joints, a dyad has a closed-form
//! solution up to a sign.
//!
//! A leg of the 3-RRR machine is the RRR dyad between the motor's joint and the platform's.

pub mod rrr;
