//! Arguments of `trirrr design`.

use crate::arguments::{DEFAULT_SCENE, SetArgs};
use clap::Args;
use std::path::PathBuf;

/// `trirrr design`.
///
/// Answers what is asked first of a machine on paper: in which of the eight working modes it does the job of the scene, with
/// which torques; where it can work; what its motors and its platform do to each other; how large the forces in its joints are.
/// Writes report.html, which opens from disk, design.json, map.csv, and the figures as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
A scene that is refused in its own working mode is read in the first mode that is not. Cells of the map \
are proven by bounds of all poses in them; ratios are those at the centres of cells.")]
pub struct DesignArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Angle of the platform of the maps, degrees [default: that of the job's start]
    #[arg(long, value_name = "DEGREES", allow_hyphen_values = true, value_parser = degrees)]
    pub alpha: Option<f64>,
    /// Angle by which the platform must be able to turn to both sides, degrees: a place counts if it can
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = turn)]
    pub turn: f64,
    /// Catalogue of motors, a TOML file [default: the one that is shipped]
    #[arg(long, value_name = "FILE.toml")]
    pub motors: Option<PathBuf>,
    /// Cells along the longer side of the map
    #[arg(long, value_name = "COUNT", default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=2048))]
    pub cells: u32,
    /// Folder for what is written, made if missing; results of an earlier command go [default: out/NAME-design]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print design.json in place of the summary
    #[arg(long)]
    pub json: bool,
}

fn within(text: &str, low: f64, high: f64) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (low..=high).contains(&value) => Ok(value),
        _ => Err(format!("expected a number of degrees from {low} to {high}")),
    }
}

fn degrees(text: &str) -> Result<f64, String> {
    within(text, -360.0, 360.0)
}

fn turn(text: &str) -> Result<f64, String> {
    within(text, 0.0, 180.0)
}
