//! Guaranteed error at the tool, and guaranteed torque of the motors, of a machine whose parts have tolerances.
//!
//! A scene gives half-widths in `[tolerances]`. [`ToleranceAnalysis`] divides its job into intervals of time. On each it
//! runs the core's kinematics and dynamics on [box models](model), which enclose a quantity over the interval and over
//! all parameters at once, and proves by Krawczyk's test that the loops close. `docs/tolerances.md` says what is
//! guaranteed.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod analysis;
mod closure;
mod coefficients;
mod machine;
pub mod model;
mod parameter;
mod worst;

pub use analysis::{Contribution, TimeSpan, ToleranceAnalysis, ToolError, Unanalysable};
pub use parameter::Parameter;
pub use worst::{Margin, WorstCase};
