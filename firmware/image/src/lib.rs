//! A scene inside an image.
//!
//! A build script turns a scene into constants and types (`generate`), and a board file into pins (`board`). The image plays the scene's moves
//! ([`segments`]) and proves by a [`Checksum`] that it computed the same bits as a host. [`RuledSwitches`]
//! stand in for the switches that an emulator lacks.
#![cfg_attr(not(any(test, feature = "generate")), no_std)]
#![forbid(unsafe_code)]

#[cfg(feature = "generate")]
pub mod board;
mod checksum;
#[cfg(feature = "generate")]
pub mod generate;
#[cfg(feature = "generate")]
pub mod ram;
mod segment;
mod switches;

pub use checksum::Checksum;
pub use segment::{Move, Segment, segments};
pub use switches::RuledSwitches;
