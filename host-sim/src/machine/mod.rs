//! `trirrr enable`, `disable`, `drives`, `tool`, `probe` and `output`: switches the drives of a machine, shows what they tell, mounts tools,
//! probes, and switches spare outputs.

mod geometry;
mod output;
mod probe;
mod talk;
mod tool;

pub(crate) use geometry::{ReplacedGeometry, replace_geometry};
pub use output::{OutputArgs, output};
pub use probe::{ProbeArgs, probe};
pub(crate) use tool::require_mounted;
pub use tool::{ToolArgs, tool};

use crate::dialogue::carry;
use crate::failure::CliError;
use crate::goals::MachineArgs;
use crate::numbers::{in_boards_numbers, refused};
use crate::stream::conversation;
use crate::terminal::print;
use clap::Args;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;
use talk::Talk;
use trirrr_client::describe::{self, Units};
use trirrr_client::{Clears, Wake, WakeClient, WakeFailure, local};
use trirrr_core::forward::Forward;
use trirrr_core::machine::Geometry;
use trirrr_line::Retry;
use trirrr_protocol::message::{
    Acting, Command, DriveReading, DriveSample, Message, Reply, State, Status,
};
use trirrr_scene::{Scene, in_number_type};
use trirrr_service::ServiceNumber;

/// Time from one look at a machine that is on its way to the next.
const LOOK: Duration = Duration::from_millis(20);

/// `trirrr enable`.
///
/// Switches the drives of a machine on, where its motors are: checks each drive first, and says why not.
#[derive(Args, Clone, Debug)]
pub struct EnableArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Acknowledge a latched fault and clear the errors of the drives before
    #[arg(long)]
    pub clear: bool,
}

/// `trirrr disable`.
///
/// Brings a machine to rest on its path, lets its brake engage, and switches its drives off.
#[derive(Args, Clone, Debug)]
pub struct DisableArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
}

/// `trirrr drives`.
///
/// Shows what the drives of a machine tell: state, joint angle, rate, torque, temperature, supply and error, and the pose of the platform at
/// these angles. Switches nothing on.
#[derive(Args, Clone, Debug)]
pub struct DrivesArgs {
    /// The machine.
    #[command(flatten)]
    pub machine: MachineArgs,
    /// Lines a second, at most the ticks
    #[arg(long, value_name = "HZ", default_value = "2", value_parser = crate::arguments::factor)]
    pub rate: f64,
    /// End after so many lines [default: at Ctrl-C]
    #[arg(long, value_name = "LINES")]
    pub lines: Option<u32>,
}

/// Switches the drives on.
///
/// # Errors
/// Refused: the scene. Failed: the port, the board, a fault, or a drive that does not go on.
pub fn enable(args: &EnableArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.machine.set.scene(&args.machine.scene)?;
    in_boards_numbers(
        args.machine.scalar,
        scene.number,
        |number| in_number_type!(number, N => wake::<N>(args, &scene, stop)),
    )
}

fn wake<N: ServiceNumber>(
    args: &EnableArgs,
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let (port, units, patience) = args.machine.open::<N>(scene)?;
    let clears = match args.clear {
        true => Clears::Everything,
        false => Clears::Nothing,
    };
    let wake = Wake::<N>::new(clears, false, None);
    let mut client = WakeClient::new(wake, local::hello::<N>(scene), patience, conversation());
    let woken = carry(&mut client, &mut port.retrying(Retry::Never), stop)?;
    let units = Units::of_scene(scene, &units);
    match (woken, client.status()) {
        // The drives are on.
        (Ok(()) | Err(WakeFailure::Unhomed | WakeFailure::Cleared), Some(status)) => {
            say(&units, status)
        }
        (Ok(()), None) => Ok(()),
        (Err(failure), _) => {
            let text = failure.describe(&units);
            Err(match failure {
                WakeFailure::Fault(_) => {
                    let command = args.machine.command("enable", " --clear");
                    CliError::Failed(format!("{text}; {command} acknowledges it"))
                }
                WakeFailure::Refused(refusal) => refused(&refusal, text),
                _ => CliError::Failed(text),
            })
        }
    }
}

/// Switches the drives off.
///
/// # Errors
/// As [`enable`].
pub fn disable(args: &DisableArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.machine.set.scene(&args.machine.scene)?;
    in_boards_numbers(args.machine.scalar, scene.number, |number| {
        in_number_type!(number, N => {
            let mut talk = Talk::<N>::open(&args.machine, &scene, stop)?;
            talk.done(Command::Disable)?;
            let status = settled(&mut talk)?;
            match status.state {
                State::Disabled | State::Fault => say(&talk.units(), &status),
                state => Err(CliError::Failed(format!(
                    "the machine is not off: {}",
                    describe::state(state, status.acting)
                ))),
            }
        })
    })
}

