//! `trirrr stream`: plays the job of a scene on a board, and writes its telemetry.

mod args;
mod display;
mod journal;
mod keys;
mod part;
mod session;
mod starts;
mod summary;
mod work;

pub use args::{PortArgs, StreamArgs};
pub(crate) use keys::user_command;
pub use session::StreamEnd;

use crate::failure::CliError;
use crate::job_file::{self, LoadedJob, LongMoves, QueuedJob};
use crate::player::PlayedScene;
use crate::terminal::say;
use display::Display;
use journal::{JobKey, Journal};
use part::{Stream, StreamPlayed};
use std::cell::Cell;
use std::sync::atomic::AtomicBool;
use std::sync::mpsc::Receiver;
use std::time::{Duration, SystemTime, UNIX_EPOCH};
use trirrr_client::{JobMark, JobPlace, JobWork, Patience, UserCommand, switched_label};
use trirrr_scene::{JobOutputs, NumberType, in_number_type, offer};
use trirrr_service::ServiceNumber;
use work::{StreamMoves, StreamWork};

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
    jobs.iter().for_each(|queued| queued.job.say_remarks());
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
        ..
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
    let played = PlayedScene::<N>::new(scene, scalar)?;
    let units = played.units;
    let stream = Stream {
        played: &played,
        args,
        file,
        scene,
        keys,
        stop,
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
        let pieces = offer::pieces(scene, &units)
            .map_err(|why| CliError::Refused(format!("scene {}: {why}", scene.name)))?;
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
}
