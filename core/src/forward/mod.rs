//! Forward kinematics: from the motor angles to the pose.
//!
//! | finds | with |
//! |---|---|
//! | the pose near a guess | [`Forward::solve`], Newton-Raphson |
//! | every pose | [`Forward::assemblies`], all assembly modes from the univariate polynomial |
//! | the pose after a small motion | [`Tracker`], which reports a possible change of mode as an error |
//!
//! # The polynomial
//! With the motors at rest the elbows B_i are fixed points and the machine is the 3-RPR problem of
//! three legs of given lengths: circles of radius l2_i about B_i, on which the corners of the
//! platform's triangle have to lie. Let e_i = h_i - h_0 and b_i = B_i - B_0 for i = 1, 2, R the
//! platform's rotation by alpha, p = r2_0 the distal link of leg 0, and m_i = R e_i - b_i. Then
//!
//! ```text
//! |p|^2 = l_0^2,   |p + m_i|^2 = l_i^2     <=>     |p|^2 = l_0^2,   p . m_i = n_i
//! n_i = (l_i^2 - l_0^2 - |m_i|^2) / 2
//! ```
//!
//! The two linear equations give p = (q.y, -q.x) / (m_1 x m_2) with q = n_1 m_2 - n_2 m_1, and the
//! first one leaves the condition on alpha alone
//!
//! ```text
//! f(alpha) = |q|^2 - l_0^2 (m_1 x m_2)^2
//!          = n_1^2 (m_2.m_2) + n_2^2 (m_1.m_1) - 2 n_1 n_2 (m_1.m_2) - l_0^2 (m_1 x m_2)^2 = 0
//! ```
//!
//! n_i, m_i . m_j and m_1 x m_2 are each of the form a + b cos alpha + c sin alpha, so f is a
//! trigonometric polynomial of degree 3: with t = tan(alpha / 2) and (1 + t^2)^3 f a sextic, hence
//! at most six assembly modes. f is, up to a factor, the Cayley-Menger determinant of D and the
//! three points B_i - R h_i, from which D has the distances l2_i. Source of the sextic: Gosselin,
//! Sefrioui, Richard, *Solutions polynomiales au probleme de la cinematique directe des
//! manipulateurs paralleles plans a trois degres de liberte*, Mechanism and Machine Theory 27
//! (1992); the form above is derived here because it keeps every factor small where it matters.
//!
//! The seven coefficients are never formed for the whole circle, where the roots of a small
//! platform or of short links would drown in their rounding. The circle is divided into arcs, and on
//! each arc f is formed afresh, about the arc's middle, in the Bernstein basis with a bound on its
//! rounding error. An arc whose coefficients all have one sign holds no root; one whose
//! differences all have one sign holds a root exactly if f changes sign between its ends; any
//! other is halved. So no root is missed that the number type can tell from its neighbours; the
//! others are reported as undecided.
//!
//! # Example
//! All poses of the thesis machine for the motor angles at the start of its move, then one tick of
//! tracking.
//! ```
//! # use nalgebra::Vector2;
//! # use trirrr_core::machine::{
//! #     Elbow, Geometry, LegParameters, LinkParameters, Parameters, PlatformParameters,
//! # };
//! # let leg = |x: f64, y: f64, degrees: f64| LegParameters {
//! #     base_m: Vector2::new(x, y),
//! #     proximal_m: 0.2,
//! #     distal_m: 0.2,
//! #     joint_radius_m: 0.02,
//! #     joint_angle_rad: degrees.to_radians(),
//! #     elbow: Elbow::Positive,
//! #     proximal: LinkParameters::default(),
//! #     distal: LinkParameters::default(),
//! #     rotor_inertia_kgm2: 0.0,
//! # };
//! # let parameters = Parameters {
//! #     legs: [leg(0.0, 0.433, 150.0), leg(0.5, 0.433, 30.0), leg(0.25, 0.0, 270.0)],
//! #     platform: PlatformParameters {
//! #         mass_kg: 0.5,
//! #         inertia_kgm2: 0.0025,
//! #         com_m: Vector2::new(0.0, 0.0),
//! #         tool_point_m: Vector2::new(0.0, 0.0),
//! #     },
//! #     gravity_m_s2: Vector2::new(0.0, 0.0),
//! #     wrench_force_n: Vector2::new(0.0, 0.0),
//! #     wrench_torque_nm: 0.0,
//! # };
//! use trirrr_core::forward::{Completeness, Forward, Tracker};
//! use trirrr_core::setpoint::Pose;
//!
//! let geometry = Geometry::<f64>::build(&parameters)?;
//! let forward = Forward::build(&parameters, &geometry);
//! let start = Pose::from_f64(0.21, 0.22, 9f64.to_radians());
//! let angles = geometry.motor_angles(&geometry.position(&start)?);
//!
//! let found = forward.assemblies(&angles)?;
//! assert_eq!(found.completeness, Completeness::Complete);
//! assert_eq!(found.modes().len(), 2);
//! let here = forward.nearest(&found, &start).expect("two modes");
//! assert!((here.pose.position - start.position).abs().max() < 1e-14);
//!
//! // It refuses to come nearer than 0.01 to the parallel singularity, and to use over 16 parts.
//! let tracker = Tracker::new(forward, 0.01, 16);
//! let track = tracker.start(&angles, here.pose)?;
//! let track = tracker.follow(&track, &[angles[0] + 0.01, angles[1], angles[2] - 0.01])?;
//! assert!(track.det_a * here.det_a > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod assembly;
#[cfg(test)]
mod exact;
mod isolate;
mod modes;
mod newton;
mod polynomial;
#[cfg(test)]
pub(crate) mod random;
mod search;
pub mod tracking;

pub use modes::{Assemblies, Assembly, AssemblyError, Completeness};
pub use newton::{Forward, ForwardError, ForwardLeg, Found};
pub use tracking::{Track, Tracker, TrackingError};
