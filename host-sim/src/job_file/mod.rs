//! Jobs in files of their own: G-code, drawings, images and tables, planned for the machine of a scene.

mod args;
mod drawing_args;
#[cfg(feature = "full")]
mod image;
mod image_args;
mod kind;
mod long;
mod queue;
mod read;

pub(crate) use args::origin;
pub use args::{JobFileArgs, ZArgs};
pub use drawing_args::{DrawingArgs, PenArg};
pub use image_args::{ImageArgs, PitchArg};
use long::LongPath;
use read::ReadWay;

pub(crate) use queue::{QueuedJob, load_queue};

use crate::failure::CliError;
use crate::figures::{Preview, RefusedJob};
use crate::results::{unwritable, write_named};
use crate::terminal::{bar, say};
use std::io;
use std::path::{Path, PathBuf};
use trirrr_figures::canvas::Drawn;
use trirrr_jobs::{JobRefusal, breach, job_scene};
use trirrr_scene::read::files::is_stream;
use trirrr_scene::{JobPath, ReachMap, Scene, Unplanned, UntakenJob};
use trirrr_toolpath::{PathFault, PathRemark};

/// Place for the moves of a long job of G-code.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LongMoves {
    /// With its path in memory, as those of every other job.
    InMemory,
    /// In a temporary file, in the job's spool. Memory does not grow with the job.
    InFile,
}

/// Scene that a command is to carry out, and where its job waits.
pub(crate) struct LoadedJob {
    /// The scene of the machine, with the job of the file.
    pub(crate) scene: Scene,
    /// The scene of the machine as it stands in its file, if the job has a file of its own.
    pub(crate) machine: Option<Scene>,
    /// Lines at which the job waits, for the user or for an input.
    pub(crate) pauses: Vec<u32>,
    /// Remarks about what was hardly meant.
    pub(crate) remarks: Vec<PathRemark>,
}

impl LoadedJob {
    /// A scene with its own job.
    fn of_scene(scene: Scene) -> Self {
        Self {
            scene,
            machine: None,
            pauses: Vec::new(),
            remarks: Vec::new(),
        }
    }

    /// Says what was hardly meant.
    pub(crate) fn say_remarks(&self) {
        for remark in &self.remarks {
            say(&format!("warning: {remark}"));
        }
    }

    /// Says what was hardly meant, and that nobody is waited for, where the job asks for it.
    pub(crate) fn warn(&self) {
        self.say_remarks();
        for line in &self.pauses {
            say(&format!(
                "warning: line {line} waits for the user or an input; here the motion stops there and goes on"
            ));
        }
    }
}

/// Scene of a job, planned, as the commands play it.
///
/// # Errors
/// Refused: as [`CliError`] says, with file, line and reason.
pub fn read_job(file: &Path, args: &JobFileArgs) -> Result<Scene, CliError> {
    load(file, args, LongMoves::InMemory).map(|job| job.scene)
}

/// Reads `file`: a scene, or with `--machine` a job for the machine of that scene.
///
/// # Errors
/// Refused: the scene, a line of the job, or a job without a plan.
pub(crate) fn load(
    file: &Path,
    args: &JobFileArgs,
    moves: LongMoves,
) -> Result<LoadedJob, CliError> {
    load_drawn(file, args, moves, None)
}

/// Reads as [`load`], and draws the path into `figure`, even if it has no plan: all of it is in memory then.
///
/// # Errors
/// As [`load`]. Failed: the figure cannot be written.
pub(crate) fn load_drawn(
    file: &Path,
    args: &JobFileArgs,
    moves: LongMoves,
    figure: Option<&Path>,
) -> Result<LoadedJob, CliError> {
    // A pipe has no name that tells: with a machine of its own it is a job.
    let is_scene = file
        .extension()
        .is_some_and(|extension| extension == "toml")
        || args.machine.is_none() && is_stream(file);
    match &args.machine {
        None if is_scene && args.z.is_given() => Err(CliError::Refused(format!(
            "{}: --ignore-z and --tool-by-z are for a job with --machine SCENE.toml; leave them out",
            file.display()
        ))),
        None if is_scene => {
            let Some(figure) = figure else {
                return Ok(LoadedJob::of_scene(args.set.scene_to_move(file)?));
            };
            let read = args.set.scene_to_move(file);
            let refused = match read {
                Ok(_) => None,
                Err(_) => Scene::read_refused(file, &args.set.set),
            };
            if let Some(scene) = read.as_ref().ok().or(refused.as_ref()) {
                draw(file, scene, figure)?;
            }
            read.map(LoadedJob::of_scene)
        }
        None => Err(CliError::Refused(format!(
            "{}: a job needs a machine: add --machine SCENE.toml",
            file.display()
        ))),
        Some(_) if is_scene => Err(CliError::Refused(format!(
            "{}: a scene has a machine and a job: leave --machine out, or give a job: G-code, a drawing, an image or a table",
            file.display()
        ))),
        Some(machine) => load_for(file, machine, args, moves, figure),
    }
}

