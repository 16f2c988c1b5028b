//! Identification of masses, inertias and friction from angles and torques of the motors.
//!
//! The torque is linear in the masses, first moments, inertias about joints, and coefficients of friction. Its columns are those of
//! the core's own model, evaluated for machines with one of them at a time.

mod bodies;
mod equations;
mod expected;
mod linear;
mod motion;
mod regressor;
mod result;
mod solve;
mod telemetry;
mod units;

pub use bodies::{BODY_COUNT, BodyGroup, BodyVector, body_name, body_unit};
pub use result::{
    ExplainedTorque, Identification, IdentificationRefusal, IdentificationSetup, TorqueFactor,
};
pub use solve::identify;
pub use telemetry::{JointSample, MotionColumns, read_telemetry};
