//! Arguments of `trirrr assemble`.

use crate::arguments::{DEFAULT_SCENE, SetArgs, pose_deg, pose_rad, three};
use clap::Args;
use std::path::PathBuf;

/// `trirrr assemble`.
///
/// Finds every pose in which the platform fits between three motors that stand still: up to six assembly modes. Beside them it lists
/// the motor angles of all eight working modes at the pose of the scene's own mode. Writes assemblies.csv, working_modes.csv and figures as SVG.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Motor angles are those of the proximal links, absolute and counter-clockwise. Without an option they are those at the start of the scene's job.")]
pub struct AssembleArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Where the motors stand.
    #[command(flatten)]
    pub standing: StandingArgs,
    /// Print one JSON object in place of the tables
    #[arg(long)]
    pub json: bool,
    /// Folder for what is written, made if missing; those of an earlier run go [default: out/NAME-assemble]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
}

/// Angles of the motors, or a pose that gives them in the working mode of the scene.
#[derive(Args, Clone, Copy, Debug, Default)]
#[group(multiple = false)]
pub struct StandingArgs {
    /// Angles of the three motors, degrees
    #[arg(long, value_name = "TH1,TH2,TH3", value_parser = degrees)]
    pub angles_deg: Option<[f64; 3]>,
    /// Angles of the three motors, rad
    #[arg(long, value_name = "TH1,TH2,TH3", value_parser = radians)]
    pub angles_rad: Option<[f64; 3]>,
    /// Pose of the platform: x and y in m, angle in degrees
    #[arg(long, value_name = "X,Y,ALPHA", value_parser = pose_deg)]
    pub at_deg: Option<[f64; 3]>,
    /// Pose of the platform: x and y in m, angle in rad
    #[arg(long, value_name = "X,Y,ALPHA", value_parser = pose_rad)]
    pub at_rad: Option<[f64; 3]>,
}

/// Where the motors stand, in rad and m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Standing {
    /// At the start of the scene's job.
    Start,
    /// At these angles.
    Angles([f64; 3]),
    /// Where the platform is at this pose.
    Pose([f64; 3]),
}

impl StandingArgs {
    pub(super) fn standing(&self) -> Standing {
        let angles = self.angles_deg.map(|angles| angles.map(f64::to_radians));
        let at = self.at_deg.or(self.at_rad);
        match (angles.or(self.angles_rad), at) {
            (Some(angles), _) => Standing::Angles(angles),
            (None, Some(pose)) => Standing::Pose(pose),
            (None, None) => Standing::Start,
        }
    }
}

fn degrees(text: &str) -> Result<[f64; 3], String> {
    three(text, ["TH1", "TH2", "TH3"], [3600.0; 3], "degrees")
}

fn radians(text: &str) -> Result<[f64; 3], String> {
    three(
        text,
        ["TH1", "TH2", "TH3"],
        [20.0 * std::f64::consts::PI; 3],
        "rad",
    )
}
