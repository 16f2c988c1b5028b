//! Planar linkages by Assur groups: dyads, vector loops, redundant machines.
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
//! Each is built once from its constants. `position` takes the vector between the ends and only
//! checks that the dyad closes. `solve` takes the [motions](motion) of the ends, returns the
//! [`DyadMotion`], and refuses results that are not finite. A mechanism is a composition: a
//! [`Crank`] for each drive, then dyads in solving order, each between points or guides that are
//! known by then. [`FourBar`] has Grashof's class, the dead points and the singular positions of a
//! four-bar linkage.
//!
//! [`closure`] solves vector loops by Newton-Raphson, for groups without a closed form.
//! [`redundant`] evaluates machines with more than three legs or with base joints on sliders. With
//! the feature `std`, `assur` reads a linkage from a file, decomposes the linkage into groups and
//! follows its motion.
//!
//! # Example
//! A point of the coupler of a four-bar linkage, with its velocity:
//! ```
//! use nalgebra::Vector2;
//! use trirrr_linkage::rrr::{Rrr, SolveRrr};
//! use trirrr_linkage::{Crank, Drive, PointMotion};
//!
//! let crank = Crank::<f32>::new(Vector2::new(0.0, 0.0), 0.1);
//! let coupler_and_rocker = Rrr::<f32>::new(0.35, 0.25, 1.0);
//! let pivot = PointMotion::fixed(Vector2::new(0.4, 0.0));
//!
//! let tip = crank.tip(&crank.at(&Drive { angle: 1.0, rate: 2.0, acceleration: 0.0 }));
//! let at = coupler_and_rocker.solve(&tip, &pivot)?;
//! let tracer = at.first.point(Vector2::new(0.2, 0.1));
//! // The tip of the crank moves at 0.1 m * 2 rad/s.
//! assert!((tip.velocity.x.hypot(tip.velocity.y) - 0.2).abs() < 1e-7);
//! assert!(tracer.velocity != tip.velocity);
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
mod four_bar;
pub mod motion;
pub mod ppr;
pub mod prp;
pub mod redundant;
pub mod rpr;
pub mod rrp;
pub mod rrr;
mod status;

pub use four_bar::{FourBar, Grashof};
pub use motion::{Crank, Drive, DyadMotion, GuideMotion, LinkMotion, PointMotion, SlideMotion};
pub use rrr::SolveRrr;
pub use status::LinkageStatus;
