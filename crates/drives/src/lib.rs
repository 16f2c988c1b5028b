//! Drives: what the tick commands, on the pins and frames of the electronics behind it.
//!
//! No board and no timer: pins are `embedded_hal::digital::OutputPin`, PWM outputs
//! `embedded_hal::pwm::SetDutyCycle`, the bus `embedded_can::nb::Can`. The arithmetic is that of
//! [`crate::command`].
//!
//! | scene | module | once per tick | above the tick |
//! |---|---|---|---|
//! | `kind = "stepper"` | [`stepper`] | [`stepper::Steppers::apply`] | [`stepper::Slots::slot`], from a timer |
//! | `kind = "bldc"` | [`bldc`] | [`bldc::Bldcs::apply`] | |
//! | `kind = "can"` | [`can`] | [`can::CanDrives::apply`] | |
//!
//! Each takes the whole [`Output`](trirrr_service::Output) of a tick and neither waits nor
//! panics. What a drive does not do comes back as a [`Failure`], to be latched by
//! [`Foreground::raise`](trirrr_service::Foreground::raise). Where the output is not enabled,
//! the drives are off.
//!
//! Motors and drives are counted from 0; angles, rates and torques are those of the joint, positive
//! counter-clockwise. A `reversed` drive turns its joint clockwise where it thinks that it turns
//! forward.
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
// A comparison with what is not a number is false. Guards are written `!(x > limit)` so that such a
// value is refused, which `x <= limit` would let pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub mod bldc;
pub mod can;
pub mod command;
mod enable;
mod failure;
pub mod stepper;

pub use enable::{Active, Enable};
pub use failure::Failure;
