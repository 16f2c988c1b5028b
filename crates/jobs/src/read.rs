//! Texts of files, to the path of a job on a machine.

use crate::drawing::place;
use crate::fit::Fitted;
use crate::options::JobOptions;
use crate::path::PathBuilder;
use crate::places::{ElementPlaces, JobRefusal, PlacesIn};
use crate::remarks::JobWatch;
use std::io::BufRead;
use std::path::Path;
use trirrr_scene::{JobPath, Scene};
use trirrr_toolpath::drawing::{Drawing, OffTravel};
use trirrr_toolpath::gcode::{self, GcodeSetup};
use trirrr_toolpath::table::{TableSetup, read_table};
use trirrr_toolpath::{Element, PathFault, ToolPlace};

/// Longest name of a job: that of a folder, and on the wire.
const LONGEST_NAME: usize = 32;

/// Path of a file on a machine, before it is planned.
pub struct ReadJob {
    /// The path.
    pub path: JobPath,
    /// Lines at which the job waits, for the user or for an input.
    pub pauses: Vec<u32>,
    /// Watch for what was hardly meant.
    pub watch: JobWatch,
    /// Places of its elements.
    pub places: ElementPlaces,
    /// Place that was found for it.
    pub fitted: Option<Fitted>,
    /// Ways with the tool off that a drawing has, m on the machine.
    pub travel: Option<OffTravel>,
}

impl ReadJob {
    /// Plans the path under the limits of `scene`, which gets its moves.
    ///
    /// # Errors
    /// The path has no plan.
    pub fn plan(&self, scene: &mut Scene) -> Result<(), JobRefusal> {
        let planned = scene.take_path(&self.path);
        planned.map_err(|error| self.places.refusal(&error))
    }
}

/// Scene of the job in `file` on `machine`, without its moves.
pub fn job_scene(file: &str, machine: &Scene) -> Scene {
    Scene {
        name: job_name(Path::new(file), &machine.name),
        description: format!("{file} on the machine {}", machine.name),
        ..machine.clone()
    }
}

/// Reads G-code.
///
/// # Errors
/// The first line that is refused; nothing moves.
pub fn gcode_job(
    text: impl BufRead,
    machine: &Scene,
    options: &JobOptions,
) -> Result<ReadJob, PathFault> {
    let mut elements = gcode::elements(text, gcode_setup(machine, options));
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in elements.by_ref() {
        builder.push(&element?)?;
    }
    builder.reader.watch.program(elements.remarks());
    let blend_m = elements.interpreter().modal().blend_m;
    let corner_m = blend_m.unwrap_or(options.corner_m);
    finish_job(builder, corner_m, options.repeat, PlacesIn::Lines)
}

/// Zero points and modes with which a program begins.
pub fn gcode_setup(machine: &Scene, options: &JobOptions) -> GcodeSetup {
    let start = machine.job.start;
    let start = ToolPlace {
        position_m: [start.position.x, start.position.y],
        alpha_rad: start.angle,
    };
    GcodeSetup {
        start,
        origins: [options.origin; 6],
        full_power: options.full_power,
        home: Some(start),
        z: options.z,
        // At most eight.
        outputs: machine.spare_pins.outputs.len() as u8,
        inputs: machine.spare_pins.inputs.len() as u8,
    }
}

/// Reads a table of poses.
///
/// # Errors
/// The first cell that is refused; nothing moves.
pub fn table_job(text: &str, machine: &Scene, options: &JobOptions) -> Result<ReadJob, PathFault> {
    let setup = TableSetup {
        origin: options.origin,
        alpha_rad: machine.job.start.angle,
        feed_m_s: options.drawing.speed_m_s,
        follows_speed: !options.drawing.constant_power,
    };
    element_job(
        &read_table(text, &setup)?,
        machine,
        options,
        PlacesIn::Lines,
    )
}

/// Places a drawing on a machine.
///
/// # Errors
/// The drawing has no speed, all of it is left out, or the machine has no room for it.
pub fn drawing_job(
    drawing: Drawing,
    machine: &Scene,
    options: &JobOptions,
) -> Result<ReadJob, PathFault> {
    let origin_m = level_origin_m(options)?;
    let mut placed = place(drawing, machine, origin_m, &options.drawing)?;
    let scale = placed.setup.scale;
    let travel = OffTravel {
        in_file_m: scale * placed.travel.in_file_m,
        ordered_m: scale * placed.travel.ordered_m,
    };
    let elements = placed.drawing.elements(&placed.setup);
    let (fitted, remarks) = (placed.fitted, std::mem::take(&mut placed.drawing.remarks));
    let places = PlacesIn::Drawing(Box::new(placed));
    let mut job = element_job(&elements, machine, options, places)?;
    job.watch.say(remarks);
    Ok(ReadJob {
        fitted,
        travel: Some(travel),
        ..job
    })
}

/// Path of `elements`.
///
/// # Errors
/// A stand longer than a machine counts; nothing moves.
pub fn element_job(
    elements: &[Element],
    machine: &Scene,
    options: &JobOptions,
    places: PlacesIn,
) -> Result<ReadJob, PathFault> {
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in elements {
        builder.push(element)?;
    }
    finish_job(builder, options.corner_m, options.repeat, places)
}

/// Ends a path: corners are rounded, and it is repeated.
///
/// # Errors
/// Nothing moves; so many times are too many.
pub fn finish_job(
    mut builder: PathBuilder,
    corner_m: f64,
    repeat: u32,
    places: PlacesIn,
) -> Result<ReadJob, PathFault> {
    let pass = builder.reader.pass();
    builder.repeat(repeat)?;
    let mut watch = std::mem::take(&mut builder.reader.watch);
    watch.repeats(repeat);
    if !matches!(places, PlacesIn::Lines) {
        watch.is_drawn();
    }
    Ok(ReadJob {
        pauses: std::mem::take(&mut builder.reader.pauses),
        watch,
        path: builder.finish(corner_m)?,
        places: ElementPlaces {
            places,
            pass,
            repeat,
        },
        fitted: None,
        travel: None,
    })
}

/// Zero point of a file that does not turn the platform, m.
///
/// # Errors
/// The options turn the platform.
pub fn level_origin_m(options: &JobOptions) -> Result<[f64; 2], PathFault> {
    match options.origin.alpha_rad {
        0.0 => Ok(options.origin.position_m),
        _ => Err(PathFault {
            line: 0,
            word: "--origin".into(),
            reason: "drawings and images do not turn the platform; leave ALPHA out".into(),
        }),
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
