//! One part of a stream: the job, or what is left of it, over a port, with its files and its summary.

use super::args::StreamArgs;
use super::display::Display;
use super::journal::{JobKey, Journal};
use super::session::{Session, StreamEnd, ToldInputs};
use super::summary::{self, Account};
use super::work::StreamWork;
use super::{conversation, patience};
use crate::dialogue::carry;
use crate::failure::CliError;
use crate::figures::DrawnJob;
use crate::player::{JobFiles, JobRecorder, PlayedScene, STOPPED};
use crate::results::ResultFolder;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Receiver;
use std::time::Duration;
use trirrr_client::{BegunJob, JobClient, JobFailure, JobPlace, JobWork, UserCommand, local};
use trirrr_line::{Address, Port, Retry};
use trirrr_protocol::message::{DriveSample, Telemetry, TelemetryFields};
use trirrr_protocol::wire::frame_length;
use trirrr_protocol::wire::schema::longest;
use trirrr_scene::{CarriedTools, JobOutputs, Scene};
use trirrr_service::ServiceNumber;
/// Part of the bytes of a serial port that may be telemetry.
const TELEMETRY_SHARE: f64 = 0.8;

/// Duration of the way to the start of what is left of a job, s, unless the user gives another.
const BACK_S: f64 = 2.0;

/// Bits on a serial line for a byte: a start bit, eight, a stop bit.
const BITS_PER_BYTE: f64 = 10.0;

/// Stream of one scene to one port.
pub(super) struct Stream<'a, N: ServiceNumber> {
    pub(super) args: &'a StreamArgs,
    pub(super) file: &'a Path,
    pub(super) scene: &'a Scene,
    pub(super) played: &'a PlayedScene<'a, N>,
    pub(super) keys: Option<&'a Receiver<UserCommand>>,
    pub(super) stop: &'a AtomicBool,
    pub(super) folder: &'a Path,
    /// The folder has results of the job already: those of the rest go beside them.
    pub(super) has_results: Cell<bool>,
}

/// End of a job, or of a part of it.
pub(super) struct StreamPlayed {
    pub(super) end: Result<StreamEnd, CliError>,
    /// The machine has lost a job that it had begun for another client.
    pub(super) is_lost: bool,
    /// The user goes on with a job whose tool went off at an open door: the rest begins there.
    pub(super) goes_back: bool,
    /// Place that it had reached.
    pub(super) reached: JobPlace,
}

