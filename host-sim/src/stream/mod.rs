//! `trirrr stream`: plays the job of a scene on a board, and writes its telemetry.

mod args;
mod display;
mod journal;
mod keys;
mod session;
mod starts;
mod summary;
mod work;

pub use args::{PortArgs, StreamArgs};
pub(crate) use keys::user_command;
pub use session::StreamEnd;

use crate::dialogue::carry;
use crate::failure::CliError;
use crate::figures::JobMarks;
use crate::job_file::{self, LoadedJob, LongMoves, QueuedJob};
use crate::recording::{DriveRecorder, Recorder};
use crate::results::ResultFolder;
use crate::terminal::say;
use display::Display;
use journal::{JobKey, Journal};
use session::Session;
use std::cell::Cell;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Receiver;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use summary::Account;
use trirrr_client::describe::Units;
use trirrr_client::local;
use trirrr_client::records::Samples;
use trirrr_client::{
    BegunJob, JobClient, JobFailure, JobMark, JobPlace, JobWork, Patience, UserCommand,
    switched_label,
};
use trirrr_line::{Address, Retry};
use trirrr_protocol::message::{DriveSample, Telemetry, TelemetryFields, Transmit};
use trirrr_protocol::wire::frame_length;
use trirrr_protocol::wire::schema::longest;
use trirrr_scene::NumberType;
use trirrr_scene::Scene;
use trirrr_scene::in_number_type;
use trirrr_scene::offer;
use trirrr_scene::pipeline;
use trirrr_scene::{CarriedTools, JobOutputs};
use trirrr_service::ServiceNumber;
use work::{StreamMoves, StreamWork};

/// Part of the bytes of a serial port that may be telemetry.
const TELEMETRY_SHARE: f64 = 0.8;

/// Duration of the way to the start of what is left of a job, s, unless the user gives another.
const BACK_S: f64 = 2.0;

/// Bits on a serial line for a byte: a start bit, eight, a stop bit.
const BITS_PER_BYTE: f64 = 10.0;

/// Streams the job and prints the summary. `stop` ends the job early, on the path.
///
/// # Errors
/// Refused: the scene, its number type, or a move. Failed: the port, the board, or something that
/// cannot be written.
pub fn command(args: &StreamArgs, stop: &AtomicBool) -> Result<StreamEnd, CliError> {
    // One reader for all jobs and parts: a second would take lines away.
    let keys = args.keys.then(keys::listen);
    match stream_all(args, args.scalar, keys.as_ref(), stop) {
        Err(CliError::OtherNumbers { board, .. }) if args.scalar.is_none() => {
            say(&format!(
                "the board computes in {board}: the job is judged in {board}, as by --scalar {board}"
            ));
            stream_all(args, Some(board), keys.as_ref(), stop)
        }
        end => end,
    }
}

/// Streams the jobs in the number type `given`, or else in those of their scenes.
fn stream_all(
    args: &StreamArgs,
    given: Option<NumberType>,
    keys: Option<&Receiver<UserCommand>>,
    stop: &AtomicBool,
) -> Result<StreamEnd, CliError> {
    // A machine that plans gets the whole path, and numbers of little range need units for all moves.
    let moves = match args.path || given == Some(NumberType::Fixed) {
        true => LongMoves::InMemory,
        false => LongMoves::InFile,
    };
    let (out, then) = (args.out.as_deref(), &args.then);
    let jobs = job_file::load_queue(&args.scene, then, &args.job, moves, out, "-stream")?;
    let scalar = |queued: &QueuedJob| {
        // A job goes on in the numbers in which it was begun.
        let begun = args.resume.then(|| Journal::number(&queued.folder));
        let number = given.or(begun.flatten());
        number.unwrap_or(queued.job.scene.number)
    };
    for queued in &jobs {
        in_number_type!(scalar(queued), N => {
            check_board::<N>(&queued.job)
                .map_err(|why| CliError::Refused(format!("{}:{why}", queued.file.display())))?
        });
    }
    for queued in &jobs {
        let scalar = scalar(queued);
        let end = in_number_type!(scalar, N => stream::<N>(args, queued, scalar, keys, stop))?;
        if end != StreamEnd::Complete {
            return Ok(end);
        }
    }
    Ok(StreamEnd::Complete)
}

/// Reason why nobody talks to the board of a scene.
pub(crate) const NO_LINE: &str = " autonomous = true in [service]: the board plays its job by itself and has no line; \
     `trirrr run` plays it here; to talk to the machine leave autonomous, start, repeat and [inputs.button] out";

