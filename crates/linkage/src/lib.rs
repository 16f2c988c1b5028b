//! Planar linkages by Assur groups: dyads, mechanisms made of them, vector loops, redundant
//! machines.
//!
//! A dyad is a group of two links and three joints without a freedom of its own. Given the motion
//! of its two outer joints or guides, a dyad has a closed-form solution up to a sign. A leg of the
//! 3-RRR machine is the RRR dyad between the motor's joint and the platform's.
//!
//! | dyad | ends | unknown | solutions |
//! |---|---|---|---|
//! | [`rrr`] | two joints | two angles | 2 |
//! | [`rpr`] | two joints | an angle, a slide | 2 |
//! | [`rrp`] | a joint, a guide | an angle, a slide | 2 |
//! | [`prp`] | two guides | two slides | 1 |
//! | [`ppr`] | a guide, a joint | two slides | 1 |
//!
//! Each is built once from its constants. `position`, `rates` and `accelerations` are the three
//! stages, each of which takes the result of the one before. They take vectors between the ends
//! and only check that the dyad closes. `solve` runs the three stages on the [motions](motion) of
//! the ends, returns the motions of joints and links, and refuses results that are not finite.
//!
//! [`mechanism`] composes dyads. [`closure`] solves vector loops by Newton-Raphson, for groups
//! without a closed form. [`redundant`] evaluates machines with more than three legs or with base
//! joints on sliders. With the feature `std`, `assur` reads a linkage from a file, decomposes
//! the linkage into groups and follows its motion.
//!
//! # Example
//! A point of the coupler of a four-bar linkage, with its velocity:
//! ```
//! use nalgebra::Vector2;
//! use trirrr_linkage::Drive;
//! use trirrr_linkage::mechanism::four_bar::{FourBar, SHIPPED};
//!
//! let linkage = FourBar::<f32>::new(&SHIPPED)?;
//! let drive = Drive { angle: 1.0, rate: 2.0, acceleration: 0.0 };
//! let at = linkage.at(&drive)?;
//! let tracer = at.coupler.point(Vector2::new(0.2, 0.1));
//! // The tip of the crank moves at 0.1 m * 2 rad/s.
//! let tip = at.coupler.origin.velocity;
//! assert!((tip.x.hypot(tip.y) - 0.2).abs() < 1e-7);
//! assert!(tracer.velocity != tip);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![forbid(unsafe_code)]
// A comparison with a NaN is false. Guards are written `!(x > limit)`, which refuses a NaN;
// `x <= limit` would let it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

#[cfg(feature = "std")]
pub mod assur;
pub mod closure;
pub mod mechanism;
pub mod motion;
pub mod ppr;
pub mod prp;
pub mod redundant;
pub mod rpr;
pub mod rrp;
pub mod rrr;
mod status;

pub use motion::{Drive, GuideMotion, LinkMotion, PointMotion, SlideMotion};
pub use rrr::SolveRrr;
pub use status::LinkageStatus;
