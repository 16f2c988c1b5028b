//! The simulator and its tools, as a library for the binary `host-sim`, its tests and benches.
//!
//! [`run`] plays a scene's job tick by tick through [`trirrr_core`], in real time or as fast as it
//! goes, and writes a table and [`figures`]. [`eval`] evaluates a table of cases. Both choose the
//! pipeline of the scene or case in [`evaluator`] and speak in [`record`]s. [`linkage`] solves other
//! planar mechanisms. [`client`] is the host's side of the conversation with a machine. [`report`]
//! measures errors and run times.

#![forbid(unsafe_code)]

pub mod cli;
pub mod client;
pub mod eval;
pub mod evaluator;
pub mod failure;
pub mod figures;
pub mod integrate;
pub mod job;
pub mod link;
pub mod linkage;
pub mod placement;
pub mod plant;
pub mod record;
pub mod recording;
pub mod report;
pub mod run;
pub mod scalar;
pub mod telemetry;
pub mod words;
