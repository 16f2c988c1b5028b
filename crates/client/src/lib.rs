//! Host side of the conversation with a machine: what to send next, what an answer means, when to
//! ask again.
//!
//! A [`Dialogue`] has no line and no clock. [`drive`] carries it over a [line](trirrr_line::Line); the owner of an event loop feeds it:
//!
//! ```text
//!            poll(now) ──> Send, Wait, Reconnect, Done
//! port ────> receive(message, now)
//! ```
//! [`exchange`] keeps requests and answers in step; [`JobClient`] plays a job through it, [`GoalClient`] sends the machine to goals,
//! [`ManualClient`] sends the commands of a person and nothing else. `trirrr_line` carries their messages. [`local`] is a machine in the same program, and [`runner`] plays a job on it.
//! [`UpdateClient`] replaces the program of a board.
//! [`Wake`] is the way of a machine to readiness, which [`WakeClient`] goes alone. [`JobRest`] is the rest of a job that was left on its way.
//! `trirrr_scene::offer` turns a scene's job into moves, [`records`] turns telemetry into records,
//! [`drive_records`] puts what the drives do beside, and [`describe`] says in words and SI units what a machine reports.
//!
//! The crate takes no operating system: a page in a browser runs the same clients.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

mod approach;
mod conversation;
pub mod describe;
mod dialogue;
pub mod drive_records;
pub mod exchange;
mod failure;
mod goal_client;
mod job_client;
mod job_mark;
pub mod local;
mod manual_client;
pub mod records;
mod resume;
pub mod runner;
mod scene_image;
#[cfg(test)]
mod tick_line;
mod update_client;
mod user_commands;
mod wake;

pub use approach::short_way;
pub use conversation::Conversation;
pub use dialogue::{Dialogue, Turn, drive};
pub use exchange::{Patience, status_interval};
pub use failure::JobFailure;
pub use goal_client::{GoalClient, GoalFailure};
pub use job_client::{JobClient, JobWork, MoveChecksum, SuppliedMoves, switched_label};
pub use job_mark::{BegunJob, JobMark, JobPlace};
pub use manual_client::ManualClient;
pub use resume::JobRest;
pub use scene_image::SceneImage;
pub use update_client::{ProgramImage, UpdateClient, UpdateFailure};
pub use user_commands::UserCommand;
pub use wake::{Clears, Wake, WakeClient, WakeFailure, WakeStep};
