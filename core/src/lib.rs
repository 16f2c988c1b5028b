//! Kinematics, dynamics and setpoints of the planar 3-RRR parallel manipulator: what a motion
//! controller has to compute in each tick, for any number type, without allocation, without a
//! clock, without a device.
//!
//! # The machine
//! Three motors, fixed to the frame at A_i, each turn a proximal link A_i -> B_i; a distal link
//! B_i -> C_i joins it to the platform, which moves in x, y and alpha. The motors of a pose are
//! found in closed form; their torques by virtual work, solved for the three at once.
//!
//! # One tick
//! ```text
//! Setpoint ──> inverse::Position ──> inverse::Velocity ──> inverse::Acceleration ─┐
//!    │               (angles)             (rates)              (accelerations)     │
//!    │                                                                            v
//!    └──> torque::demand::Demand ───────────> torque::balance <───── torque::links::LegLoad
//!                                                   │ (torques)
//!                                                   v
//!                                             tick::Motion
//! ```
//! Each stage is a small type with one pure function and knows the one before it, never the one
//! after. [`tick::Tick`] runs them in order. Its [`model`] says what a scene holds (number type,
//! payload, links, gravity), so that what a scene does not use is not compiled.
//!
//! # Example
//! The thesis machine starts its move: the torques at rest, in f32.
//! ```
//! use nalgebra::Vector2;
//! use trirrr_core::machine::{
//!     Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters,
//! };
//! use trirrr_core::model::Dynamic;
//! use trirrr_core::setpoint::{Pose, RestToRest};
//! use trirrr_core::tick::Tick;
//!
//! let leg = |x: f64, y: f64, degrees: f64| LegParameters {
//!     base_m: Vector2::new(x, y),
//!     proximal_m: 0.2,
//!     distal_m: 0.2,
//!     joint_radius_m: 0.02,
//!     joint_angle_rad: degrees.to_radians(),
//!     elbow: Elbow::Positive,
//!     proximal: LinkParameters::default(),
//!     distal: LinkParameters::default(),
//!     rotor_inertia_kgm2: 0.0,
//! };
//! let parameters = Parameters {
//!     legs: [leg(0.0, 0.433, 150.0), leg(0.5, 0.433, 30.0), leg(0.25, 0.0, 270.0)],
//!     platform: PlatformParameters {
//!         mass_kg: 0.5,
//!         inertia_kgm2: 0.0025,
//!         com_m: Vector2::new(0.0, 0.0),
//!         tool_point_m: Vector2::new(0.0, 0.0),
//!     },
//!     gravity_m_s2: Vector2::new(0.0, 0.0),
//!     wrench_force_n: Vector2::new(0.0, 0.0),
//!     wrench_torque_nm: 0.0,
//! };
//! // Built once: everything is checked here, nothing in the tick.
//! let tick: Tick<Dynamic<f32>> = Tick::build(&parameters)?;
//!
//! // x 0.21 -> 0.28 m, y 0.22 -> 0.28 m, alpha 9 -> 12 degrees in 100 ticks of 10 ms.
//! let from = Pose::from_f64(0.21, 0.22, 9f64.to_radians());
//! let to = Pose::from_f64(0.28, 0.28, 12f64.to_radians());
//! let job = RestToRest::new(from, to, 100, 0.01);
//!
//! let motion = tick.evaluate(&job.at(0))?;
//! assert!((motion.motors[0].torque - 0.012_528_697).abs() < 1e-7);
//! assert!((motion.motors[2].torque + 0.029_750_897).abs() < 1e-7);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Conventions
//! SI units. Angles in radians, counter-clockwise from the fixed x axis; alpha is not wrapped,
//! link angles lie in (-pi, pi]. A torque is what the motor puts on the proximal link,
//! counter-clockwise positive. Legs are numbered 0 to 2 in code, 1 to 3 in messages.
//!
//! # What it rests on
//! | floor | modules |
//! |---|---|
//! | numbers | [`number`]: the trait, and kernels with the same bits on every machine |
//! | parts | [`setpoint`], [`dyad`] |
//! | machine | [`machine`] |
//! | kinematics | [`inverse`], [`forward`], [`singularity`] |
//! | dynamics | [`torque`], [`reaction`] |
//! | all together | [`tick`] |
//! | what results must keep | [`limits`] |
//!
//! # What it will not do
//! It does not clip, project or repair a setpoint: one that has no motion ends in a
//! [`status::Status`]. The pipeline holds no state from one tick to the next; only
//! the service built on this crate does. It knows no device and no clock.
#![no_std]
#![forbid(unsafe_op_in_unsafe_fn)]
// A comparison with what is not a number is false. Guards are written `!(x > limit)` so that such a
// value is refused, which `x <= limit` would let pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

#[cfg(test)]
extern crate std;

mod arithmetic;
pub mod dyad;
pub mod forward;
pub mod inverse;
pub mod limits;
pub mod machine;
pub mod model;
pub mod number;
pub mod reaction;
pub mod setpoint;
pub mod singularity;
pub mod source;
pub mod status;
pub mod tick;
pub mod torque;
pub mod units;
