//! Jobs in files of their own: G-code, drawings, images and tables, planned for the machine of a scene.

mod args;
mod drawing;
mod drawing_args;
mod fit;
mod image;
mod image_args;
mod path;
mod queue;
mod read;

pub use args::JobFileArgs;
pub(crate) use args::distance;
pub use drawing_args::{DrawingArgs, PenArg};
pub use image_args::ImageArgs;
use read::JobKind;

pub(crate) use path::{has_length, piece_from, pose_of, tool_of};
pub(crate) use queue::{QueuedJob, load_queue};

use crate::failure::CliError;
use crate::figures::Preview;
use crate::recording::unwritable;
use crate::terminal::say;
use std::path::Path;
use trirrr_scene::{JobPath, ReachMap, Scene, Unplanned};
use trirrr_toolpath::PathFault;

/// Longest name of a job: that of a folder, and on the wire.
const LONGEST_NAME: usize = 32;

/// Scene that a command is to carry out, and where its job waits for the user.
pub(crate) struct LoadedJob {
    /// The scene of the machine, with the job of the file.
    pub(crate) scene: Scene,
    /// The scene of the machine as it stands in its file, if the job has a file of its own.
    pub(crate) machine: Option<Scene>,
    /// Lines at which the job waits for the user.
    pub(crate) pauses: Vec<u32>,
}

impl LoadedJob {
    /// Says that nobody is waited for, where the job asks for it.
    pub(crate) fn warn_of_pauses(&self) {
        for line in &self.pauses {
            say(&format!(
                "warning: line {line} waits for the user; here the motion stops there and goes on"
            ));
        }
    }
}

/// Scene of a job, planned, as the commands play it.
///
/// # Errors
/// Refused: as [`CliError`] says, with file, line and reason.
pub fn read_job(file: &Path, args: &JobFileArgs) -> Result<Scene, CliError> {
    load(file, args).map(|job| job.scene)
}

/// Reads `file`: a scene, or with `--machine` a job for the machine of that scene.
///
/// # Errors
/// Refused: the scene, a line of the job, or a job without a plan.
pub(crate) fn load(file: &Path, args: &JobFileArgs) -> Result<LoadedJob, CliError> {
    load_drawn(file, args, None)
}

/// Reads as [`load`], and draws the path into `figure`, even if it has no plan.
///
/// # Errors
/// As [`load`]. Failed: the figure cannot be written.
pub(crate) fn load_drawn(
    file: &Path,
    args: &JobFileArgs,
    figure: Option<&Path>,
) -> Result<LoadedJob, CliError> {
    let is_scene = file
        .extension()
        .is_some_and(|extension| extension == "toml");
    match &args.machine {
        None if is_scene => {
            let scene = args.set.scene_to_move(file)?;
            if let Some(figure) = figure {
                let path = scene.job.path.as_ref().ok_or_else(|| {
                    CliError::Refused(format!(
                        "{}: --figure draws a path, and the job has no [[job.path]]; `trirrr run --fast` draws its moves",
                        file.display()
                    ))
                })?;
                preview(&scene, path, None, figure)?;
            }
            Ok(LoadedJob {
                scene,
                machine: None,
                pauses: Vec::new(),
            })
        }
        None => Err(CliError::Refused(format!(
            "{}: a job needs a machine: add --machine SCENE.toml",
            file.display()
        ))),
        Some(_) if is_scene => Err(CliError::Refused(format!(
            "{}: a scene has a machine and a job: leave --machine out, or give a job: G-code, SVG, DXF, PNG, JPEG, BMP or CSV",
            file.display()
        ))),
        Some(machine) => load_for(file, machine, args, figure),
    }
}

fn load_for(
    file: &Path,
    machine: &Path,
    args: &JobFileArgs,
    figure: Option<&Path>,
) -> Result<LoadedJob, CliError> {
    let machine = args.set.scene_to_move(machine)?;
    let name = file.display();
    let refused = |fault: PathFault| CliError::Refused(format!("{name}:{}", in_line(&fault)));
    let read = read::read(file, &machine, args)?.map_err(refused)?;
    let mut scene = Scene {
        name: job_name(file, &machine.name),
        description: format!("{name} on the machine {}", machine.name),
        ..machine.clone()
    };
    let planned = scene.take_path(&read.path);
    if let Some(figure) = figure {
        let breach = planned.as_ref().err().and_then(breach);
        preview(&scene, &read.path, breach, figure)?;
    }
    planned.map_err(|error| {
        let place = number(&error).map_or(String::new(), |number| read.place(number + 1) + ":");
        CliError::Refused(format!("{name}:{place} {error}"))
    })?;
    Ok(LoadedJob {
        scene,
        machine: Some(machine),
        pauses: read.pauses,
    })
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
    let file = drawn
        .write(file)
        .map_err(|error| unwritable(&error.path, &error.source))?;
    say(&format!("wrote {}", file.display()));
    Ok(())
}

/// A fault behind the name of its file.
fn in_line(fault: &PathFault) -> String {
    let space = if fault.line == 0 { " " } else { "" };
    format!("{space}{fault}")
}

/// Number of the element that cannot be planned, from 0.
fn number(error: &Unplanned) -> Option<u32> {
    match error {
        Unplanned::Path { number, .. }
        | Unplanned::NoAlpha { number, .. }
        | Unplanned::Dwell { number }
        | Unplanned::LongDwell { number, .. }
        | Unplanned::Levels { number } => Some(*number as u32),
        Unplanned::Machine(_) | Unplanned::Units | Unplanned::Ticks(_) => None,
    }
}

/// Place at which a path cannot be planned, m.
fn breach(error: &Unplanned) -> Option<[f64; 2]> {
    match error {
        Unplanned::Path { refusal, .. } | Unplanned::NoAlpha { refusal, .. } => {
            Some(refusal.pose.position.into())
        }
        _ => None,
    }
}

/// Name for results and for the wire: that of the file, in the letters of names.
fn job_name(file: &Path, machine: &str) -> String {
    let stem = file.file_stem().unwrap_or_default().to_string_lossy();
    let letter = |c: char| match c.is_ascii_alphanumeric() || c == '-' {
        true => c,
        false => '_',
    };
    let name: String = stem.chars().map(letter).take(LONGEST_NAME).collect();
    match name.is_empty() {
        true => machine.to_owned(),
        false => name,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_job_is_named_after_its_file() {
        assert_eq!(job_name(Path::new("a/My part (2).ngc"), "m"), "My_part__2_");
        assert_eq!(job_name(Path::new(".."), "m"), "m");
        let long = "x".repeat(99);
        assert_eq!(job_name(Path::new(&long), "m").len(), LONGEST_NAME);
    }
}
