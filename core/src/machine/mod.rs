//! The machine: its description ([`Parameters`], SI units, `f64`), and the immutable coefficients
//! that the tick reads ([`Geometry`], any number type).

mod check;
mod error;
mod geometry;
mod parameters;

pub use error::{BuildError, Quantity};
pub use geometry::{Geometry, Leg};
pub use parameters::{
    Elbow, LegParameters, LinkParameters, Parameters, PlatformParameters, example,
};
