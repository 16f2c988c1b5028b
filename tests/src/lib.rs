//! What the tests of this package share.
//!
//! | module | what |
//! |---|---|
//! | [`table`], [`machines`] | the reference files and the machines that they are about |
//! | [`evaluate`] | the core's pipeline on any machine |
//! | [`inputs`], [`model`] | the machine computed a second time, by Newton and Euler |
//! | [`scalar`], [`double_double`], [`dual`] | its numbers: 31 digits, or with derivatives |
//! | [`random`] | random machines and states |
//! | [`thesis_formula`] | the thesis's formulas, errors included |
//! | [`results`], [`bound`] | results by name, and their comparison with \|error\| <= 2 u cond |
#![forbid(unsafe_code)]

pub mod bound;
pub mod double_double;
pub mod dual;
pub mod evaluate;
pub mod inputs;
pub mod machines;
pub mod model;
pub mod random;
pub mod results;
pub mod scalar;
pub mod table;
pub mod thesis_formula;
