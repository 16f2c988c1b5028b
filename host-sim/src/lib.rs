//! Commands of the binary `trirrr`, as a library for the binary, its tests and benches.
//!
//! [`run`] plays a scene's job through the machine's service, in real time or as fast as the
//! computer can, and writes a table and [`figures`]. [`device`] puts the same service behind a TCP
//! port, and [`bridge`] the line of a board. Both share [`serve`]; [`watch`] looks on, and [`key`] writes their keys.
//! [`stream`] plays the job on a device or a board. [`goals`] sends either to poses, [`machine`] switches its drives.
//! [`redundant`] plays and checks jobs of redundant machines. [`eval`] evaluates a table of cases. [`plan`] plans a path in the least time. [`linkage`] solves other planar mechanisms.
//! [`calibrate`] and [`identify`] find the machine that is there.
//! [`ui`] serves the page to browsers of this computer.
//! [`assemble`] finds every pose for given motor angles. [`export`] writes the machine for other simulators.
//! [`report`] measures errors and run times. All text that any of them says goes through [`terminal`].

#![forbid(unsafe_code)]

mod arguments;
pub mod assemble;
pub mod bridge;
pub mod calibrate;
pub mod check;
pub mod cli;
pub mod completions;
pub mod design;
pub mod device;
pub mod eval;
pub mod export;
pub mod failure;
pub mod figures;
pub mod goals;
pub mod grbl;
pub mod histogram;
pub mod identify;
pub mod init;
pub mod install;
pub mod job_file;
pub mod key;
pub mod lagrange;
pub mod linkage;
pub mod machine;
mod numbers;
mod patched_scene;
pub mod pictures;
pub mod plan;
pub mod realtime;
pub mod recording;
pub mod redundant;
pub mod report;
pub mod results;
pub mod run;
pub mod serve;
pub mod stream;
mod supply;
pub mod terminal;
pub mod ui;
pub mod update;
pub mod watch;
