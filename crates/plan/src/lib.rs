//! The fastest motion along a path within the limits of the machine, and a proof of how near to the
//! optimum it is.
//!
//! A path is a chain of [pieces](piece::Piece). Along it the limits at the motors bound the pace: [`cell`]
//! measures them over short stretches as Taylor models, for the admission's own machine. [`passes`] takes
//! them at their worst and finds a motion that keeps them; [`bound`] takes them at their best and finds a time
//! that no motion along the path comes below.
#![cfg_attr(not(feature = "std"), no_std)]
#![forbid(unsafe_code)]
// A comparison with a value that is not a number is false, and has to refuse.
#![allow(clippy::neg_cmp_op_on_partial_ord)]
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]

#[cfg(feature = "std")]
pub mod alpha;
pub mod bound;
pub mod cell;
#[cfg(feature = "std")]
pub mod corner;
#[cfg(feature = "std")]
pub mod course;
#[cfg(feature = "std")]
mod deviation;
#[cfg(feature = "std")]
mod draft;
#[cfg(feature = "std")]
mod even;
mod extreme;
mod fit;
#[cfg(feature = "std")]
mod grid;
#[cfg(feature = "std")]
mod jerk;
#[cfg(feature = "std")]
mod law;
#[cfg(feature = "std")]
pub mod moves;
#[cfg(feature = "std")]
pub mod natural;
pub mod passes;
#[cfg(feature = "std")]
mod path;
pub mod piece;
#[cfg(feature = "std")]
mod planned;
mod program;
mod rows;
#[cfg(feature = "std")]
mod run;
#[cfg(feature = "std")]
mod timeline;
pub mod window;