/// Shows what the drives tell, until Ctrl-C.
///
/// # Errors
/// As [`enable`]; refused: a machine whose drives tell nothing.
pub fn drives(args: &DrivesArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.machine.set.scene(&args.machine.scene)?;
    in_boards_numbers(
        args.machine.scalar,
        scene.number,
        |number| in_number_type!(number, N => show::<N>(args, &scene, stop)),
    )
}

/// Waits for a state that lasts.
fn settled<N: ServiceNumber>(talk: &mut Talk<'_, N>) -> Result<Status<N>, CliError> {
    loop {
        let status = talk.status()?;
        let passes = matches!(
            status.state,
            State::Enabling | State::Disabling | State::Stopping | State::Reacting
        );
        if !passes {
            return Ok(status);
        }
        talk.listen(LOOK)?;
    }
}

/// Prints the state, and the pose if it is known.
fn say<N: ServiceNumber>(units: &Units, status: &Status<N>) -> Result<(), CliError> {
    let mut text = describe::state(status.state, Acting::Nothing);
    if let Some([x, y, alpha]) = geometry::stands(status, units) {
        text += &format!(", stands at x {x:.6} m, y {y:.6} m, alpha {alpha:.6} rad");
    }
    print(&format!("{text}\n"))
}

fn show<N: ServiceNumber>(
    args: &DrivesArgs,
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<(), CliError> {
    let mut talk = Talk::<N>::open(&args.machine, scene, stop)?;
    let every = (scene.tick_rate_hz / args.rate)
        .round()
        .clamp(1.0, f64::from(u16::MAX));
    match talk.ask(Command::Drives {
        every: every as u16,
    })? {
        Reply::Done => {}
        Reply::Refused(refusal) => return Err(talk.refused(&refusal)),
        _ => return Err(talk::other_answer()),
    }
    let platform = MeasuredPlatform::of(scene)?;
    let mut left = args.lines.unwrap_or(u32::MAX);
    while left > 0 && !stop.load(Ordering::Relaxed) {
        for message in talk.listen(LOOK)? {
            if let Message::Drives(sample) = message
                && left > 0
            {
                let line = platform.line(&sample, &talk.units());
                print(&format!("{line}\n"))?;
                left -= u32::from(args.lines.is_some());
            }
        }
    }
    talk.done(Command::Drives { every: 0 })
}

/// The platform, for its pose at joint angles.
struct MeasuredPlatform {
    forward: Forward<f64>,
    scene_start: trirrr_core::setpoint::Pose<f64>,
}

impl MeasuredPlatform {
    fn of(scene: &Scene) -> Result<Self, CliError> {
        let geometry = Geometry::<f64>::build(&scene.parameters)
            .map_err(|error| CliError::Refused(error.to_string()))?;
        Ok(Self {
            forward: Forward::build(&scene.parameters, &geometry),
            scene_start: scene.job.start,
        })
    }

    /// Line of a sample, in SI units.
    fn line<N: ServiceNumber>(&self, sample: &DriveSample<N>, units: &describe::Units) -> String {
        let t = f64::from(sample.tick) / units.tick_rate_hz;
        let drives = sample.drives.each_ref().map(|each| drive(each, units));
        let angles = sample
            .drives
            .each_ref()
            .map(|each| N::angle_to_f64(each.angle));
        let modes = self.forward.assemblies(&angles).ok();
        let nearest = modes.and_then(|modes| self.forward.nearest(&modes, &self.scene_start));
        let pose = match nearest {
            Some(mode) => {
                let [x, y] = [mode.pose.position.x, mode.pose.position.y];
                format!("x {x:.5} m, y {y:.5} m, alpha {:.5} rad", mode.pose.angle)
            }
            None => "no pose".into(),
        };
        format!("{t:>9.3} s | {} | {pose}", drives.join(" | "))
    }
}

/// Describes a reading in SI units.
fn drive<N: ServiceNumber>(reading: &DriveReading<N>, units: &describe::Units) -> String {
    let rate = reading.rate.to_f64() / units.time_s;
    let torque = reading.torque.to_f64() * units.mass_kg * (units.length_m / units.time_s).powi(2);
    let mut text = format!(
        "{} {:.5} rad {rate:.3} rad/s {torque:.3} N m",
        describe::drive_state(reading.state),
        N::angle_to_f64(reading.angle)
    );
    if reading.temperature_c != DriveReading::<N>::NO_TEMPERATURE {
        text += &format!(" {} C", reading.temperature_c);
    }
    if reading.supply_mv != 0 {
        text += &format!(" {:.2} V", f64::from(reading.supply_mv) / 1000.0);
    }
    if reading.error != 0 {
        text += &format!(" error {}", reading.error);
    }
    text
}
