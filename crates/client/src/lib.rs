//! Host side of the conversation with a machine: what to send next, what an answer means, when to
//! ask again.
//!
//! The client has no port and no clock. The owner of a port feeds it:
//!
//! ```text
//!            poll(now) ──> Send, Wait, Lost, Finished
//! port ────> receive(message, now)
//! ```
//! [`exchange`] keeps requests and answers in step; [`stream`] plays a job through it. [`transport`]
//! carries frames over a serial port or TCP. [`local`] is a machine in the same program. [`job`]
//! turns a scene's job into moves, [`records`] turns telemetry into records, and [`describe`] says
//! in words and SI units what a machine reports.

#![forbid(unsafe_code)]

pub mod describe;
pub mod exchange;
mod failure;
pub mod job;
pub mod local;
pub mod records;
pub mod stream;
pub mod transport;

pub use exchange::Patience;
pub use failure::Failure;
pub use stream::{Action, Ask, Stream};

/// Example of the README, compiled as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
