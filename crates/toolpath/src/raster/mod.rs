//! Raster images: rows along x, each a chain of runs of equal power.

mod density;
mod grey;
mod rows;

pub use grey::{GreyImage, read_image};
pub use rows::{RasterPath, RasterSetup};

/// Image in powers of the tool, at the pitch of the machine.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Raster {
    /// Pixels of a row.
    columns: usize,
    /// Levels of the pixels, 0 for the tool off, row by row from below.
    levels: Vec<u8>,
    /// Level of the full power.
    full: u8,
}

/// Tones of a [`Raster`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tones {
    /// Different powers, with that of the tool off, from 2 to 256.
    pub count: u16,
    /// Spread what is lost by rounding to the pixels beside and behind (Floyd and Steinberg): greys become patterns.
    pub dither: bool,
    /// Burn what is bright in place of what is dark.
    pub negative: bool,
}