fn load_for(
    file: &Path,
    machine: &Path,
    args: &JobFileArgs,
    moves: LongMoves,
    figure: Option<&Path>,
) -> Result<LoadedJob, CliError> {
    let moves = match figure {
        Some(_) => LongMoves::InMemory,
        None => moves,
    };
    // Before the machine is read, which warns.
    read::require(file)?;
    let machine = args.set.scene_to_move(machine)?;
    let name = file.display();
    let refused = |refusal: JobRefusal| CliError::Refused(format!("{name}:{refusal}"));
    let read = read::read(file, &machine, args, moves)?.map_err(|fault| refused(fault.into()))?;
    let mut scene = job_scene(&name.to_string(), &machine);
    let unplanned = |error: Unplanned| refused(read.places.refusal(&error));
    match &read.way {
        ReadWay::Whole(path) => {
            let planned = scene.take_path(path);
            if let Some(figure) = figure {
                let breach = planned.as_ref().err().and_then(breach);
                preview(&scene, path, breach, figure)?;
            }
            planned.map_err(unplanned)?;
        }
        ReadWay::Long(path) => {
            take_long(&mut scene, path).map_err(|error| match error {
                UntakenJob::Path(fault) => refused(fault.into()),
                UntakenJob::Plan(error) => unplanned(error),
                UntakenJob::Spool(_) => {
                    CliError::Failed(format!("{name}: {error}; TMPDIR names its folder"))
                }
            })?;
        }
    }
    Ok(LoadedJob {
        remarks: read.watch.remarks(&scene),
        scene,
        machine: Some(machine),
        pauses: read.pauses,
    })
}

/// Gives `scene` the job of a long file, with a bar on a terminal.
fn take_long(scene: &mut Scene, path: &LongPath) -> Result<(), UntakenJob<PathFault>> {
    let file = tempfile::tempfile().map_err(UntakenJob::Spool)?;
    let bar = bar(path.elements(), "planning {wide_bar} {percent:>3} %");
    let blocks = path.blocks().inspect(|block| {
        if let Ok(block) = block {
            bar.set_position(block.first() as u64);
        }
    });
    let taken = scene.take_blocks(blocks, file);
    bar.finish_and_clear();
    taken
}

/// Draws the job of a scene: its path and the reach of the machine, or of moves the curves that have limits and where they are broken.
fn draw(file: &Path, scene: &Scene, figure: &Path) -> Result<(), CliError> {
    if let Some(path) = &scene.job.path {
        let planned = match scene.job.moves.is_empty() {
            true => scene.clone().take_path(path),
            false => Ok(()),
        };
        return preview(scene, path, planned.as_ref().err().and_then(breach), figure);
    }
    let Some(job) = RefusedJob::of(scene) else {
        say(&format!(
            "{}: no figure: the machine is refused",
            file.display()
        ));
        return Ok(());
    };
    write_figures(job.draw(figure))
}

/// Writes the figures that a check is asked for.
fn write_figures(figures: impl IntoIterator<Item = (PathBuf, Drawn)>) -> Result<(), CliError> {
    let drawn = figures.into_iter().map(|(file, drawn)| match drawn {
        Ok(svg) => Ok((file, svg)),
        Err(error) => Err(unwritable(&file, &io::Error::other(error.to_string()))),
    });
    let files = drawn.collect::<Result<Vec<_>, _>>()?;
    write_named("check", &files)?;
    for (file, _) in files {
        say(&format!("wrote {}", file.display()));
    }
    Ok(())
}

/// Draws the path on the machine of `scene` into `file`.
fn preview(
    scene: &Scene,
    path: &JobPath,
    breach: Option<[f64; 2]>,
    file: &Path,
) -> Result<(), CliError> {
    let reach = ReachMap::new(scene, &scene.job.start)
        .map_err(|error| CliError::Refused(error.to_string()))?;
    let drawn = Preview {
        name: &scene.name,
        path,
        start_m: scene.job.start.position.into(),
        reach: &reach,
        breach,
    };
    write_figures([(file.to_owned(), drawn.draw())])
}