/// Checks that a board with the image of the machine's own scene can play the job.
fn check_board<N: ServiceNumber>(job: &LoadedJob) -> Result<(), String> {
    let LoadedJob {
        scene,
        machine,
        pauses,
    } = job;
    let own = machine.as_ref().unwrap_or(scene);
    if own.service.autonomous.is_some() {
        return Err(NO_LINE.into());
    }
    if let [first, ..] = pauses[..] {
        return Err(format!(
            "{first}: the job waits for the user or an input here, and a streamed job does not: make two files of it, take the wait out, or send the file to `trirrr grbl`"
        ));
    }
    let Some(machine) = machine else {
        return Ok(());
    };
    if scene.plays_quintics() && !machine.plays_quintics() {
        return Err(format!(
            " the machine {} plays no planned moves: its own job has none; plan a path in its scene, or set plans_paths = true in [service]",
            machine.name
        ));
    }
    let units = |scene| trirrr_scene::units::<N>(scene).map_err(|error| format!(" {error}"));
    match units(scene)? == units(machine)? {
        true => Ok(()),
        false => Err(format!(
            " in {} the job needs other units than the image of {} has: take a scene in f32, or the job into the scene",
            scene.number, machine.name
        )),
    }
}

fn stream<N: ServiceNumber>(
    args: &StreamArgs,
    queued: &QueuedJob,
    scalar: NumberType,
    keys: Option<&Receiver<UserCommand>>,
    stop: &AtomicBool,
) -> Result<StreamEnd, CliError> {
    let QueuedJob { file, job, folder } = queued;
    let scene = &job.scene;
    Journal::refuse_other(folder, args.resume)?;
    let refused = |error: String| CliError::Refused(format!("scene {}: {error}", scene.name));
    let units = trirrr_scene::units::<N>(scene).map_err(|error| refused(error.to_string()))?;
    let stream = Stream {
        args,
        file,
        scene,
        scalar,
        keys,
        stop,
        units,
        folder,
        has_results: Cell::new(args.resume),
    };
    if args.path {
        if !scene.job.outputs.is_empty() {
            return Err(CliError::Refused(
                "--path: the machine plans the moves, and outputs change with moves: leave --path out, or the outputs of the job (M62 to M65 in G-code)".into(),
            ));
        }
        let start = offer::pose::<N>(&units.pose(&scene.job.start));
        let pieces = offer::pieces(scene, &units).map_err(&refused)?;
        let work = JobWork::Path { start, pieces };
        let key = stream.key(&work);
        let mark = match args.resume {
            true => Journal::read(folder, &key)?.resumed(),
            false => JobMark::default(),
        };
        let journal = Journal::new(folder, key, mark);
        let work = StreamWork::of_path(work, scene);
        return stream
            .play(
                (work, JobOutputs::default()),
                mark.begun(),
                journal,
                &|_| mark.from,
            )
            .end;
    }
    let moves = StreamMoves::<N>::of(scene, &units);
    let key = stream.key(&moves.whole()?);
    let key = JobKey {
        label: switched_label(key.label, &scene.job.outputs),
        ..key
    };
    let rest = |from| {
        let period = units.time(scene.period_s());
        moves.rest(from, N::factor_from_f64(period))
    };
    let play = |mark: JobMark| -> Result<StreamPlayed, CliError> {
        let rest = rest(mark.from)?;
        let journal = Journal::new(folder, key.clone(), mark);
        let work = (moves.work(&rest)?, rest.outputs(&scene.job.outputs));
        Ok(stream.play(work, mark.begun(), journal, &|place| rest.place(place)))
    };
    let mut played = play(match args.resume {
        true => Journal::read(folder, &key)?.resumed(),
        false => JobMark::default(),
    })?;
    loop {
        let why = match played {
            StreamPlayed { is_lost: true, .. } => "the machine has lost the job",
            StreamPlayed {
                goes_back: true, ..
            } => "the door was opened on the way",
            _ => return played.end,
        };
        // The machine has nothing of the job any more: back to the place, as far as it is known.
        let mark = JobMark::at(played.reached);
        let JobPlace { index, at } = mark.from;
        let note = |text: &str| Display::new(0, false).note(text);
        if rest(mark.from)?.moves().is_empty() {
            Journal::new(folder, key, mark).end();
            note("the job was played to its end: nothing is left of it");
            return Ok(StreamEnd::Complete);
        }
        let count = index + 1;
        note(&format!(
            "{why}: back to move {count}, tick {at}, with the tool off"
        ));
        played = play(mark)?;
    }
}

/// Stream of one scene to one port.
struct Stream<'a> {
    args: &'a StreamArgs,
    file: &'a Path,
    scene: &'a Scene,
    scalar: NumberType,
    keys: Option<&'a Receiver<UserCommand>>,
    stop: &'a AtomicBool,
    units: trirrr_core::units::Units,
    folder: &'a Path,
    /// The folder has results of the job already: those of the rest go beside them.
    has_results: Cell<bool>,
}

/// End of a job, or of a part of it.
struct StreamPlayed {
    end: Result<StreamEnd, CliError>,
    /// The machine has lost a job that it had begun for another client.
    is_lost: bool,
    /// The user goes on with a job whose tool went off at an open door: the rest begins there.
    goes_back: bool,
    /// Place that it had reached.
    reached: JobPlace,
}

