//! Planar linkages by Assur groups: the dyads, groups of two links and three joints that have no
//! freedom of their own. Given the motion of its two outer joints or guides, a dyad has a
//! closed-form solution up to a sign.
//!
//! A leg of the 3-RRR machine is the RRR dyad between the motor's joint and the platform's.
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
//! stages, each of which knows the one before; they take vectors between the ends and check
//! nothing but that the dyad closes. `solve` runs the three on the [motions](motion) of the ends,
//! returns the motions of joints and links, and refuses what is not finite.
//!
//! What has no closed form, or is to be solved without one, goes to [`closure`]: vector loops by
//! Newton-Raphson.
//!
//! # Example
//! A point of the coupler of a four-bar linkage, with its velocity:
//! ```
//! use nalgebra::Vector2;
//! use trirrr_core::linkage::Drive;
//! use trirrr_core::linkage::mechanism::four_bar::{FourBar, SHIPPED};
//!
//! let linkage = FourBar::<f32>::new(&SHIPPED)?;
//! let drive = Drive { angle: 1.0, rate: 2.0, acceleration: 0.0 };
//! let at = linkage.at(&drive)?;
//! let tracer = at.coupler.point(Vector2::new(0.2, 0.1));
//! // The crank's tip runs at 0.1 m * 2 rad/s.
//! let tip = at.coupler.origin.velocity;
//! assert!((tip.x.hypot(tip.y) - 0.2).abs() < 1e-7);
//! assert!(tracer.velocity != tip);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

pub mod closure;
pub mod mechanism;
pub mod motion;
pub mod ppr;
pub mod prp;
pub mod rpr;
pub mod rrp;
pub mod rrr;
mod status;

pub use motion::{Drive, GuideMotion, LinkMotion, PointMotion, SlideMotion};
pub use status::LinkageStatus;
