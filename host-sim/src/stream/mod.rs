//! `trirrr stream`: plays the job of a scene on a board, and writes its telemetry.

mod args;
mod display;
mod keys;
mod port;
mod session;
mod summary;

pub use args::StreamArgs;
pub(crate) use keys::user_command;
pub(crate) use port::Port;
pub use session::StreamEnd;

use crate::failure::CliError;
use crate::recording::{DriveRecorder, Recorder};
use crate::results::ResultFolder;
use display::Display;
use session::Session;
use std::path::Path;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use trirrr_client::describe::Units;
use trirrr_client::local;
use trirrr_client::records::Samples;
use trirrr_client::transport::Address;
use trirrr_client::{JobClient, JobWork, Patience, UserCommand};
use trirrr_protocol::message::{DriveSample, Telemetry};
use trirrr_protocol::wire::frame_length;
use trirrr_protocol::wire::schema::longest;
use trirrr_scene::NumberType;
use trirrr_scene::Scene;
use trirrr_scene::in_number_type;
use trirrr_scene::offer;
use trirrr_scene::pipeline;
use trirrr_service::ServiceNumber;

/// Part of the bytes of a serial port that may be telemetry.
const TELEMETRY_SHARE: f64 = 0.8;

/// Bits on a serial line for a byte: a start bit, eight, a stop bit.
const BITS_PER_BYTE: f64 = 10.0;

/// Streams the job and prints the summary. `stop` ends the job early, on the path.
///
/// # Errors
/// Refused: the scene, its number type, or a move. Failed: the port, the board, or something that
/// cannot be written.
pub fn command(args: &StreamArgs, stop: &AtomicBool) -> Result<StreamEnd, CliError> {
    let scene = Scene::read(&args.scene).map_err(|error| CliError::Refused(error.to_string()))?;
    let scalar = args.scalar.unwrap_or(scene.number);
    in_number_type!(scalar, N => stream::<N>(args, &scene, scalar, stop))
}

fn stream<N: ServiceNumber>(
    args: &StreamArgs,
    scene: &Scene,
    scalar: NumberType,
    stop: &AtomicBool,
) -> Result<StreamEnd, CliError> {
    let refused = |error: String| CliError::Refused(format!("scene {}: {error}", scene.name));
    let units = trirrr_scene::units::<N>(scene).map_err(|error| refused(error.to_string()))?;
    let pipeline =
        pipeline::of_scene::<N>(scene, units).map_err(|error| refused(error.to_string()))?;
    let work = match args.path {
        false => JobWork::from(offer::moves::<N>(scene, &units)),
        true => JobWork::Path {
            start: offer::pose(&units.pose(&scene.job.start)),
            pieces: offer::pieces(scene, &units).map_err(&refused)?,
        },
    };
    let units = Units::of_scene(scene, &units);
    let before = scene.job.moves.iter().scan(0, |sum, each| {
        let before = *sum;
        *sum += u64::from(each.duration_ticks);
        Some(before)
    });
    let before: Vec<u64> = before.collect();
    let ticks = u64::from(scene.ticks());
    let display = Display::new(ticks, scene.torque);
    let every = telemetry_every::<N>(args, scene, &display);
    let port = Port::open(
        &args.port,
        args.baud,
        Duration::from_secs_f64(args.patience),
    )
    .map_err(|error| CliError::Failed(error.to_string()))?;
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(&scene.name),
    };
    let mut results = ResultFolder::create(&folder, "stream")?;
    let drives = DriveRecorder::create(&mut results, scene, units, every)?;
    let recorder = Recorder::create(results, ticks / u64::from(every) + 1, scene.torque)?;
    let mut session = Session {
        client: to_start(
            args,
            JobClient::new(
                work,
                local::hello::<N>(scene),
                every,
                patience(Duration::from_secs_f64(args.patience)),
                conversation(),
            ),
        ),
        port,
        samples: Samples::new(&*pipeline, units),
        recorder,
        drives,
        display,
        before,
        every,
        keys: args.keys.then(keys::listen),
        stop,
        is_over: false,
    };
    if session.drives.is_some() {
        session.client = session.client.with_drives(every);
    }
    if let Some(percent) = args.feed {
        session.client.command(UserCommand::FeedOverride(percent));
    }
    if let Some(longest) = scene.longest_stop() {
        session.display.note(&format!("a hold is {longest}"));
    }
    let result = session.run();
    let Session {
        client,
        port,
        samples,
        recorder,
        drives,
        display,
        ..
    } = session;
    display.finish();
    let is_complete = matches!(result, Ok(StreamEnd::Complete));
    let (mut recorded, results) = recorder.finish(&scene.name, is_complete)?;
    let drives = drives.filter(|_| results.has_begun());
    let drives = drives
        .map(|drives| drives.finish(&scene.name))
        .transpose()?;
    if let Some(drives) = &drives {
        recorded.files.extend_from_slice(&drives.files);
    }
    let why = match &result {
        Ok(StreamEnd::Complete) => None,
        Ok(StreamEnd::Stopped) => Some("stopped by the user".into()),
        Err(error) => Some(error.to_string()),
    };
    results.end(&recorded.files, why.as_deref().map_or(Ok(()), Err))?;
    summary::print(&summary::Summary {
        file: &args.scene,
        scene,
        scalar,
        address: &args.port,
        board: client.identity(),
        longest: client.status().map(|status| status.longest_tick),
        done: client.done(),
        moves: client.moves(),
        item: client.item(),
        every,
        recorded: &recorded,
        drives: drives.as_ref().map(|drives| &drives.peaks),
        missing: samples.missing(),
        differing: samples.differing(),
        repeated: client.repeated(),
        opened_anew: port.opened_anew(),
        damaged: port.damaged(),
        end: result.as_ref().ok().copied(),
    })
    .and(result)
}

