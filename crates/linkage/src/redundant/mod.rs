//! Redundant machines: planar manipulators with three or more RRR legs, some of whose base joints
//! may ride on driven sliders (table 1.1 of the thesis).
//!
//! | machine | legs | sliders | redundant |
//! |---|---|---|---|
//! | 3-RRR | 3 | 0 | - |
//! | 4-RRR, 6-RRR | 4, 6 | 0 | in actuation: more motors than freedoms |
//! | PRRR+2RRR, 2PRRR+RRR, 3PRRR | 3 | 1, 2, 3 | in kinematics: the sliders can be placed freely |
//!
//! Both kinds of redundancy may be mixed: [`RedundantMachine`] takes the number of legs as a constant and
//! says of each leg whether it has a slider.
//!
//! # The same pipeline
//! A leg is the [`Leg`](trirrr_core::machine::Leg) of the 3-RRR. On a slider it is the same leg in a
//! frame that is shifted by s u (u the direction of the guide, s the slider's position) and does
//! not turn: position, velocity and acceleration of the platform are taken relative to the base
//! joint, and gravity is g - u sddot. New is the distribution of the platform's balance over the legs:
//!
//! ```text
//! sum_i f_i [r2_i, (c_i - c_1) x r2_i] = [F, M]         three equations for LEGS forces
//! tau_i = D_i f_i + Q_i                                 as in the torque module
//! |tau - wanted|^2 = min                                the motor torques nearest to those wanted
//! ```
//!
//! With `wanted` zero that is the solution of least norm of the motor torques (N m; the plain
//! Euclidean norm, all motors alike). Any other `wanted` preloads the machine: the torques differ
//! from those of least norm by the part of `wanted` that no motion of the platform feels, the
//! projection onto the null space of J^T, thetadot = J Xdot. With three legs there is no such
//! part, and `wanted` has no effect.
//!
//! The forces along the distal links are the unknowns, found by the orthogonal (Householder)
//! factorisation A = Q \[R; 0\]: f = Q_1 R^-T w + Q_2 z, and z from the least squares problem
//! D Q_2 z = wanted - Q - D Q_1 R^-T w by another. Normal equations, which square the condition,
//! are formed nowhere, and nothing is divided by D_i.
//!
//! A slider's force is what its drive puts on the carriage along u, with R_A the force of the
//! carriage on the proximal link and m the carriage's mass, motor included:
//!
//! ```text
//! F_s = u . R_A + m (sddot - g . u)
//! ```
//!
//! The motors and sliders together supply the machine's change of energy:
//! sum tau_i thetadot_i + sum F_s sdot = d/dt (kinetic + potential) - wrench power.
//!
//! # Example
//! The first leg of the thesis machine on a slider, and a machine with four legs under preload.
//! ```
//! use nalgebra::{Vector2, Vector3};
//! use trirrr_core::machine::example;
//! use trirrr_core::setpoint::{Pose, Setpoint};
//! use trirrr_linkage::redundant::{
//!     RedundantMachine, RedundantParameters, SliderParameters, SliderState,
//! };
//!
//! let thesis = example();
//! let slider = SliderParameters { direction_rad: 0.0, mass_kg: 0.5 };
//! let parameters = RedundantParameters {
//!     legs: thesis.legs,
//!     sliders: [Some(slider), None, None],
//!     platform: thesis.platform,
//!     gravity_m_s2: thesis.gravity_m_s2,
//!     wrench_force_n: thesis.wrench_force_n,
//!     wrench_torque_nm: thesis.wrench_torque_nm,
//! };
//! let setpoint = Setpoint {
//!     pose: Pose::from_f64(0.25, 0.26, 0.2),
//!     velocity: Vector3::new(0.3, -0.2, 0.5),
//!     acceleration: Vector3::new(2.0, 1.0, -3.0),
//! };
//!
//! let machine = RedundantMachine::<f64, 3>::build(&parameters)?;
//! let slider = SliderState { position: 0.03, velocity: 0.1, acceleration: 0.0 };
//! let sliders = [slider, SliderState::at(0.0), SliderState::at(0.0)];
//! let motion = machine.evaluate(&setpoint, &sliders, &[0.0; 3])?;
//! assert!(motion.sliders[0].is_some() && motion.sliders[1].is_none());
//!
//! let [first, second, third] = thesis.legs;
//! let mut fourth = first;
//! fourth.base_m = Vector2::new(0.0, 0.1);
//! fourth.joint_angle_rad = 210f64.to_radians();
//! let machine = RedundantMachine::<f64, 4>::build(&RedundantParameters {
//!     legs: [first, second, third, fourth],
//!     sliders: [None; 4],
//!     platform: parameters.platform,
//!     gravity_m_s2: parameters.gravity_m_s2,
//!     wrench_force_n: parameters.wrench_force_n,
//!     wrench_torque_nm: parameters.wrench_torque_nm,
//! })?;
//! let norm = |wanted: [f64; 4]| {
//!     let motion = machine.evaluate(&setpoint, &[SliderState::at(0.0); 4], &wanted)?;
//!     let torques = motion.motors.map(|motor| motor.torque * motor.torque);
//!     Ok::<f64, trirrr_core::status::Status>(torques.iter().sum())
//! };
//! assert!(norm([0.0; 4])? < norm([0.1, 0.0, 0.0, -0.1])?);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod distribute;
mod evaluate;
mod machine;
mod parameters;
#[cfg(feature = "std")]
mod placement;
mod qr;
#[cfg(test)]
pub(crate) mod random;
#[cfg(feature = "std")]
pub mod scene;
#[cfg(test)]
mod tests;

pub use evaluate::{RedundantMotion, SliderDrive, SliderState};
pub use machine::{Distances, RedundantMachine};
pub use parameters::{RedundantParameters, SliderParameters};
#[cfg(feature = "std")]
pub use placement::{Placement, PlacementError, Travel, place};
