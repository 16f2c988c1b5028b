//! Number types that the tick runs in, and [`Number`], the bound of its generic code.
//!
//! | type | for | angles are |
//! |---|---|---|
//! | `f64` | host, reference | radians in an `f64` |
//! | `f32` | microcontrollers with an FPU | radians in an `f32` |
//! | [`Fixed`] | microcontrollers without one | 2^-32 of a turn in an `i64` |
//! | [`Coarse`] | measuring the cost and error of the micromath crate | radians in a `Coarse` |
//!
//! Three traits make a number, each in the room that needs it:
//!
//! | trait | has | bounds |
//! |---|---|---|
//! | [`Arithmetic`] and [`WideArithmetic`] | constants, conversions, functions, sums of products | setpoints, linkages, kernels |
//! | [`DyadKernel`] | the intersection of two circles | the tick, as [`Number`] |
//! | `Enclose` of the service's admission | bounds of what a type rounds | the admission |
//!
//! Every function gives the same bits on every machine. None calls the platform's libm, and no
//! sum is contracted into a fused multiply-add.

#[doc(hidden)]
pub use crate::arithmetic::fingerprint;
pub use crate::arithmetic::{
    Arithmetic, Coarse, Fixed, RoundsEachStep, WideArithmetic, cross, dot, fixed, perpendicular,
    sum_cross, sum_dot,
};
use crate::dyad::DyadKernel;

/// A type in which the whole tick can be computed.
///
/// Every type with a [`DyadKernel`] is one. Code that intersects no circles asks for
/// [`WideArithmetic`] or [`Arithmetic`] alone.
pub trait Number: DyadKernel {}

impl<T: DyadKernel> Number for T {}
