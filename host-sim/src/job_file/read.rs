//! Files of jobs, by their kinds: to the path of a job on a machine.

use super::drawing::{self, PlacedDrawing};
use super::image;
use super::long::LongPath;
use super::path::{PathBuilder, too_often};
use super::{JobFileArgs, LongMoves};
use crate::failure::CliError;
use std::fs::{self, File};
use std::io::{self, BufReader};
use std::path::Path;
use trirrr_scene::{JobPath, NumberType, Scene};
use trirrr_toolpath::drawing::{Drawing, read_dxf, read_svg};
use trirrr_toolpath::gcode::{self, GcodeSetup};
use trirrr_toolpath::raster::{RasterPath, read_image};
use trirrr_toolpath::table::{TableSetup, read_table};
use trirrr_toolpath::{Element, PathFault, ToolPlace};

/// Pieces beyond which a path is long.
const LONG_PIECES: usize = 8192;

/// Path of a file, before it is planned.
pub(super) struct ReadPath {
    pub(super) way: ReadWay,
    pub(super) pauses: Vec<u32>,
    pub(super) places: ElementPlaces,
}

/// Way of a path into the planner.
pub(super) enum ReadWay {
    /// The whole path, in memory.
    Whole(JobPath),
    /// Path that is read once more, block by block.
    Long(LongPath),
}

/// Places in the file of the elements of a path.
pub(super) struct ElementPlaces {
    places: PlacesIn,
    /// Numbers of elements that each pass through the file has.
    pass: u32,
    repeat: u32,
}

/// PlacesIn in a file, by the numbers of elements.
enum PlacesIn {
    Lines,
    Drawing(Drawing),
    Image(RasterPath),
}

/// Kind of a job's file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum JobKind {
    Gcode,
    Table,
    Drawing,
    Image,
}

impl JobKind {
    /// Kind of a file with this extension.
    fn of(extension: &str) -> Self {
        match extension {
            "svg" | "dxf" => Self::Drawing,
            "png" | "jpg" | "jpeg" | "bmp" => Self::Image,
            "csv" => Self::Table,
            _ => Self::Gcode,
        }
    }

    fn name(self) -> &'static str {
        match self {
            Self::Gcode => "G-code",
            Self::Table => "a table",
            Self::Drawing => "a drawing",
            Self::Image => "an image",
        }
    }

    /// First argument that is given and not for this kind.
    fn not_for_it(self, args: &JobFileArgs) -> Option<&'static str> {
        let of_images = args.image.given().map(|name| (name, &[Self::Image][..]));
        let mut given = args.drawing.given().chain(of_images);
        given
            .find(|(_, kinds)| !kinds.contains(&self))
            .map(|(name, _)| name)
    }
}

impl ElementPlaces {
    /// Place in the file of an element, by its number from 1.
    pub(super) fn of(&self, number: u32) -> String {
        let behind = number.saturating_sub(1);
        let (pass, number) = (behind / self.pass + 1, behind % self.pass + 1);
        let place = match &self.places {
            PlacesIn::Drawing(drawing) => format!(" {}", drawing.place_of(number)),
            PlacesIn::Image(rows) => format!(" {}", rows.place_of(number)),
            PlacesIn::Lines => number.to_string(),
        };
        match self.repeat {
            1 => place,
            repeat if number == self.pass => format!(" way back after time {pass} of {repeat}"),
            repeat => format!("{place} (time {pass} of {repeat})"),
        }
    }
}

/// Reads the path of `file` for `machine`. A long one of G-code is only looked through where its `moves` may be in a file.
///
/// # Errors
/// Refused: the file cannot be read, or has arguments of another kind of file; then its own fault.
pub(super) fn read(
    file: &Path,
    machine: &Scene,
    args: &JobFileArgs,
    moves: LongMoves,
) -> Result<Result<ReadPath, PathFault>, CliError> {
    let name = file.display();
    let refused = |error: io::Error| CliError::Refused(format!("{name}: cannot be read: {error}"));
    let extension = file.extension().unwrap_or_default().to_ascii_lowercase();
    let kind = JobKind::of(extension.to_str().unwrap_or_default());
    if let Some(argument) = kind.not_for_it(args) {
        let reason = format!(
            "{name}: {argument} is not for {}; leave it out",
            kind.name()
        );
        return Err(CliError::Refused(reason));
    }
    let bytes = || fs::read(file).map_err(refused);
    let text = || fs::read_to_string(file).map_err(refused);
    Ok(match kind {
        JobKind::Gcode => {
            let open = File::open(file).map_err(refused)?;
            // A pipe is read once.
            let is_file = open.metadata().is_ok_and(|metadata| metadata.is_file());
            match moves == LongMoves::InFile && is_file && can_spool(machine) {
                true => from_gcode(open, machine, args, Some(file)),
                false => from_gcode(open, machine, args, None),
            }
        }
        JobKind::Table => from_table(&text()?, machine, args),
        JobKind::Image => from_image(&bytes()?, machine, args),
        JobKind::Drawing => {
            let drawing = match extension == "dxf" {
                true => read_dxf(&bytes()?, |layer| args.drawing.leaves_out(layer)),
                false => read_svg(&text()?),
            };
            drawing.and_then(|drawing| from_drawing(drawing, machine, args))
        }
    })
}

