//! Files of jobs, by their kinds: to the path of a job on a machine.

use super::JobFileArgs;
use super::drawing::{self, PlacedDrawing};
use super::path::PathBuilder;
use crate::failure::CliError;
use crate::terminal::say;
use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::Path;
use trirrr_scene::{JobPath, Scene};
use trirrr_toolpath::drawing::{Drawing, read_dxf, read_svg};
use trirrr_toolpath::gcode::{self, GcodeSetup};
use trirrr_toolpath::table::{TableSetup, read_table};
use trirrr_toolpath::{PathFault, ToolPlace};

/// Path of a file, before it is planned.
pub(super) struct ReadPath {
    pub(super) path: JobPath,
    pub(super) pauses: Vec<u32>,
    /// The drawing that the numbers of elements are places in.
    drawing: Option<Drawing>,
}

impl ReadPath {
    /// Place in the file of an element.
    pub(super) fn place(&self, number: u32) -> String {
        match &self.drawing {
            Some(drawing) => format!(" {}", drawing.place_of(number)),
            None => number.to_string(),
        }
    }
}

/// Reads the path of `file` for `machine`.
///
/// # Errors
/// Refused: the file cannot be read, or has arguments of another kind of file; then its own fault.
pub(super) fn read(
    file: &Path,
    machine: &Scene,
    args: &JobFileArgs,
) -> Result<Result<ReadPath, PathFault>, CliError> {
    let name = file.display();
    let refused = |error: io::Error| CliError::Refused(format!("{name}: cannot be read: {error}"));
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    let (kind, not_for_it) = match extension.to_str() {
        Some("svg" | "dxf") => ("a drawing", None),
        Some("csv") => ("a table", args.drawing.for_drawings()),
        _ => ("G-code", args.drawing.given()),
    };
    if let Some(argument) = not_for_it {
        let reason = format!("{name}: {argument} is not for {kind}; leave it out");
        return Err(CliError::Refused(reason));
    }
    let read = match kind {
        "G-code" => from_gcode(File::open(file).map_err(refused)?, machine, args),
        "a table" => from_table(&fs::read_to_string(file).map_err(refused)?, machine, args),
        _ => {
            let drawing = match extension == "dxf" {
                true => read_dxf(&fs::read(file).map_err(refused)?, |layer| {
                    args.drawing.leaves_out(layer)
                }),
                false => read_svg(&fs::read_to_string(file).map_err(refused)?),
            };
            drawing.and_then(|drawing| from_drawing(drawing, machine, args))
        }
    };
    Ok(read)
}

fn from_gcode(file: File, machine: &Scene, args: &JobFileArgs) -> Result<ReadPath, PathFault> {
    let mut elements = gcode::elements(BufReader::new(file), setup(machine, args));
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in elements.by_ref() {
        builder.push(&element?)?;
    }
    let blend_m = elements.interpreter().modal().blend_m;
    finish(builder, blend_m.unwrap_or(1e-3 * args.corner), None)
}

fn from_table(text: &str, machine: &Scene, args: &JobFileArgs) -> Result<ReadPath, PathFault> {
    let setup = TableSetup {
        origin: origin(args),
        alpha_rad: machine.job.start.angle,
        feed_m_s: args.drawing.speed_m_s(),
        follows_speed: !args.drawing.constant_power,
    };
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in read_table(text, &setup)? {
        builder.push(&element)?;
    }
    finish(builder, 1e-3 * args.corner, None)
}

fn from_drawing(
    drawing: Drawing,
    machine: &Scene,
    args: &JobFileArgs,
) -> Result<ReadPath, PathFault> {
    if args.origin.is_some_and(|[_, _, alpha]| alpha != 0.0) {
        return Err(PathFault {
            line: 0,
            word: "--origin".into(),
            reason: "a drawing does not turn the platform; leave ALPHA out".into(),
        });
    }
    let origin_m = args.origin.map(|_| origin(args).position_m);
    let PlacedDrawing { drawing, setup } =
        drawing::place(drawing, machine, origin_m, &args.drawing)?;
    if args.drawing.fit {
        let [x, y] = setup.origin.position_m.map(|metres| 1e3 * metres);
        say(&format!(
            "--fit: as --scale {:.4} --origin {x:.3},{y:.3}",
            setup.scale
        ));
    }
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in drawing.elements(&setup) {
        builder.push(&element)?;
    }
    finish(builder, 1e-3 * args.corner, Some(drawing))
}

fn finish(
    mut builder: PathBuilder,
    corner_m: f64,
    drawing: Option<Drawing>,
) -> Result<ReadPath, PathFault> {
    Ok(ReadPath {
        pauses: std::mem::take(&mut builder.pauses),
        path: builder.finish(corner_m)?,
        drawing,
    })
}

fn setup(machine: &Scene, args: &JobFileArgs) -> GcodeSetup {
    let start = machine.job.start;
    let start = ToolPlace {
        position_m: [start.position.x, start.position.y],
        alpha_rad: start.angle,
    };
    GcodeSetup {
        start,
        origins: [origin(args); 6],
        full_power: args.full_power,
        home: Some(start),
        ignore_z: args.ignore_z,
    }
}

/// Zero point of the file.
fn origin(args: &JobFileArgs) -> ToolPlace {
    let [x, y, alpha] = args.origin.unwrap_or([0.0; 3]);
    ToolPlace {
        position_m: [1e-3 * x, 1e-3 * y],
        alpha_rad: alpha.to_radians(),
    }
}
