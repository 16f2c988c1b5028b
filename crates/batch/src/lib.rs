//! Batches of machines and states on a host, over all of its cores.
//!
//! [`table`] evaluates a table, CSV or Arrow, with one machine and one instant in each row.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

pub mod table;
