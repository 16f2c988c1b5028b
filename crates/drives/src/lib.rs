//! Drives: from the angles and torques of a tick to step pulses, PWM duty, and CAN frames.
//!
//! No board and no timer: pins are `embedded_hal::digital::OutputPin`, PWM outputs
//! `embedded_hal::pwm::SetDutyCycle`, the bus is `embedded_can::nb::Can`.
//!
//! | scene | module | once per tick | above the tick |
//! |---|---|---|---|
//! | `kind = "stepper"` | [`stepper`] | [`stepper::Steppers::apply`] | [`stepper::Slots::slot`], from a timer |
//! | `kind = "bldc"` | [`bldc`] | [`bldc::Bldcs::measure`], [`bldc::Bldcs::apply`] | [`bldc::Loops::sample`], from a timer |
//! | `kind = "can"` | [`can`] | [`can::CanDrives::measure`], [`can::CanDrives::apply`] | |
//! | `[tool]` | [`tool`] | [`tool::ToolLine::apply`] | |
//!
//! Each takes the whole [`Output`](trirrr_service::Output) of a tick and neither waits nor panics. A drive that
//! fails gives a [`Failure`], to be latched by [`Foreground::raise`](trirrr_service::board::Foreground::raise). While
//! the output is not enabled, drives are off.
//!
//! The arithmetic has no pin, no timer and no device:
//!
//! ```text
//! tick::Motor ──> joint::Reference ──> joint::Loop ──> set value of the amplifier
//!                        │               (torque)
//!                        └──────────> stepper::StepMotor ──> stepper::Schedule ──> steps
//! ```
//! An inner loop ([`joint`]) runs at a rate of its own, above that of the ticks. [`count`] makes whole numbers of
//! angles and duties.
//!
//! Motors and drives are counted from 0. Angles, rates and torques are those of the joint, positive
//! counter-clockwise. A `reversed` drive turns its joint clockwise when it turns forward.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![cfg_attr(not(test), no_std)]
#![forbid(unsafe_code)]
// Comparisons with not-a-number are false. Guards are written `!(x > limit)`, so that such a value is refused;
// `x <= limit` would let it pass.
#![allow(clippy::neg_cmp_op_on_partial_ord)]

pub mod bldc;
pub mod can;
pub mod count;
mod enable;
mod failure;
pub mod joint;
mod obeying;
pub mod stepper;
pub mod tool;
mod winding;

pub use enable::{Active, Enable};
pub use failure::Failure;
pub use obeying::ObeyingDrives;
