//! The machine computed a second time, by other means than the core's, for tests and reports that
//! measure the core.
//!
//! | module | what |
//! |---|---|
//! | [`inputs`], [`model`] | kinematics by angles, dynamics by the balance of seven bodies |
//! | [`lagrange`] | the torques once more, by Lagrange's equations, of redundant machines too |
//! | [`scalar`], [`dual`], [`tangent`] | numbers: 31 digits, or with derivatives |
//! | [`results`] | results by name: of the core, the true ones, and their conditions |
//! | [`rounding`] | what a number type rounds by |
//!
//! The reference files of the repository, which have 25 digits from elsewhere, say that it is
//! right: `trirrr_tests`.
#![forbid(unsafe_code)]

pub mod dual;
pub mod inputs;
pub mod lagrange;
pub mod model;
pub mod results;
pub mod rounding;
pub mod scalar;
pub mod tangent;

pub use trirrr_double_double as double_double;
