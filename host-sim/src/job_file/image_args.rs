//! Arguments that say what a raster image leaves open.

use crate::arguments::{distance, factor};
use clap::Args;
#[cfg(feature = "full")]
use trirrr_toolpath::PathFault;
#[cfg(feature = "full")]
use trirrr_toolpath::raster::{GreyImage, Tones};

/// Distance of rows, mm, where none is given.
const PITCH_MM: f64 = 0.1;

/// Length of a pixel on the machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PitchArg {
    /// So many mm.
    Millimetres(f64),
    /// That which the file of the image names.
    OfFile,
}

fn pitch(text: &str) -> Result<PitchArg, String> {
    match text {
        "file" => Ok(PitchArg::OfFile),
        _ => factor(text).map(PitchArg::Millimetres),
    }
}

/// Size, pitch and tones of a raster image.
#[derive(Args, Clone, Debug, Default)]
pub struct ImageArgs {
    /// Image: its width, mm. Without it a pixel of the file is one of the machine
    #[arg(long, value_name = "MM", requires = "machine", value_parser = factor)]
    pub width: Option<f64>,
    /// Image: length of a pixel on the machine, and distance of rows, mm; `file`: as the file says [default: 0.1]
    #[arg(long, value_name = "MM|file", requires = "machine", value_parser = pitch)]
    pub pitch: Option<PitchArg>,
    /// Image: length before and behind what is burnt, along which the machine has the speed of the row, mm [default: 0]
    #[arg(long, value_name = "MM", requires = "machine", value_parser = distance)]
    pub overscan: Option<f64>,
    /// Image: every row goes along x; without it, every other one goes back
    #[arg(long, requires = "machine")]
    pub one_way: bool,
    /// Image: different powers, with that of the tool off [default: 256]
    #[arg(long, value_name = "COUNT", requires = "machine", value_parser = clap::value_parser!(u16).range(2..=256))]
    pub levels: Option<u16>,
    /// Image: greys become patterns of the levels that there are
    #[arg(long, requires = "machine")]
    pub dither: bool,
    /// Image: what is bright is burnt
    #[arg(long, requires = "machine")]
    pub negative: bool,
}

impl ImageArgs {
    /// Arguments that are given.
    pub(super) fn given(&self) -> impl Iterator<Item = &'static str> {
        let given = [
            (self.width.is_some(), "--width"),
            (self.pitch.is_some(), "--pitch"),
            (self.overscan.is_some(), "--overscan"),
            (self.one_way, "--one-way"),
            (self.levels.is_some(), "--levels"),
            (self.dither, "--dither"),
            (self.negative, "--negative"),
        ];
        given
            .into_iter()
            .filter_map(|(is_given, name)| is_given.then_some(name))
    }

    /// Pitch for `image`, m.
    ///
    /// # Errors
    /// That of the file is asked for, and the file names none.
    #[cfg(feature = "full")]
    pub(super) fn pitch_m(&self, image: &GreyImage) -> Result<f64, PathFault> {
        match self.pitch {
            Some(PitchArg::OfFile) => image.pitch_m(),
            Some(PitchArg::Millimetres(pitch)) => Ok(1e-3 * pitch),
            None => Ok(1e-3 * PITCH_MM),
        }
    }

    /// Overscan, m.
    pub(super) fn overscan_m(&self) -> f64 {
        1e-3 * self.overscan.unwrap_or(0.0)
    }

    /// Width of an image with `columns` at a pitch, m.
    pub(super) fn width_m(&self, columns: u32, pitch_m: f64) -> f64 {
        match self.width {
            Some(width) => 1e-3 * width,
            None => f64::from(columns) * pitch_m,
        }
    }

    /// Tones that are asked for.
    #[cfg(feature = "full")]
    pub(super) fn tones(&self) -> Tones {
        Tones {
            count: self.levels.unwrap_or(256),
            dither: self.dither,
            negative: self.negative,
        }
    }
}
