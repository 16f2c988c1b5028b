//! The simulator and its tools, as a library for the binary `host-sim`, its tests and benches.
//!
//! [`run`] plays a scene's job through the service of [`trirrr_core`], in real time or as fast as it
//! goes, and writes a table and [`figures`]. [`device`] puts the same service behind a TCP port;
//! [`stream`] plays the job on it, or on a board. All three build the service in [`machine`], and make
//! records of its [`telemetry`]. [`client`] is the host's side of the conversation with a machine,
//! [`link`] what it goes over.
//!
//! [`eval`] evaluates a table of cases; it chooses the pipeline of a case in [`evaluator`]. [`linkage`]
//! solves other planar mechanisms. [`report`] measures errors and run times.

#![forbid(unsafe_code)]

pub mod cli;
pub mod client;
pub mod device;
pub mod eval;
pub mod evaluator;
pub mod failure;
pub mod figures;
pub mod histogram;
pub mod job;
pub mod link;
pub mod linkage;
pub mod machine;
pub mod pace;
pub mod record;
pub mod recording;
pub mod report;
pub mod run;
pub mod scalar;
pub mod stream;
pub mod telemetry;
pub mod words;
