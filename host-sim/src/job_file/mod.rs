//! Jobs in files of their own: G-code, planned for the machine of a scene.

mod args;
mod path;

pub use args::JobFileArgs;

use crate::arguments::scene_to_move;
use crate::failure::CliError;
use crate::terminal::say;
use path::PathBuilder;
use std::fs::File;
use std::io::BufReader;
use std::path::Path;
use trirrr_scene::{Scene, Unplanned};
use trirrr_toolpath::gcode::{self, GcodeSetup};
use trirrr_toolpath::{PathFault, ToolPlace};

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

/// Reads `file`: a scene, or with `--machine` a job for the machine of that scene.
///
/// # Errors
/// Refused: the scene, a line of the job, or a job without a plan.
pub(crate) fn load(file: &Path, args: &JobFileArgs) -> Result<LoadedJob, CliError> {
    let is_scene = file
        .extension()
        .is_some_and(|extension| extension == "toml");
    match &args.machine {
        None if is_scene => Ok(LoadedJob {
            scene: scene_to_move(file)?,
            machine: None,
            pauses: Vec::new(),
        }),
        None => Err(CliError::Refused(format!(
            "{}: a job needs a machine: add --machine SCENE.toml",
            file.display()
        ))),
        Some(_) if is_scene => Err(CliError::Refused(format!(
            "{}: a scene has a machine and a job: leave --machine out, or give a file of G-code",
            file.display()
        ))),
        Some(machine) => load_for(file, machine, args),
    }
}

fn load_for(file: &Path, machine: &Path, args: &JobFileArgs) -> Result<LoadedJob, CliError> {
    let machine = scene_to_move(machine)?;
    let name = file.display();
    let refused = |fault: PathFault| CliError::Refused(format!("{name}:{fault}"));
    let opened = File::open(file)
        .map_err(|error| CliError::Refused(format!("{name}: cannot be read: {error}")))?;
    let start = machine.job.start;
    let mut builder = PathBuilder::new(start, machine.tick_rate_hz);
    let mut elements = gcode::elements(BufReader::new(opened), setup(&machine, args));
    for element in elements.by_ref() {
        builder.push(&element.map_err(refused)?).map_err(refused)?;
    }
    let corner_m = match elements.interpreter().modal().blend_m {
        Some(blend_m) => blend_m,
        None => 1e-3 * args.corner,
    };
    let pauses = std::mem::take(&mut builder.pauses);
    let path = builder.finish(corner_m).map_err(refused)?;
    let mut scene = Scene {
        name: job_name(file, &machine.name),
        description: format!("{name} on the machine {}", machine.name),
        ..machine.clone()
    };
    scene
        .take_path(&path)
        .map_err(|error| CliError::Refused(format!("{name}:{}", in_file(&error))))?;
    Ok(LoadedJob {
        scene,
        machine: Some(machine),
        pauses,
    })
}

fn setup(machine: &Scene, args: &JobFileArgs) -> GcodeSetup {
    let start = machine.job.start;
    let start = ToolPlace {
        position_m: [start.position.x, start.position.y],
        alpha_rad: start.angle,
    };
    let [x, y, alpha] = args.origin.unwrap_or([0.0; 3]);
    let origin = ToolPlace {
        position_m: [1e-3 * x, 1e-3 * y],
        alpha_rad: alpha.to_radians(),
    };
    GcodeSetup {
        start,
        origins: [origin; 6],
        full_power: args.full_power,
        home: Some(start),
        ignore_z: args.ignore_z,
    }
}

/// Line and reason, where the reason stands in a line of the file.
fn in_file(error: &Unplanned) -> String {
    match error {
        Unplanned::Path { number, .. }
        | Unplanned::NoAlpha { number, .. }
        | Unplanned::Dwell { number }
        | Unplanned::LongDwell { number, .. } => format!("{}: {error}", number + 1),
        Unplanned::Machine(_) | Unplanned::Units | Unplanned::Ticks(_) => format!(" {error}"),
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
