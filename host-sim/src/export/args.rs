//! Arguments of `trirrr export`.

use crate::arguments::{DEFAULT_SCENE, SetArgs};
use clap::{Args, ValueEnum};
use std::path::PathBuf;

/// `trirrr export`.
///
/// Writes the machine of a scene with its masses, loops and motors for other simulators. It stands at the start of the job.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The plane of the machine is x-y; z points to the viewer, and joints turn about it. Limits of torque and rate are those of the scene. Drives, \
friction, the wrench and the job are left out. A file that is there stays.")]
pub struct ExportArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Format of the file
    #[arg(long, value_enum, default_value_t = ExportFormat::Mjcf)]
    pub format: ExportFormat,
    /// File to write [default: NAME.xml, NAME.sdf or NAME.urdf, after the scene's name]
    #[arg(long, value_name = "FILE")]
    pub out: Option<PathBuf>,
}

/// Format of an exported machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ExportFormat {
    /// MuJoCo: closed loops, motors, a keyframe
    Mjcf,
    /// Gazebo, Drake: a world with gravity, closed loops
    Sdf,
    /// ROS, Pinocchio: a tree; loops as frames that meet, and closed for Gazebo
    Urdf,
}

impl ExportFormat {
    /// Ending of a file's name.
    pub(super) fn ending(self) -> &'static str {
        match self {
            Self::Mjcf => "xml",
            Self::Sdf => "sdf",
            Self::Urdf => "urdf",
        }
    }
}
