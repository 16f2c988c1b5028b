//! The scene of an image, its service, and what of the service runs below the tick.
//!
//! Nothing here is in a hurry, and most of an image's code is here: this crate is compiled for size
//! (`[profile.device]` of the workspace), the crate of the board, with the tick, for speed. Generic code
//! is compiled as the crate asks for that uses it, so that nothing generic is given away: the
//! [`Background`] is called, the [`Foreground`] is made anew where it ticks.
#![cfg_attr(target_os = "none", no_std)]

#[cfg(target_os = "none")]
mod background;
#[cfg(target_os = "none")]
pub mod cause;
#[cfg(target_os = "none")]
mod line;
#[cfg(target_os = "none")]
pub mod log;
pub mod scene;
#[cfg(target_os = "none")]
mod service;

#[cfg(target_os = "none")]
pub use background::Background;
#[cfg(target_os = "none")]
pub use line::{BAUD, LOG_BAUD, RECEIVED, Received};
#[cfg(target_os = "none")]
pub use service::{Channels, Foreground, Output, build};
