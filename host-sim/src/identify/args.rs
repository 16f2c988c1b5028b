//! Arguments of `trirrr identify`.

use crate::arguments::SetArgs;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use clap::{Args, ValueEnum};
use std::path::PathBuf;
use trirrr_calibration::identify::{BodyGroup, IdentificationSetup, MotionColumns};
use trirrr_scene::{CanProtocol, Scene};

/// Angles that motion is taken from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum MotionSource {
    /// Angles that were measured: th1_1 to th1_3
    Measured,
    /// Angles that were commanded: cmd_th1_1 to cmd_th1_3, or thref_1 to thref_3
    Commanded,
}

/// `trirrr identify`.
///
/// Finds masses, centres of mass, inertias and friction of the motors from the angles and torques of a job: drives.csv of `trirrr stream` or
/// `trirrr run`, or plant.csv of `trirrr run`. Says what the motion cannot see, and holds it. Writes identification.json, a figure, and a copy
/// of the scene with the values that were found.
#[derive(Args, Clone, Debug)]
#[command(after_long_help = "\
Columns that are read: t (s), th1_1 to th1_3 (rad), tau1 to tau3 (N m, at the joints); with --motion commanded \
cmd_th1_1 to cmd_th1_3, or thref_1 to thref_3, in place of the angles. Others are not read.")]
pub struct IdentifyArgs {
    /// The scene of the machine, a TOML file
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// Table of angles and torques
    #[arg(value_name = "TELEMETRY.csv")]
    pub telemetry: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Group to identify, too: links, joints, readings. May stand several times [default: platform, motors; readings, too, where the
    /// scene's drives hold a position from command to command]
    #[arg(long, value_name = "GROUP", value_parser = group())]
    pub free: Vec<BodyGroup>,
    /// Group that stays as it is: platform, motors, readings. May stand several times
    #[arg(long, value_name = "GROUP", value_parser = group())]
    pub hold: Vec<BodyGroup>,
    /// Angles that the motion is taken from
    #[arg(long, value_name = "ANGLES", default_value = "measured")]
    pub motion: MotionSource,
    /// Width sigma of the filter, s [default: six distances of samples]
    #[arg(long, value_name = "SECONDS", value_parser = positive)]
    pub smooth: Option<f64>,
    /// Rate of a joint from which on it slides for certain, rad/s
    #[arg(long, value_name = "RAD_S", default_value_t = 0.05, value_parser = positive)]
    pub sliding: f64,
    /// Folder for what is written, made if missing; those of an earlier run go [default: out/NAME-identification]
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Print identification.json in place of the summary
    #[arg(long)]
    pub json: bool,
}

impl IdentifyArgs {
    /// Settings of the identification of the machine of `scene`.
    pub(super) fn setup(&self, scene: &Scene) -> IdentificationSetup {
        let mut setup = IdentificationSetup {
            width_s: self.smooth,
            sliding_rad_s: self.sliding,
            ..IdentificationSetup::default()
        };
        if holds_positions(scene) {
            setup.free.push(BodyGroup::Readings);
        }
        let added = self.free.iter().filter(|group| !setup.free.contains(group));
        let added: Vec<BodyGroup> = added.copied().collect();
        setup.free.extend(added);
        setup.free.retain(|group| !self.hold.contains(group));
        setup
    }

    /// Columns of the angles.
    pub(super) fn columns(&self) -> MotionColumns {
        match self.motion {
            MotionSource::Measured => MotionColumns::Measured,
            MotionSource::Commanded => MotionColumns::Commanded,
        }
    }
}

/// Returns true for drives that hold a position from one command to the next: between ticks their torque rises and falls in step.
fn holds_positions(scene: &Scene) -> bool {
    let drives = scene.drives.iter().flatten();
    let mut protocols = drives.filter_map(|drive| Some(drive.can()?.protocol));
    protocols.any(|protocol| matches!(protocol, CanProtocol::Odrive | CanProtocol::Mit(_)))
}

fn group() -> impl TypedValueParser<Value = BodyGroup> {
    PossibleValuesParser::new(BodyGroup::ALL.map(BodyGroup::name)).try_map(|name| {
        let found = BodyGroup::ALL
            .into_iter()
            .find(|group| group.name() == name);
        found.ok_or("no group of this name")
    })
}

fn positive(text: &str) -> Result<f64, String> {
    match text.parse() {
        Ok(value) if (1e-6..=1e3).contains(&value) => Ok(value),
        _ => Err("expected a number from 0.000001 to 1000".into()),
    }
}
