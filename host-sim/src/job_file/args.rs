//! Arguments of commands that take a job file in place of a scene.

use super::drawing_args::DrawingArgs;
use super::image_args::ImageArgs;
use super::kind::JobKind;
use crate::arguments::{SetArgs, expected};
use clap::Args;
use std::path::PathBuf;
use trirrr_jobs::JobOptions;
use trirrr_toolpath::ToolPlace;
use trirrr_toolpath::gcode::ZWords;

/// Job that stands in a file of its own.
#[derive(Args, Clone, Debug)]
pub struct JobFileArgs {
    /// Scene of the machine that does the job of the file: the scene's own job gives the start pose alone
    #[arg(long, value_name = "SCENE.toml")]
    pub machine: Option<PathBuf>,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Zero point of the file in the frame of the machine: x and y in mm, and alpha in degrees if it is not 0
    #[arg(long, value_name = "X,Y[,ALPHA]", requires = "machine", value_parser = origin)]
    pub origin: Option<[f64; 3]>,
    /// Distance by which a corner may be rounded, mm; 0: the machine stops at each. `G64 P` of the file goes before it
    #[arg(long, value_name = "MM", requires = "machine", default_value_t = 0.01, value_parser = crate::arguments::distance)]
    pub corner: f64,
    /// S for the full power of the tool
    #[arg(long, value_name = "S", requires = "machine", default_value_t = 1000.0, value_parser = crate::arguments::factor)]
    pub full_power: f64,
    /// Sense of words of Z.
    #[command(flatten)]
    pub z: ZArgs,
    /// Play the file so many times, one after the other
    #[arg(long, value_name = "TIMES", requires = "machine", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub repeat: u32,
    /// What a drawing or a table leaves open.
    #[command(flatten)]
    pub drawing: DrawingArgs,
    /// Size, pitch and tones of an image.
    #[command(flatten)]
    pub image: ImageArgs,
}

/// Sense of words of Z in G-code.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct ZArgs {
    /// Leave out words of Z: the machine has no such axis. A program that lifts the tool with it on is refused
    #[arg(long, conflicts_with = "tool_by_z")]
    pub ignore_z: bool,
    /// Switch the tool by Z, as a pen: on at this height of the file and below it, off above, whatever G0 and G1 say [mm; 0 without a number]
    #[arg(long, value_name = "Z0", num_args = 0..=1, default_missing_value = "0", value_parser = height)]
    pub tool_by_z: Option<f64>,
}

impl ZArgs {
    /// One of them is given.
    pub(super) fn is_given(&self) -> bool {
        self.ignore_z || self.tool_by_z.is_some()
    }

    pub(crate) fn words(&self) -> ZWords {
        match (self.tool_by_z, self.ignore_z) {
            (Some(height_mm), _) => ZWords::Tool {
                on_at_m: 1e-3 * height_mm,
            },
            (None, true) => ZWords::Ignored,
            (None, false) => ZWords::Refused,
        }
    }
}

fn height(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.abs() <= 1e6 => Ok(value),
        _ => Err(expected(text, "a height from -1000000 to 1000000 (mm)")),
    }
}

impl Default for JobFileArgs {
    /// Arguments where none is given.
    fn default() -> Self {
        Self {
            machine: None,
            set: SetArgs::default(),
            origin: None,
            corner: 0.01,
            full_power: 1000.0,
            z: ZArgs::default(),
            repeat: 1,
            drawing: DrawingArgs::default(),
            image: ImageArgs::default(),
        }
    }
}

impl JobFileArgs {
    /// The options that the arguments give, in SI units.
    pub(crate) fn options(&self) -> JobOptions {
        let [x, y, alpha] = self.origin.unwrap_or([0.0; 3]);
        JobOptions {
            origin: ToolPlace {
                position_m: [1e-3 * x, 1e-3 * y],
                alpha_rad: alpha.to_radians(),
            },
            corner_m: 1e-3 * self.corner,
            full_power: self.full_power,
            z: self.z.words(),
            repeat: self.repeat,
            drawing: self.drawing.options(),
        }
    }

    /// First argument that is given and not for a file of this `kind`.
    pub(super) fn not_for(&self, kind: JobKind) -> Option<&'static str> {
        let of_images = self.image.given().map(|name| (name, &[JobKind::Image][..]));
        let mut given = self.drawing.given().chain(of_images);
        given
            .find(|(_, kinds)| !kinds.contains(&kind))
            .map(|(name, _)| name)
    }
}

pub(crate) fn origin(text: &str) -> Result<[f64; 3], String> {
    let mut values = Vec::new();
    for part in text.split(',') {
        match part.trim().parse::<f64>() {
            Ok(value) if value.abs() <= 1e6 => values.push(value),
            _ => return Err(format!("{part:?} is no number from -1000000 to 1000000")),
        }
    }
    match values[..] {
        [x, y] => Ok([x, y, 0.0]),
        [x, y, alpha] => Ok([x, y, alpha]),
        _ => Err("expected X,Y or X,Y,ALPHA: mm and degrees, with a decimal point".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_zero_point_has_two_or_three_numbers() {
        assert_eq!(origin("250,-1.5"), Ok([250.0, -1.5, 0.0]));
        assert_eq!(origin("1, 2, 45"), Ok([1.0, 2.0, 45.0]));
        for wrong in ["", "1", "1,2,3,4", "1;2", "1,nan", "1,inf", "1,1e7"] {
            assert!(origin(wrong).is_err(), "{wrong}");
        }
    }
}
