//! Files of jobs, by their kinds: to the path of a job on a machine.

#[cfg(feature = "full")]
use super::image;
use super::kind::JobKind;
use super::long::LongPath;
use super::{JobFileArgs, LongMoves};
use crate::failure::CliError;
use crate::terminal::say;
use std::fs::File;
use std::io::{self, BufReader};
use std::path::Path;
use trirrr_jobs::{
    ElementPlaces, JobOptions, JobWatch, PathBuilder, PlacesIn, ReadJob, drawing_job, finish_job,
    gcode_job, gcode_setup, table_job, too_often,
};
use trirrr_scene::read::files::{self, LONGEST_TABLE};
use trirrr_scene::{JobPath, NumberType, Scene};
use trirrr_toolpath::PathFault;
use trirrr_toolpath::gcode;
#[cfg(feature = "full")]
use trirrr_toolpath::{
    drawing::{Drawing, read_dxf, read_svg},
    raster::read_image,
};

/// Pieces beyond which a path is long.
const LONG_PIECES: usize = 8192;

/// Path of a file, before it is planned.
pub(super) struct ReadPath {
    pub(super) way: ReadWay,
    pub(super) pauses: Vec<u32>,
    pub(super) watch: JobWatch,
    pub(super) places: ElementPlaces,
}

/// Way of a path into the planner.
pub(super) enum ReadWay {
    /// The whole path, in memory.
    Whole(JobPath),
    /// Path that is read once more, block by block.
    Long(LongPath),
}

impl From<ReadJob> for ReadPath {
    fn from(job: ReadJob) -> Self {
        if let Some(fitted) = job.fitted {
            say(&format!("--fit: as {fitted}"));
        }
        // Where the order changes nothing there is nothing to tell.
        if let Some(travel) = job.travel.filter(|way| way.ordered_m < way.in_file_m) {
            let [ordered, in_file] = [travel.ordered_m, travel.in_file_m].map(|way| 1e3 * way);
            say(&format!(
                "order: the ways with the tool off are {ordered:.1} mm, in the order of the file {in_file:.1} mm"
            ));
        }
        Self {
            way: ReadWay::Whole(job.path),
            pauses: job.pauses,
            watch: job.watch,
            places: job.places,
        }
    }
}

/// Looks whether this program reads files as `file`.
///
/// # Errors
/// In `trirrr-full`: drawings and images. Refused: files of programs that are no job.
pub(super) fn require(file: &Path) -> Result<(), CliError> {
    if let Some((kind, instead)) = JobKind::foreign(file) {
        let name = file.display();
        return Err(CliError::Refused(format!("{name}: {kind}; {instead}")));
    }
    match JobKind::of(file) {
        #[cfg(not(feature = "full"))]
        kind @ (JobKind::Drawing | JobKind::Image) => Err(CliError::InFull(kind.name())),
        _ => Ok(()),
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
    let kind = JobKind::of(file);
    if let Some(argument) = args.not_for(kind) {
        let reason = format!(
            "{name}: {argument} is not for {}; leave it out",
            kind.name()
        );
        return Err(CliError::Refused(reason));
    }
    let options = args.options();
    Ok(match kind {
        JobKind::Gcode => {
            let open = files::open(file).map_err(refused)?;
            // A pipe is read once.
            let is_file = open.metadata().is_ok_and(|metadata| metadata.is_file());
            match moves == LongMoves::InFile && is_file && can_spool(machine) {
                true => from_gcode(open, machine, &options, file),
                false => gcode_job(BufReader::new(open), machine, &options).map(ReadPath::from),
            }
        }
        JobKind::Table => {
            let text = files::text_in(file, LONGEST_TABLE).map_err(refused)?;
            table_job(&text, machine, &options).map(ReadPath::from)
        }
        #[cfg(feature = "full")]
        JobKind::Image => {
            let bytes = files::bytes_of(file, LONGEST_TABLE).map_err(refused)?;
            from_image(&bytes, machine, args).map(ReadPath::from)
        }
        #[cfg(feature = "full")]
        JobKind::Drawing => {
            let drawing = drawing_of(file, args).map_err(refused)?;
            let job = drawing.and_then(|drawing| drawing_job(drawing, machine, &options));
            job.map(ReadPath::from)
        }
        #[cfg(not(feature = "full"))]
        JobKind::Image | JobKind::Drawing => return Err(CliError::InFull(kind.name())),
    })
}

/// Returns true if the moves of a long job may be in a file on this machine: a plant looks at all of them, and numbers of little
/// range need units for all.
fn can_spool(machine: &Scene) -> bool {
    machine.plant.is_none() && machine.number != NumberType::Fixed
}

/// Reads G-code in `again`, open as `open`. A long path is only counted.
fn from_gcode(
    open: File,
    machine: &Scene,
    options: &JobOptions,
    again: &Path,
) -> Result<ReadPath, PathFault> {
    let setup = gcode_setup(machine, options);
    let mut elements = gcode::elements(BufReader::new(open), setup.clone());
    let mut builder = PathBuilder::new(machine.job.start, machine.tick_rate_hz);
    for element in elements.by_ref() {
        builder.push(&element?)?;
        let pieces = builder.reader.pieces();
        if pieces.saturating_mul(options.repeat as usize) > LONG_PIECES {
            builder.count_only();
        }
    }
    builder.reader.watch.program(elements.remarks());
    let blend_m = elements.interpreter().modal().blend_m;
    let corner_m = blend_m.unwrap_or(options.corner_m);
    if builder.has_parts() {
        return Ok(finish_job(builder, corner_m, options.repeat, PlacesIn::Lines)?.into());
    }
    let (pass, repeat) = (builder.reader.pass(), options.repeat);
    // Elements are counted in 32 bits.
    if pass.checked_mul(repeat).is_none() {
        return Err(too_often(repeat, u32::MAX as usize));
    }
    let mut watch = builder.reader.watch;
    watch.repeats(repeat);
    Ok(ReadPath {
        pauses: builder.reader.pauses,
        watch,
        way: ReadWay::Long(LongPath {
            file: again.into(),
            setup,
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

#[cfg(feature = "full")]
fn drawing_of(file: &Path, args: &JobFileArgs) -> io::Result<Result<Drawing, PathFault>> {
    let is_dxf = file
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("dxf"));
    if let (false, Some(argument)) = (is_dxf, args.drawing.for_dxf()) {
        return Ok(Err(PathFault {
            line: 0,
            word: argument.to_owned(),
            reason: "it is for DXF alone; leave it out".to_owned(),
        }));
    }
    Ok(match is_dxf {
        true => read_dxf(
            &files::bytes_of(file, LONGEST_TABLE)?,
            &args.drawing.dxf_choices(),
        ),
        false => read_svg(files::bytes_of(file, LONGEST_TABLE)?),
    })
}

#[cfg(feature = "full")]
fn from_image(bytes: &[u8], machine: &Scene, args: &JobFileArgs) -> Result<ReadJob, PathFault> {
    let mut rows = image::rows(&read_image(bytes)?, machine, args)?;
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
    let options = args.options();
    let places = PlacesIn::Named(Box::new(move |number| rows.place_of(number)));
    finish_job(builder, options.corner_m, options.repeat, places)
}
