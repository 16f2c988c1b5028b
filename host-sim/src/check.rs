//! `trirrr check`: reads a scene or a job and says what is wrong with it, or what it asks for.

use crate::failure::CliError;
use crate::job_file::{self, JobFileArgs, LoadedJob, LongMoves};
use crate::redundant;
use crate::terminal::show;
use clap::Args;
use std::path::PathBuf;
use trirrr_figures::document::{Document, Facts};
use trirrr_scene::words::{counted, tick_time};
use trirrr_scene::{Autonomous, Scene};
use trirrr_service::features::{FOREVER, JobStart};
use trirrr_toolpath::PathRemark;

/// `trirrr check`.
///
/// Reads a scene, or a job for the machine of a scene, as every other command does: poses, limits, and each move by the
/// admission of the machine's service. Moves nothing, and writes nothing but a figure that is asked for.
#[derive(Args, Clone, Debug)]
pub struct CheckArgs {
    /// The scene, a TOML file; or with --machine a job: G-code, a drawing (SVG, DXF), an image, a table of poses (CSV)
    #[arg(value_name = "SCENE.toml")]
    pub scene: PathBuf,
    /// The job in a file of its own.
    #[command(flatten)]
    pub job: JobFileArgs,
    /// Print one JSON object instead of text
    #[arg(long)]
    pub json: bool,
    /// Draw the job into this SVG file, of one that is refused, too: a path with the reach of the machine; of moves the curves that have
    /// limits, and the machine where one is broken into a file beside it
    #[arg(long, value_name = "FILE.svg")]
    pub figure: Option<PathBuf>,
}

/// Checks the scene or the job, and prints what it asks for.
///
/// # Errors
/// Refused: everything that is found wrong, each with its line.
pub fn command(args: &CheckArgs) -> Result<(), CliError> {
    if redundant::is_redundant(&args.scene, &args.job) {
        return redundant::check(args);
    }
    let job = job_file::load_drawn(
        &args.scene,
        &args.job,
        LongMoves::InFile,
        args.figure.as_deref(),
    )?;
    job.warn();
    let LoadedJob {
        scene,
        pauses,
        remarks,
        ..
    } = job;
    trirrr_image::ram::check_board(&scene)
        .map_err(|why| CliError::Refused(format!("{}: {why}", args.scene.display())))?;
    show(&document(&scene, &pauses, &remarks), args.json)
}

fn document(scene: &Scene, pauses: &[u32], remarks: &[PathRemark]) -> Document {
    let moves = scene.job.count();
    let (duration_s, ticks, rate) = (scene.duration_s(), scene.ticks(), scene.tick_rate_hz);
    let job = format!(
        "{}, {} s: {ticks} ticks at {rate} Hz in {}",
        counted(moves, "move"),
        tick_time(duration_s),
        scene.number,
    );
    let longest = scene.longest_stop();
    let mut document = Document::new();
    document.note(format!("{}: good", scene.name)).note(job);
    if let Some(longest) = longest {
        document.note(format!("a hold is {longest}"));
    }
    let own = scene.service.autonomous;
    if let Some(own) = own {
        document.note(autonomous(scene, own));
    }
    document.pairs(
        Facts::new()
            .data("scene", &scene.name)
            .data("description", &scene.description)
            .data("key", scene.key)
            .data("number", scene.number.name())
            .data("tick_rate_hz", rate)
            .data("moves", moves)
            .data("ticks", ticks)
            .data("duration_s", duration_s)
            .data("longest_stop_s", longest.map(|longest| longest.time_s))
            .data("longest_stop_m", longest.map(|longest| longest.way_m))
            .data("pauses", pauses)
            .data(
                "remarks",
                remarks
                    .iter()
                    .map(PathRemark::to_string)
                    .collect::<Vec<_>>(),
            )
            .data("warning", scene.limits_warning()),
    );
    document
}

/// What the board does by itself.
fn autonomous(scene: &Scene, own: Autonomous) -> String {
    let begins = match own.begins {
        JobStart::Button => "at the press of its button",
        JobStart::Power => "when it is switched on or reset",
    };
    let passes = match own.passes {
        FOREVER => "until something stops it".into(),
        passes => counted(passes as usize, "time"),
    };
    let start = match scene.homing {
        Some(_) => "homes first",
        None => "has to stand at the start of the job when it is switched on",
    };
    format!("the board plays it by itself {begins}, {passes}; the machine {start}")
}
