//! Way to the start of the scene's job, or to another pose, by an ordinary move.

use super::args::ParkArgs;
use crate::dialogue::{Reported, carry};
use crate::failure::CliError;
use crate::numbers::refused;
use crate::stream::conversation;
use crate::terminal::print;
use std::sync::atomic::AtomicBool;
use trirrr_client::describe::Units;
use trirrr_client::{JobClient, JobFailure, JobWork, UserCommand, local};
use trirrr_core::setpoint::Pose;
use trirrr_scene::{Scene, offer};
use trirrr_service::ServiceNumber;

/// Parks the machine of `scene`. Returns false if the user has stopped it.
///
/// # Errors
/// Refused: the scene in this number type, or the way. Failed: the port, the board, or a fault.
pub(super) fn park<N: ServiceNumber>(
    args: &ParkArgs,
    scene: &Scene,
    stop: &AtomicBool,
) -> Result<bool, CliError> {
    let (mut port, units, patience) = args.machine.open::<N>(scene)?;
    let start = scene.job.start;
    let pose = Pose::from_f64(
        args.x.unwrap_or(start.position.x),
        args.y.unwrap_or(start.position.y),
        args.alpha.unwrap_or(start.angle),
    );
    // A job of nothing that starts there: the way to its start is all of it.
    let work = JobWork::Path {
        start: offer::pose(&units.pose(&pose)),
        pieces: Vec::new(),
    };
    let mut client =
        JobClient::<N>::new(work, local::hello::<N>(scene), 0, patience, conversation());
    if let Some(percent) = args.machine.feed {
        client.command(UserCommand::FeedOverride(percent));
    }
    let parked = carry(&mut Reported::new(client), &mut port, stop)?;
    let units = Units::of_scene(scene, &units);
    match parked {
        Ok(()) => {
            let [x, y] = [pose.position.x, pose.position.y];
            print(&format!(
                "parked at x {x:.6} m, y {y:.6} m, alpha {:.6} rad\n",
                pose.angle
            ))?;
            Ok(true)
        }
        Err(JobFailure::Stopped { .. }) => Ok(false),
        Err(failure) => {
            let text = failure.describe("move", 0, &units);
            Err(match failure {
                JobFailure::Refused { refusal, .. } => refused(&refusal, text),
                JobFailure::NoWay { .. } => CliError::Refused(text),
                _ => CliError::Failed(text),
            })
        }
    }
}
