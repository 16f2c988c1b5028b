//! Fuzz targets: each takes any bytes and panics if what has to hold does not.

mod bytes;
mod commands;
mod decoder;
mod watch;

pub use commands::{commands, play};
pub use decoder::decoder;
pub use watch::Reached;

/// A target.
pub type Target = fn(&[u8]);

/// All of them, by the names of their corpora in `tests/fuzz/corpus`.
pub const ALL: [(&str, Target); 2] = [("commands", commands), ("decoder", decoder)];
