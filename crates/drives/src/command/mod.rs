//! Drive commands: from what a motor has to do to what its electronics are told.
//!
//! ```text
//! tick::Motor ──> joint::Reference ──> joint::Loop ──> bldc::Bldc ──> current, duty
//!                        │               (torque)
//!                        └──────────> stepper::StepMotor ──> stepper::Schedule ──> steps
//! ```
//! [`count`] makes whole numbers of angles and duties, [`winding`] keeps the turns of a joint.
//!
//! Arithmetic only: no pin, no timer, no device. The inner loop runs at a rate of its own, above
//! that of the ticks; [`joint::Reference::after`] carries a tick's reference over to it.

pub mod bldc;
pub mod count;
pub mod joint;
pub mod stepper;
pub mod winding;
