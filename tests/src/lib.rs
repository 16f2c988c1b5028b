//! What the tests of this package share.
//!
//! | module | what |
//! |---|---|
//! | [`table`], [`machines`] | the reference files and the machines that they are about |
//! | [`evaluate`] | the core's pipeline on any machine |
//! | [`inputs`], [`model`], [`results`] | from `trirrr_truth`: the machine computed a second time |
//! | [`scalar`], [`double_double`], [`dual`] | its numbers: 31 digits, or with derivatives |
//! | [`random`], [`draw`] | random machines and states, and numbers |
//! | [`workspace`] | machines with room to move about in |
//! | [`instant`] | everything that a limit bounds, by the second model |
//! | [`jet`] | numbers with three derivatives by time |
//! | [`motors`] | what the motors need, as numbers |
//! | [`vector_formulas`] | the tick in plain f64 with its functions handed in |
//! | [`thesis_formula`] | the thesis's formulas, errors included |
//! | [`bound`] | comparison of results with \|error\| <= 2 u cond |
#![forbid(unsafe_code)]

pub use trirrr_truth::{double_double, dual, inputs, model, results, rounding, scalar};

pub mod bound;
pub mod draw;
pub mod evaluate;
pub mod instant;
pub mod jet;
pub mod machines;
pub mod motors;
pub mod random;
pub mod table;
pub mod thesis_formula;
pub mod vector_formulas;
pub mod workspace;
