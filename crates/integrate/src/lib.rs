//! Initial value problems of ordinary differential equations: [`System`] is what is integrated,
//! [`Method`] is how, [`Integrator`] does it. Knows nothing of what the equations describe.
//!
//! | method | order | for | step |
//! |---|---|---|---|
//! | semi-implicit Euler | 1 | rough and fast, mechanical systems | fixed |
//! | RK4 | 4 | smooth systems, a known cost | fixed |
//! | Dormand-Prince 5(4) | 5 | smooth systems | from the tolerance |
//! | Radau IIA | 5 | stiff systems | from the tolerance |
//!
//! A run ends at its end, at an event that stops it, or in a [`Failure`] that names the cause: it
//! never hangs (steps are counted against a budget) and never goes on with what is not a number.
//! Events are located along the [`Dense`] output of each step, and the step is then taken again to
//! end there. A controller that is sampled gets its samples at k/rate exactly, where the step ends
//! and starts afresh. No step allocates.
//!
//! [`Spectrum`] says from the eigenvalues of the linearisation how stiff a system is:
//! [`stability::choose`] chooses a method by that, [`stability::warning`] says what speaks against
//! one that somebody chose.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod control;
pub mod dense;
mod dormand_prince;
mod events;
pub mod failure;
pub mod integrator;
pub mod jacobian;
mod linear;
pub mod method;
mod radau;
mod rk4;
mod semi_implicit_euler;
pub mod stability;
mod stepper;
pub mod system;
pub mod tally;
mod walk;

pub use dense::Dense;
pub use failure::{Failure, Reason, Unfit};
pub use integrator::Integrator;
pub use method::Method;
pub use stability::Spectrum;
pub use system::{Action, Direction, Matrix, System};
pub use tally::Tally;
pub use walk::End;
