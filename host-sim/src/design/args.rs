//! Arguments of `trirrr design`.

use crate::arguments::{DEFAULT_SCENE, SetArgs};
use crate::pictures::PictureArgs;
use clap::Args;
use std::path::PathBuf;
use trirrr_design::optimise::{Objective, VariedKey};

/// `trirrr design`.
///
/// Answers what is asked first of a machine on paper: in which of the eight working modes it does the job of the scene, with
/// which torques; where it can work; what its motors and its platform do to each other; how large the forces in its joints are.
/// Writes report.html, which opens from disk, design.json, map.csv, and the figures as SVG.
///
/// With --vary and --for: looks for the machine that does the job best, within bounds of values of the scene, and writes it as
/// best.toml, with study.html, study.json and evaluations.csv.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
A scene that is refused in its own working mode is read in the first mode that is not. Cells of the map \
are proven by bounds of all poses in them; ratios are those at the centres of cells.\n\n\
A study: trirrr design scenes/design/lift.toml --vary mode --vary 'machine.leg[*].distal_m=0.1..0.2' --for torque")]
pub struct DesignArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Angle of the platform of the maps, degrees [default: that of the job's start]
    #[arg(long, value_name = "DEGREES", value_parser = degrees)]
    pub alpha: Option<f64>,
    /// Angle by which the platform must be able to turn to both sides, degrees: a place counts if it can
    #[arg(long, value_name = "DEGREES", default_value_t = 0.0, value_parser = turn)]
    pub turn: f64,
    /// Force on D in the map of torques, N, in its worst direction
    #[arg(long, value_name = "N", default_value_t = 10.0, value_parser = not_negative)]
    pub load_n: f64,
    /// Acceleration of D in the map of torques, m/s^2, in its worst direction
    #[arg(long, value_name = "M_S2", default_value_t = 1.0, value_parser = not_negative)]
    pub acceleration_m_s2: f64,
    /// Stiffness between each motor and its link, N m/rad, for the map of compliance [default: that of the scene]
    #[arg(long, value_name = "NM_RAD", value_parser = positive)]
    pub stiffness_nm_rad: Option<f64>,
    /// Catalogue of motors, a TOML file [default: the one that is shipped]
    #[arg(long, value_name = "FILE.toml")]
    pub motors: Option<PathBuf>,
    /// Supply of the motors, V, for those whose winding the catalogue has [default: that of the catalogue]
    #[arg(long, value_name = "VOLTS", value_parser = volts)]
    pub supply_v: Option<f64>,
    /// Cells along the longer side of the map
    #[arg(long, value_name = "COUNT", default_value_t = 256, value_parser = clap::value_parser!(u32).range(16..=2048))]
    pub cells: u32,
    /// Folder for what is written, made if missing; those of an earlier run go [default: out/NAME-design]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print design.json, or study.json, in place of the summary
    #[arg(long)]
    pub json: bool,
    /// Figures as PNG.
    #[command(flatten)]
    pub pictures: PictureArgs,
    /// A study of other values.
    #[command(flatten)]
    pub vary: StudyArgs,
}

/// Arguments of a study.
#[derive(Args, Clone, Debug)]
pub struct StudyArgs {
    /// Vary one number within bounds, or the working mode: KEY=LOW..HIGH, with a key as in --set; several keys with commas between
    /// them, or `[*]` for each leg, share the number; mode, or mode=+++,---. May stand several times
    #[arg(long, value_name = "KEY=LOW..HIGH", requires = "objectives")]
    pub vary: Vec<VariedKey>,
    /// Quantity to make as good as possible, or two with a comma between them: workspace, disc, rectangle, torque, rms, time
    #[arg(
        long = "for",
        value_name = "QUANTITY",
        value_delimiter = ',',
        id = "objectives",
        requires = "vary"
    )]
    pub objectives: Vec<Objective>,
    /// Most candidates that are looked at
    #[arg(long, value_name = "COUNT", default_value_t = 400, requires = "vary", value_parser = clap::value_parser!(u32).range(1..=10_000_000))]
    pub evaluations: u32,
    /// Begin of the random numbers: the same seed gives the same result, on any number of cores
    #[arg(long, value_name = "NUMBER", default_value_t = 1, requires = "vary")]
    pub seed: u64,
    /// Do part I of N of the study: its own random numbers, its own modes where there are enough
    #[arg(long, value_name = "I/N", requires = "vary", value_parser = shard)]
    pub shard: Option<[u32; 2]>,
    /// Put the parts of a study together: the study.json of each
    #[arg(long, value_name = "STUDY.json", num_args = 1.., conflicts_with_all = ["vary", "objectives"])]
    pub merge: Vec<PathBuf>,
}

/// Part of a study and how many there are, from 1.
fn shard(text: &str) -> Result<[u32; 2], String> {
    let parts = text
        .split_once('/')
        .map(|(part, count)| (part.parse(), count.parse()));
    match parts {
        Some((Ok(part), Ok(count))) if (1..=count).contains(&part) && count <= 10_000 => {
            Ok([part, count])
        }
        _ => Err("expected I/N, such as 1/4: a part from 1 to N, at most 10000 of them".into()),
    }
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

fn volts(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (1.0..=1000.0).contains(&value) => Ok(value),
        _ => Err("expected a number of volts from 1 to 1000".into()),
    }
}

fn turn(text: &str) -> Result<f64, String> {
    within(text, 0.0, 180.0)
}

fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (0.0..=1e9).contains(&value) => Ok(value),
        _ => Err("expected a number from 0 to 1000000000".into()),
    }
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (1e-9..=1e15).contains(&value) => Ok(value),
        _ => Err("expected a number greater than 0, at most 1e15".into()),
    }
}
