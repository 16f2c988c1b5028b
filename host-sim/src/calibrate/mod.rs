//! `trirrr calibrate`: the machine that is there, from measurements; and what to measure next.

mod args;
mod board;
mod document;
mod next;
mod patch;

pub use args::{CalibrateArgs, MeasuredKind};

pub(crate) use document::directions;

use crate::failure::CliError;
use crate::figures::CalibrationFigures;
use crate::patched_scene::PatchedScene;
use crate::results::ResultFolder;
use crate::terminal::show;
use board::CalibratedBoard;
use next::NextPoses;
use patch::patch;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use trirrr_calibration::{
    Calibration, CalibrationRefusal, ColumnFault, MARGIN, MeasuredRow, SafeRegion, calibrate,
    read_measurements,
};
use trirrr_scene::Scene;
use trirrr_scene::read::files::{self, LONGEST_TABLE};

/// Files that are written for a calibration.
struct CalibrateFiles {
    files: Vec<PathBuf>,
    /// Reason for which the calibrated scene is refused.
    refusal: Option<String>,
    /// Key of the scene that has the encoder offsets; none where there is none.
    offsets_in: Option<&'static str>,
}

/// Everything that is found.
struct Findings<'a> {
    scene: &'a Scene,
    region: &'a Region,
    calibration: Option<&'a Calibration>,
    next: Option<&'a NextPoses>,
    board: Option<&'a CalibratedBoard>,
}

/// Poses over which errors are told.
struct Region {
    safe: SafeRegion,
    turn_rad: f64,
    margin: [f64; 2],
}

/// Calibrates, proposes, sends the geometry to a board, writes and prints.
///
/// # Errors
/// Refused: the scene, the measurements, measurements that see nothing useful, or by the board. Failed: the port, or a file that cannot be written.
pub fn command(args: &CalibrateArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let scene = args.set.scene(&args.scene)?;
    // A table that cannot be read is told before the workspace is proven.
    let rows = args.measurements.as_ref().map(|file| read(file, args));
    let rows = rows.transpose()?;
    let mut results = results(&scene, args)?;
    let region = region(&scene, args)?;
    let setup = args.setup();
    let places = region.safe.poses();
    let start = region.safe.start();
    let calibration = match args.measurements.as_ref().zip(rows) {
        None => None,
        Some((file, rows)) => {
            let found = calibrate(&scene.parameters, start, &rows, &setup, &places);
            Some(found.map_err(|refusal| refused(file, refusal))?)
        }
    };
    let next = args
        .propose
        .map(|count| NextPoses::find(&scene, args, &region.safe, calibration.as_ref(), count));
    let next = next.transpose()?;
    let board = match (args.machine(), &calibration) {
        (Some(machine), Some(calibration)) => Some(CalibratedBoard::set(
            &machine,
            args.board.joints_placed,
            &scene,
            calibration,
            stop,
        )?),
        _ => None,
    };

    let mut written = CalibrateFiles {
        files: Vec::new(),
        refusal: None,
        offsets_in: None,
    };
    let findings = Findings {
        scene: &scene,
        region: &region,
        calibration: calibration.as_ref(),
        next: next.as_ref(),
        board: board.as_ref(),
    };
    if let Some(calibration) = &calibration {
        let (patched, offsets_in) = patch(&scene, args, calibration)?;
        written.offsets_in = offsets_in;
        let copies = patched.write(&mut results, &document::head(calibration, args, offsets_in))?;
        written.files.extend(copies.files);
        written.refusal = copies.refusal;
        let table = document::residuals(calibration);
        written.files.push(results.write("residuals.csv", table)?);
        let figures = CalibrationFigures {
            name: &scene.name,
            rows: &calibration.rows,
        };
        written.files.extend(figures.write_all(&mut results)?);
    }
    if let Some(next) = &next {
        for (name, table) in [(POSES, next.table(args.dwell)), (FORM, next.form(args))] {
            written.files.push(results.write(name, table)?);
        }
    }
    let mut document = document::document(&findings, args, &written);
    let json = format!("{:#}\n", document.json());
    written.files.push(results.write("calibration.json", json)?);
    results.end(None)?;
    show(document.files(written.files), args.json)
}

/// Tables of a proposal: the poses, and the table to be filled in. They stay until there is another proposal.
const POSES: &str = "poses.csv";
const FORM: &str = "measurements-next.csv";

/// Takes the folder for the results, before the work begins and before a board is changed.
fn results(scene: &Scene, args: &CalibrateArgs) -> Result<ResultFolder, CliError> {
    let folder = match &args.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(format!("{}-calibration", scene.name)),
    };
    let mut results = ResultFolder::for_command(&folder, "calibrate")?;
    results.claim(["calibration.json"])?;
    if args.measurements.is_some() {
        results.claim(["residuals.csv", "residuals.svg", "vectors.svg"])?;
        results.claim(PatchedScene::names(scene, &args.scene))?;
    }
    match args.propose {
        Some(_) => results.claim([POSES, FORM])?,
        None => results = results.keeping(&[POSES, FORM]),
    }
    Ok(results)
}

fn read(file: &Path, args: &CalibrateArgs) -> Result<Vec<MeasuredRow>, CliError> {
    let rows = read_measurements(&text_file(file)?, &args.noise());
    rows.map_err(|faults| of_lines(file, &faults))
}

/// Text of a table.
///
/// # Errors
/// Refused: the file cannot be read, or is no text.
pub(crate) fn text_file(file: &Path) -> Result<String, CliError> {
    let refused = |reason: String| CliError::Refused(format!("{}: {reason}", file.display()));
    files::text_in(file, LONGEST_TABLE).map_err(|error| refused(format!("cannot be read: {error}")))
}

/// A refusal with the file before each of its lines.
pub(crate) fn of_lines(file: &Path, faults: &[ColumnFault]) -> CliError {
    let lines = faults.iter().map(|fault| {
        let space = if fault.line == 0 { " " } else { "" };
        format!(
            "{}:{space}{}",
            file.display(),
            fault.to_string().trim_start()
        )
    });
    CliError::Refused(lines.collect::<Vec<_>>().join("\n"))
}

fn refused(file: &Path, refusal: CalibrationRefusal) -> CliError {
    match refusal {
        CalibrationRefusal::Rows(faults) => of_lines(file, &faults),
        other => CliError::Refused(format!("{}: {other}", file.display())),
    }
}

/// The largest region that there is: with less turn, and nearer to singularities, where the start leaves no room.
fn region(scene: &Scene, args: &CalibrateArgs) -> Result<Region, CliError> {
    let turn_rad = args.turn.to_radians();
    let choices = [
        (turn_rad, MARGIN),
        (0.5 * turn_rad, MARGIN),
        (0.0, MARGIN),
        (0.0, [0.0; 2]),
    ];
    let found = choices.into_iter().find_map(|(turn_rad, margin)| {
        let safe = SafeRegion::of(scene, turn_rad, margin)?;
        Some(Region {
            safe,
            turn_rad,
            margin,
        })
    });
    found.ok_or_else(|| {
        CliError::Refused(format!(
            "{}: no cell around the start of the job is proven to keep the distances of [limits], and to be held by the motors: start the job farther inside",
            args.scene.display()
        ))
    })
}