/// Returns the ticks from one telemetry sample to the next: those of the user, those of the scene, or
/// more where a serial port does not carry as many samples.
fn telemetry_every<N: ServiceNumber>(args: &StreamArgs, scene: &Scene, display: &Display) -> u16 {
    // The scene's reader holds it to the same range.
    let wanted = u16::try_from(scene.service.telemetry_ticks).unwrap_or(u16::MAX);
    let least = match &args.port {
        Address::Tcp(_) => 1,
        Address::Serial(_) => least_every(
            frame_length(longest::<Telemetry<N>>() + 1)
                + match scene.feedback {
                    Some(_) => frame_length(longest::<DriveSample<N>>() + 1),
                    None => 0,
                },
            scene.tick_rate_hz,
            args.baud,
        ),
    };
    let every = args.telemetry.unwrap_or(wanted.max(least));
    if every < least {
        display.note(&format!(
            "{} baud carry a sample every {least} ticks; some of those every {every} will be lost",
            args.baud
        ));
    } else if every > wanted && args.telemetry.is_none() {
        display.note(&format!(
            "a sample every {every} ticks, as many as {} baud carry",
            args.baud
        ));
    }
    every
}

/// Returns the fewest ticks from one sample to the next that a serial port carries.
fn least_every(frame_bytes: usize, tick_rate_hz: f64, baud: u32) -> u16 {
    let bits = frame_bytes as f64 * BITS_PER_BYTE * tick_rate_hz;
    // From float to integer the cast saturates.
    (bits / (TELEMETRY_SHARE * f64::from(baud))).ceil().max(1.0) as u16
}

/// Returns the patience with one port, for a user who waits as long as `total`.
pub(crate) fn patience(total: Duration) -> Patience {
    let Patience { answer, attempts } = Patience::default();
    let (mut waited, mut asked) = (answer, 1);
    while asked < attempts && waited < total {
        waited += answer * (1 << asked.min(3));
        asked += 1;
    }
    Patience {
        answer,
        attempts: asked,
    }
}

/// Allows the client to bring the machine to the start of the job, as the user wants.
fn to_start<N: ServiceNumber>(args: &StreamArgs, client: JobClient<N>) -> JobClient<N> {
    let client = match args.no_homing {
        true => client.without_homing(),
        false => client,
    };
    match args.recover {
        Some(seconds) => client.with_recovery(seconds),
        None => client,
    }
}

/// Returns a number that another conversation is not likely to have.
pub(crate) fn conversation() -> u32 {
    let now = SystemTime::now().duration_since(UNIX_EPOCH);
    let nanoseconds = now.map_or(0, |now| now.as_nanos() as u32);
    nanoseconds ^ std::process::id().rotate_left(16)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn who_waits_less_asks_less_often() {
        // Waits of 200, 400, 800 and 1600 ms.
        for (seconds, attempts) in [(0.1, 1), (0.3, 2), (0.6, 2), (1.0, 3), (1e3, 7)] {
            let patience = patience(Duration::from_secs_f64(seconds));
            assert_eq!(patience.attempts, attempts, "{seconds}");
        }
    }

    #[test]
    fn a_slow_port_gets_fewer_samples() {
        // 115,200 baud are 11,520 bytes a second, of which 9,216 are for telemetry: 92.16 frames
        // of 100 bytes.
        assert_eq!(least_every(100, 100.0, 115_200), 2);
        assert_eq!(least_every(100, 92.0, 115_200), 1);
        assert_eq!(least_every(100, 1000.0, 115_200), 11);
        assert_eq!(least_every(100, 1000.0, 2_000_000), 1);
        assert_eq!(least_every(300, 1e5, 300), u16::MAX);
    }
}
