//! Commands of the binary `trirrr`, as a library for the binary, its tests and benches.
//!
//! [`run`] plays a scene's job through the machine's service, in real time or as fast as the
//! computer can, and writes a table and [`figures`]. [`device`] puts the same service behind a TCP
//! port, and [`bridge`] the line of a board. Both share [`serve`]; [`watch`] looks on, and [`key`] writes their keys.
//! [`stream`] plays the job on a device or a board. [`goals`] sends either to poses, [`machine`] switches its drives.
//! [`redundant`] plays and checks jobs of redundant machines. `eval` evaluates a table of cases. [`plan`] plans a path in the least time. `linkage` solves other planar mechanisms.
//! `calibrate` and `identify` find the machine that is there.
//! `ui` serves the page to browsers of this computer.
//! `assemble` finds every pose for given motor angles. `export` writes the machine for other simulators.
//! `report` measures errors and run times. All text that any of them says goes through [`terminal`].

#![forbid(unsafe_code)]
// Commands of `trirrr-full` alone use some of what is here.
#![cfg_attr(not(feature = "full"), allow(dead_code, unused_imports))]

mod arguments;
#[cfg(feature = "full")]
pub mod assemble;
pub mod bridge;
#[cfg(feature = "full")]
pub mod calibrate;
pub mod check;
pub mod cli;
#[cfg(feature = "full")]
pub mod completions;
#[cfg(feature = "full")]
pub mod design;
pub mod device;
mod dialogue;
#[cfg(feature = "full")]
pub mod eval;
#[cfg(feature = "full")]
pub mod export;
pub mod failure;
pub mod figures;
pub mod goals;
pub mod grbl;
#[cfg(not(feature = "full"))]
mod handover;
pub mod histogram;
#[cfg(feature = "full")]
pub mod identify;
pub mod init;
#[cfg(feature = "full")]
pub mod install;
pub mod job_file;
pub mod key;
#[cfg(feature = "full")]
pub mod linkage;
pub mod machine;
mod numbers;
#[cfg(feature = "full")]
mod patched_scene;
pub mod pictures;
pub mod plan;
mod player;
pub mod program;
pub mod realtime;
pub mod recording;
pub mod redundant;
#[cfg(feature = "full")]
pub mod report;
pub mod results;
pub mod run;
pub mod serve;
pub mod stream;
mod supply;
pub mod terminal;
pub mod tick_record;
#[cfg(feature = "full")]
pub mod ui;
#[cfg(feature = "full")]
pub mod update;
pub mod watch;