impl<N: ServiceNumber> Stream<'_, N> {
    pub(super) fn key(&self, work: &JobWork<N>) -> JobKey {
        JobKey {
            scene: self.scene.name.clone(),
            number: self.played.scalar.to_string(),
            label: work.label(&self.scene.name),
        }
    }

    /// Plays `work` with its changes of outputs, or goes on with it where another client has left it, with the part `begun` on the machine. `place` tells the place on the whole job of one
    /// on this work.
    pub(super) fn play(
        &self,
        work: (StreamWork<'_, N>, JobOutputs),
        begun: Option<BegunJob>,
        journal: Journal,
        place: &dyn Fn(JobPlace) -> JobPlace,
    ) -> StreamPlayed {
        let mut played = StreamPlayed {
            end: Ok(StreamEnd::Complete),
            is_lost: false,
            goes_back: false,
            reached: journal.reached(),
        };
        let end = self.try_play(work, begun, journal, place, &mut played);
        played.end = end;
        played
    }

    fn try_play(
        &self,
        work: (StreamWork<'_, N>, JobOutputs),
        begun: Option<BegunJob>,
        journal: Journal,
        place: &dyn Fn(JobPlace) -> JobPlace,
        played: &mut StreamPlayed,
    ) -> Result<StreamEnd, CliError> {
        let Self { args, scene, .. } = *self;
        let (work, outputs) = work;
        let StreamWork {
            work,
            starts,
            ticks,
            supply,
            uses_tool,
        } = work;
        let display = Display::new(ticks, scene.torque).with_keys(args.keys);
        let fields = sample_fields(args, scene);
        let every = telemetry_every::<N>(args, fields, scene, &display);
        let patience_s = Duration::from_secs_f64(args.patience);
        let mut port = args.line.open(Retry::For(patience_s))?;
        let is_rest = self.has_results.replace(true);
        let folder = match is_rest {
            true => next_folder(self.folder),
            false => self.folder.into(),
        };
        let results = ResultFolder::for_command(&folder, "stream")?;
        let files = JobFiles {
            records: ticks / u64::from(every) + 1,
            every: 1,
            // A hold shifts the moves.
            drawn: DrawnJob::of(scene).without_moves(),
            lagrange: None,
            drives_every: Some(every),
        };
        let recorder = JobRecorder::create(self.played, results, files)?;
        let hello = local::hello::<N>(scene);
        let client = JobClient::new(work, hello, every, patience(patience_s), conversation());
        let client = client.named(&scene.name).with_fields(fields);
        let client = client.with_outputs(&outputs);
        let client = client.with_tools(CarriedTools::of(scene));
        let client = match begun {
            Some(begun) => client.attached(begun),
            None => self.to_start(client, is_rest),
        };
        let mut session = Session {
            client: match recorder.has_drives() {
                true => client.with_drives(every),
                false => client,
            },
            recorder,
            display,
            starts,
            supply,
            every,
            keys: self.keys,
            journal,
            place,
            is_over: false,
            is_way_told: false,
            is_resumed: begun.is_some(),
            uses_tool,
            goes_back: false,
            inputs: ToldInputs::default(),
            failure: None,
            last: None,
        };
        if let Some(percent) = args.feed {
            session.client.command(UserCommand::FeedOverride(percent));
        }
        if let Some(longest) = scene.longest_stop() {
            session.display.note(&format!("a hold is {longest}"));
        }
        let result = carry(&mut session, &mut port, self.stop).and_then(|end| end);
        session.journal.take(&session.client, place);
        played.goes_back = session.goes_back && matches!(result, Ok(StreamEnd::Stopped));
        played.reached = session.journal.reached();
        let failure = session.client.failure();
        // A fault or a stop after the machine was found with the job is a new end, which the user is to see.
        let is_missing = begun.is_some() && !session.client.has_joined();
        played.is_lost = is_missing && failure.is_some_and(JobFailure::loses_job);
        self.finish(session, &port, result, played.is_lost)
    }

    /// Ends journal, files and display of a part that ended with `result`, and prints its summary. After one that `is_lost` another
    /// attempt follows.
    fn finish(
        &self,
        session: Session<'_, N>,
        port: &Port,
        result: Result<StreamEnd, CliError>,
        is_lost: bool,
    ) -> Result<StreamEnd, CliError> {
        let Session {
            client,
            recorder,
            display,
            mut journal,
            every,
            ..
        } = session;
        display.finish();
        let is_complete = matches!(result, Ok(StreamEnd::Complete));
        match is_complete {
            true => journal.end(),
            // What was lost before is not to be forgotten.
            false if !is_lost => journal.note(&client, true)?,
            false => {}
        }
        let (missing, differing) = (recorder.samples.missing(), recorder.samples.differing());
        let mut recorded = recorder.finish(is_complete)?;
        let why = match &result {
            Ok(StreamEnd::Complete) => None,
            Ok(StreamEnd::Stopped) => Some(STOPPED.into()),
            Err(error) => Some(error.to_string()),
        };
        recorded.results.end(why.as_deref())?;
        // Nothing was played: another attempt follows.
        if is_lost || matches!(result, Err(CliError::OtherNumbers { .. })) {
            return result;
        }
        summary::print(&summary::Summary {
            file: self.file,
            scene: self.scene,
            scalar: self.played.scalar,
            address: &self.args.line.port,
            board: client.identity(),
            status: client.status().map(Account::of),
            done: client.done(),
            is_begun: client.interrupted().is_some(),
            moves: client.moves(),
            item: client.item(),
            every,
            recorded: &recorded,
            missing,
            differing,
            repeated: client.repeated(),
            opened_anew: port.opened_anew(),
            damaged: port.damaged(),
            end: result.as_ref().ok().copied(),
        })?;
        match client.dry_ticks() {
            0 => result,
            // A job that took longer than it should is none that ran as planned.
            dry => result.and(Err(CliError::Failed(format!(
                "the job was played, but the machine waited {} s for moves on its way: they came too slowly over this line",
                f64::from(dry) / self.scene.tick_rate_hz
            )))),
        }
    }

    /// Allows the client to bring the machine to the start of the job, as the user wants, or of the rest of it.
    fn to_start(&self, client: JobClient<N>, is_rest: bool) -> JobClient<N> {
        let client = match self.args.no_homing {
            true => client.without_homing(),
            false => client,
        };
        let back = is_rest.then_some(BACK_S);
        match self.args.recover.or(back) {
            Some(seconds) => client.with_recovery(seconds),
            None => client,
        }
    }
}

/// Fields of the samples of `scene`: those that the user asks for. Readings of drives are compared with what they were told.
fn sample_fields(args: &StreamArgs, scene: &Scene) -> TelemetryFields {
    match scene.feedback {
        Some(_) => {
            args.fields
                | TelemetryFields::ANGLES
                | TelemetryFields::RATES
                | TelemetryFields::ACCELERATIONS
                | TelemetryFields::TORQUES
        }
        None => args.fields,
    }
}

/// Returns the folder for the results of a job that is resumed: the first of its kind in `folder` that is not there.
fn next_folder(folder: &Path) -> PathBuf {
    let mut folders = (1_u32..).map(|number| folder.join(format!("resumed-{number}")));
    let next = folders.find(|folder| !folder.exists());
    next.unwrap_or_else(|| folder.into())
}

/// Returns the ticks from one telemetry sample to the next: those of the user, those of the scene, or
/// more where a serial port does not carry as many samples.
fn telemetry_every<N: ServiceNumber>(
    args: &StreamArgs,
    fields: TelemetryFields,
    scene: &Scene,
    display: &Display,
) -> u16 {
    // The scene's reader holds it to the same range.
    let wanted = u16::try_from(scene.service.telemetry_ticks).unwrap_or(u16::MAX);
    let least = match &args.line.port {
        Address::Tcp(_) => 1,
        Address::Serial(_) => least_every(
            frame_length(Telemetry::<N>::longest(fields) + 1)
                + match scene.feedback {
                    Some(_) => frame_length(longest::<DriveSample<N>>() + 1),
                    None => 0,
                },
            scene.tick_rate_hz,
            args.line.baud,
        ),
    };
    let every = args.telemetry.unwrap_or(wanted.max(least));
    if every < least {
        display.note(&format!(
            "{} baud carry a sample every {least} ticks; some of those every {every} will be lost",
            args.line.baud
        ));
    } else if every > wanted && args.telemetry.is_none() {
        display.note(&format!(
            "a sample every {every} ticks, as many as {} baud carry",
            args.line.baud
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

#[cfg(test)]
mod tests {
    use super::*;

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