/// Returns true if the moves of a long job may be in a file on this machine: a plant looks at all of them, and numbers of little
/// range need units for all.
fn can_spool(machine: &Scene) -> bool {
    machine.plant.is_none() && machine.number != NumberType::Fixed
}

/// Reads G-code. With `again`, a file that can be read again, a long path is only counted.
fn from_gcode(
    file: File,
    machine: &Scene,
    args: &JobFileArgs,
    again: Option<&Path>,
) -> Result<ReadPath, PathFault> {
    let mut elements = gcode::elements(BufReader::new(file), setup(machine, args));
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in elements.by_ref() {
        builder.push(&element?)?;
        let pieces = builder.reader.pieces().saturating_mul(args.repeat as usize);
        if again.is_some() && pieces > LONG_PIECES {
            builder.count_only();
        }
    }
    let blend_m = elements.interpreter().modal().blend_m;
    let corner_m = blend_m.unwrap_or(1e-3 * args.corner);
    let Some(file) = again.filter(|_| !builder.has_parts()) else {
        return finish(builder, corner_m, args.repeat, PlacesIn::Lines);
    };
    let (pass, repeat) = (builder.reader.pass(), args.repeat);
    // Elements are counted in 32 bits.
    if pass.checked_mul(repeat).is_none() {
        return Err(too_often(repeat, u32::MAX as usize));
    }
    Ok(ReadPath {
        pauses: builder.reader.pauses,
        way: ReadWay::Long(LongPath {
            file: file.into(),
            setup: setup(machine, args),
            start: machine.job.start,
            rate_hz: machine.tick_rate_hz,
            corner_m,
            pass,
            repeat,
        }),
        places: ElementPlaces {
            places: PlacesIn::Lines,
            pass,
            repeat,
        },
    })
}

fn from_table(text: &str, machine: &Scene, args: &JobFileArgs) -> Result<ReadPath, PathFault> {
    let setup = TableSetup {
        origin: origin(args),
        alpha_rad: machine.job.start.angle,
        feed_m_s: args.drawing.speed_m_s(),
        follows_speed: !args.drawing.constant_power,
    };
    with_elements(read_table(text, &setup)?, machine, args, PlacesIn::Lines)
}

fn from_drawing(
    drawing: Drawing,
    machine: &Scene,
    args: &JobFileArgs,
) -> Result<ReadPath, PathFault> {
    let origin_m = level_origin(args)?;
    let PlacedDrawing { drawing, setup } =
        drawing::place(drawing, machine, origin_m, &args.drawing)?;
    let elements = drawing.elements(&setup);
    with_elements(elements, machine, args, PlacesIn::Drawing(drawing))
}

fn from_image(bytes: &[u8], machine: &Scene, args: &JobFileArgs) -> Result<ReadPath, PathFault> {
    let mut rows = image::rows(&read_image(bytes)?, machine, level_origin(args)?, args)?;
    let elements = std::mem::take(&mut rows.elements);
    let lists = std::mem::take(&mut rows.lists);
    let mut lists = lists.into_iter().peekable();
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in &elements {
        match lists.next_if(|(line, _)| *line == element.line) {
            Some((_, levels)) => builder.push_row(element, &levels)?,
            None => builder.push(element)?,
        }
    }
    finish(
        builder,
        1e-3 * args.corner,
        args.repeat,
        PlacesIn::Image(rows),
    )
}

fn with_elements(
    elements: Vec<Element>,
    machine: &Scene,
    args: &JobFileArgs,
    places: PlacesIn,
) -> Result<ReadPath, PathFault> {
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in &elements {
        builder.push(element)?;
    }
    finish(builder, 1e-3 * args.corner, args.repeat, places)
}

fn finish(
    mut builder: PathBuilder,
    corner_m: f64,
    repeat: u32,
    places: PlacesIn,
) -> Result<ReadPath, PathFault> {
    let pass = builder.reader.pass();
    builder.repeat(repeat)?;
    Ok(ReadPath {
        pauses: std::mem::take(&mut builder.reader.pauses),
        way: ReadWay::Whole(builder.finish(corner_m)?),
        places: ElementPlaces {
            places,
            pass,
            repeat,
        },
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

/// Zero point of a file that does not turn the platform, m.
fn level_origin(args: &JobFileArgs) -> Result<[f64; 2], PathFault> {
    match args.origin {
        Some([_, _, alpha]) if alpha != 0.0 => Err(PathFault {
            line: 0,
            word: "--origin".into(),
            reason: "drawings and images do not turn the platform; leave ALPHA out".into(),
        }),
        _ => Ok(origin(args).position_m),
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