impl Stream<'_> {
    fn key<N: Transmit>(&self, work: &JobWork<N>) -> JobKey {
        JobKey {
            scene: self.scene.name.clone(),
            number: self.scalar.to_string(),
            label: work.label(&self.scene.name),
        }
    }

    /// Plays `work` with its changes of outputs, or goes on with it where another client has left it, with the part `begun` on the machine. `place` tells the place on the whole job of one
    /// on this work.
    fn play<N: ServiceNumber>(
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

    fn try_play<N: ServiceNumber>(
        &self,
        work: (StreamWork<'_, N>, JobOutputs),
        begun: Option<BegunJob>,
        journal: Journal,
        place: &dyn Fn(JobPlace) -> JobPlace,
        played: &mut StreamPlayed,
    ) -> Result<StreamEnd, CliError> {
        let Self { args, scene, .. } = *self;
        let pipeline = pipeline::of_scene::<N>(scene, self.units)
            .map_err(|error| CliError::Refused(format!("scene {}: {error}", scene.name)))?;
        let units = Units::of_scene(scene, &self.units);
        let (work, outputs) = work;
        let StreamWork {
            work,
            starts,
            ticks,
            supply,
            uses_tool,
        } = work;
        let display = Display::new(ticks, scene.torque).with_keys(args.keys);
        let fields = match scene.feedback {
            // Readings of the drives are compared with what they were told.
            Some(_) => {
                args.fields
                    | TelemetryFields::ANGLES
                    | TelemetryFields::RATES
                    | TelemetryFields::ACCELERATIONS
                    | TelemetryFields::TORQUES
            }
            None => args.fields,
        };
        let every = telemetry_every::<N>(args, fields, scene, &display);
        let patience_s = Duration::from_secs_f64(args.patience);
        let mut port = args.line.open(Retry::For(patience_s))?;
        let is_rest = self.has_results.replace(true);
        let folder = match is_rest {
            true => next_folder(self.folder),
            false => self.folder.into(),
        };
        let mut results = ResultFolder::for_command(&folder, "stream")?;
        let drives = DriveRecorder::create(&mut results, scene, units, every)?;
        // A hold shifts the moves.
        let marks = JobMarks::of(scene).without_moves();
        let rows = ticks / u64::from(every) + 1;
        let recorder = Recorder::create(results, rows, scene.torque, marks, None)?;
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
            client,
            samples: Samples::new(&*pipeline, units),
            recorder,
            drives,
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
            inputs: None,
            failure: None,
            last: None,
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
        let result = carry(&mut session, &mut port, self.stop).and_then(|end| end);
        session.journal.take(&session.client, place);
        played.goes_back = session.goes_back && matches!(result, Ok(StreamEnd::Stopped));
        let Session {
            client,
            samples,
            recorder,
            drives,
            display,
            mut journal,
            ..
        } = session;
        display.finish();
        let is_complete = matches!(result, Ok(StreamEnd::Complete));
        played.reached = journal.reached();
        let failure = client.failure();
        // A fault or a stop after the machine was found with the job is a new end, which the user is to see.
        let is_missing = begun.is_some() && !client.has_joined();
        played.is_lost = is_missing && failure.is_some_and(JobFailure::loses_job);
        match is_complete {
            true => journal.end(),
            // What was lost before is not to be forgotten.
            false if !played.is_lost => journal.note(&client, true)?,
            false => {}
        }
        let (mut recorded, mut results) = recorder.finish(&scene.name, is_complete)?;
        let drives = drives.filter(|_| results.has_begun());
        let drives = drives
            .map(|drives| drives.finish(&mut results, &scene.name))
            .transpose()?;
        if let Some(drives) = &drives {
            recorded.files.extend_from_slice(&drives.files);
        }
        let why = match &result {
            Ok(StreamEnd::Complete) => None,
            Ok(StreamEnd::Stopped) => Some("stopped by the user".into()),
            Err(error) => Some(error.to_string()),
        };
        results.end(why.as_deref().map_or(Ok(()), Err))?;
        // Nothing was played: another attempt follows.
        if played.is_lost || matches!(result, Err(CliError::OtherNumbers { .. })) {
            return result;
        }
        summary::print(&summary::Summary {
            file: self.file,
            scene,
            scalar: self.scalar,
            address: &args.line.port,
            board: client.identity(),
            status: client.status().map(Account::of),
            done: client.done(),
            is_begun: client.interrupted().is_some(),
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
        })?;
        match client.dry_ticks() {
            0 => result,
            // A job that took longer than it should is none that ran as planned.
            dry => result.and(Err(CliError::Failed(format!(
                "the job was played, but the machine waited {} s for moves on its way: they came too slowly over this line",
                f64::from(dry) / scene.tick_rate_hz
            )))),
        }
    }

    /// Allows the client to bring the machine to the start of the job, as the user wants, or of the rest of it.
    fn to_start<N: ServiceNumber>(&self, client: JobClient<N>, is_rest: bool) -> JobClient<N> {
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
