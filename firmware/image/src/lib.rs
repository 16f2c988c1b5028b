//! A scene inside an image.
//!
//! A build script turns a scene into constants and types (`generate`); the image then plays its
//! moves ([`segments`]) and can prove by a [`Checksum`] that it computed the same bits as a host.
//! Where there is nothing to press, [`RuledSwitches`] close by a rule.
#![cfg_attr(not(any(test, feature = "generate")), no_std)]
#![forbid(unsafe_code)]

mod checksum;
#[cfg(feature = "generate")]
pub mod generate;
mod segment;
mod switches;

pub use checksum::Checksum;
pub use segment::{Move, Segment, segments};
pub use switches::RuledSwitches;
