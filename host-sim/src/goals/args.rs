//! Arguments of `trirrr goto`, `jog` and `follow`.

use crate::arguments::{DEFAULT_SCENE, SetArgs, factor, number_type};
use crate::failure::CliError;
use crate::numbers;
use crate::stream::{PortArgs, patience};
use clap::Args;
use std::path::PathBuf;
use std::time::Duration;
use trirrr_client::Patience;
use trirrr_core::units::Units;
use trirrr_line::{Port, Retry};
use trirrr_scene::{NumberType, Scene};
use trirrr_service::ServiceNumber;

/// The machine that is sent to goals.
#[derive(Args, Clone, Debug)]
pub struct MachineArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// The line to the board.
    #[command(flatten)]
    pub line: PortArgs,
    /// Number type of the board's image [default: the scene's]
    #[arg(long, value_parser = number_type())]
    pub scalar: Option<NumberType>,
    /// Seconds without an answer, or without the port, after which the command gives up
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = factor)]
    pub patience: f64,
    /// Move at so many percent of normal speed, 1 to 100
    #[arg(long, value_name = "PERCENT", value_parser = clap::value_parser!(u8).range(1..=100))]
    pub feed: Option<u8>,
}

impl MachineArgs {
    /// Returns the command `name` with `options` for this machine, for a user.
    pub(crate) fn command(&self, name: &str, options: &str) -> String {
        let (scene, port) = (self.scene.display(), &self.line.port);
        format!("`trirrr {name} {scene} --port {port}{options}`")
    }

    /// Opens the port. Returns it with the units of the machine of `scene` in the number type `N`, and the patience with the board.
    ///
    /// # Errors
    /// Refused: the scene in this number type. Failed: the port.
    pub(crate) fn open<N: ServiceNumber>(
        &self,
        scene: &Scene,
    ) -> Result<(Port, Units, Patience), CliError> {
        let units = numbers::units::<N>(scene)?;
        let wait = Duration::from_secs_f64(self.patience);
        let port = self.line.open(Retry::For(wait))?;
        Ok((port, units, patience(wait)))
    }
}

/// `trirrr goto`.
///
/// Moves a machine to a pose in the least time that it can prove, from rest or from any motion: what is under way is cut,
/// and moves behind it are dropped. Ends where the machine stands.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The scene must be the one that the board's image was built from, and have quintics: paths, or `curve = \"quintic\"`. Ctrl-C \
stops the machine on its path.")]
pub struct GotoArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// x of the pose, m
    #[arg(long, value_name = "M")]
    pub x: f64,
    /// y of the pose, m
    #[arg(long, value_name = "M")]
    pub y: f64,
    /// Angle of the platform, rad [default: as it is]
    #[arg(long, value_name = "RAD")]
    pub alpha: Option<f64>,
}

/// `trirrr park`.
///
/// Moves a machine to the start of the scene's job, or to another pose: straight, slowly, with the tool off, by a move that the
/// machine proves as any other. Needs no quintics.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The scene must be the one that the board's image was built from. Ctrl-C stops the machine on its path.")]
pub struct ParkArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// x of the pose, m [default: that of the start of the job]
    #[arg(long, value_name = "M")]
    pub x: Option<f64>,
    /// y of the pose, m [default: that of the start of the job]
    #[arg(long, value_name = "M")]
    pub y: Option<f64>,
    /// Angle of the platform, rad [default: that of the start of the job]
    #[arg(long, value_name = "RAD")]
    pub alpha: Option<f64>,
}

/// `trirrr follow`.
///
/// Reads poses, a line each, and sends the machine to the newest of them: x and y in m, then alpha in rad if it changes, then
/// the velocity there if it is not zero, with commas or blanks between. Lines that begin with a letter or # are skipped.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
A pose that comes before the machine has taken the last one takes its place. At the end of the poses the command waits until \
the machine stands at the last, or on its way there if the last is in motion. Ctrl-C stops the machine on its path.")]
pub struct FollowArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// The poses, such as a CSV file [default: standard input]
    #[arg(long, value_name = "FILE")]
    pub poses: Option<PathBuf>,
    /// Seconds from one pose to the next [default: as they come]
    #[arg(long, value_name = "SECONDS", value_parser = factor)]
    pub every: Option<f64>,
}

/// `trirrr jog`.
///
/// Moves a machine by lines from standard input: steps from the last goal, velocities that last until they are not renewed,
/// and the commands of `stream`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
`step DX DY [DALPHA]` moves by so much, m and rad. `speed VX VY [VALPHA]` moves at this velocity, m/s and rad/s, for the time of \
--renew; another such line before its end keeps the machine moving. `hold`, `resume`, `stop` and `feed PERCENT` are those of \
`stream`, `disable` switches the drives off. The machine comes to rest by itself when this program ends or the line breaks. The end of standard \
input ends the jog. A line that is none is left out, and the exit code is 2.")]
pub struct JogArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Seconds for which a `speed` lasts
    #[arg(long, value_name = "SECONDS", default_value = "0.5", value_parser = factor)]
    pub renew: f64,
}
