//! Way to the start of the scene's job, or to another pose, by an ordinary move.

use super::args::ParkArgs;
use crate::failure::CliError;
use crate::numbers::refused;
use crate::stream::{Port, conversation};
use crate::terminal::{print, say};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use trirrr_client::describe::{self, Units};
use trirrr_client::{Action, JobClient, JobFailure, JobWork, UserCommand, local};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Event, Message};
use trirrr_scene::{Scene, offer};
use trirrr_service::ServiceNumber;

/// Longest wait for the board before the user is heard.
const LOOK: Duration = Duration::from_millis(20);

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
    let begin = Instant::now();
    let mut is_stopping = false;
    let mut state = None;
    let failure = loop {
        if stop.load(Ordering::Relaxed) && !std::mem::replace(&mut is_stopping, true) {
            say("Ctrl-C: the machine stops on its path");
            client.command(UserCommand::Stop);
        }
        let lost = match client.poll(begin.elapsed()) {
            Action::Send(request) => port.send(&request).err().map(|error| error.to_string()),
            Action::Lost => Some("the board does not answer".into()),
            Action::Wait(until) => {
                let wait = until.saturating_sub(begin.elapsed()).min(LOOK);
                match port.receive(wait) {
                    Ok(messages) => {
                        for message in &messages {
                            if let Message::Event(Event::State {
                                state: new, acting, ..
                            }) = message
                                && state.replace((*new, *acting)) != Some((*new, *acting))
                            {
                                say(&describe::state(*new, *acting));
                            }
                            client.receive(message, begin.elapsed());
                        }
                        None
                    }
                    Err(error) => Some(error.to_string()),
                }
            }
            Action::Finished(Ok(())) => break None,
            Action::Finished(Err(failure)) => break Some(failure),
        };
        if let Some(why) = lost {
            reopen(&mut port, &why, stop)?;
            client.reconnected();
        }
    };
    let units = Units::of_scene(scene, &units);
    match failure {
        None => {
            let [x, y] = [pose.position.x, pose.position.y];
            print(&format!(
                "parked at x {x:.6} m, y {y:.6} m, alpha {:.6} rad\n",
                pose.angle
            ))?;
            Ok(true)
        }
        Some(JobFailure::Stopped { .. }) => Ok(false),
        Some(failure) => {
            let text = failure.describe("move", 0, &units);
            Err(match failure {
                JobFailure::Refused { refusal, .. } => refused(&refusal, text),
                JobFailure::NoWay { .. } => CliError::Refused(text),
                _ => CliError::Failed(text),
            })
        }
    }
}

fn reopen(port: &mut Port, why: &str, stop: &AtomicBool) -> Result<(), CliError> {
    if let Some(text) = port.reopening(why) {
        say(&text);
    }
    port.reopen(why, stop).map_err(CliError::Failed)
}
