//! Jobs in files of their own, on the machine of a scene.

use crate::reading::{DrawnPath, Reading};
use trirrr_core::setpoint::Pose;
use trirrr_jobs::{
    DrawingOptions, JobOptions, JobRefusal, ReadJob, breach, drawing_job, gcode_job, job_scene,
};
use trirrr_plan::piece::Piece;
use trirrr_scene::{JobPath, Scene};
use trirrr_toolpath::drawing::FlatDrawing;
use trirrr_toolpath::gcode::ZWords;
use trirrr_toolpath::{PathFault, PathRemark, ToolPlace};
use wasm_bindgen::prelude::wasm_bindgen;

/// Most points along a piece of a path that is drawn, and on all pieces of a long one.
const POINTS: usize = 12;
const POINTS_MAX: usize = 24_000;

/// Choices that a job's file leaves open: the arguments of `trirrr run` of the same names.
#[wasm_bindgen]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct JobInputs {
    /// Zero point of the file, x, mm.
    pub x_mm: f64,
    /// Its y, mm.
    pub y_mm: f64,
    /// Its angle, degrees.
    pub alpha_deg: f64,
    /// Distance by which a corner may be rounded, mm. None: 0.01.
    pub corner_mm: Option<f64>,
    /// G-code: the tool is on at this height of the file and below, mm. None: Z is no tool.
    pub tool_by_z_mm: Option<f64>,
    /// G-code: words of Z are left out.
    pub ignore_z: bool,
    /// Drawing: speed along strokes, mm/min.
    pub speed_mm_min: Option<f64>,
    /// Drawing: power along strokes, 0 to 1. None: 1.
    pub power: Option<f64>,
    /// Drawing: length on the machine of a length 1 in the file. None: 1.
    pub scale: Option<f64>,
    /// Drawing: distance of the lines that fill areas, mm.
    pub hatch_mm: Option<f64>,
    /// Drawing: lines and curves that lie on others are left out.
    pub drop_doubles: bool,
    /// Drawing: it goes where the machine has the most room, in place of the zero point.
    pub fit: bool,
}

#[wasm_bindgen]
impl JobInputs {
    /// Inputs where nothing is given.
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self::default()
    }
}

impl JobInputs {
    /// The options that the inputs give.
    ///
    /// # Errors
    /// An input out of the range that the command line takes.
    fn options(&self) -> Result<JobOptions, String> {
        let place = |name: &str, value: f64| match value.abs() <= 1e6 {
            true => Ok(value),
            false => Err(format!(
                "{name}: expected a number from -1000000 to 1000000"
            )),
        };
        let within = |name: &str, value: Option<f64>, range: [f64; 2], words: &str| match value {
            Some(value) if !(range[0]..=range[1]).contains(&value) => {
                Err(format!("{name}: expected {words}"))
            }
            value => Ok(value),
        };
        let factor =
            |name, value| within(name, value, [1e-3, 1e6], "a number from 0.001 to 1000000");
        let default = JobOptions::default();
        let corner = within("--corner", self.corner_mm, [0.0, 100.0], "0 to 100 mm")?;
        // A drawing that finds its place has no zero point of its own.
        let origin = match self.fit {
            true => ToolPlace::default(),
            false => ToolPlace {
                position_m: [
                    1e-3 * place("--origin", self.x_mm)?,
                    1e-3 * place("--origin", self.y_mm)?,
                ],
                alpha_rad: place("--origin", self.alpha_deg)?.to_radians(),
            },
        };
        Ok(JobOptions {
            origin,
            z: match self.tool_by_z_mm {
                Some(height) => ZWords::Tool {
                    on_at_m: 1e-3 * place("--tool-by-z", height)?,
                },
                None if self.ignore_z => ZWords::Ignored,
                None => ZWords::Refused,
            },
            corner_m: corner.map_or(default.corner_m, |corner| 1e-3 * corner),
            drawing: DrawingOptions {
                speed_m_s: factor("--speed", self.speed_mm_min)?.map(|speed| 1e-3 * speed / 60.0),
                power: within("--power", self.power, [0.0, 1.0], "a part from 0 to 1")?,
                scale: factor("--scale", self.scale)?,
                hatch_m: factor("--hatch", self.hatch_mm)?.map(|pitch| 1e-3 * pitch),
                fit: self.fit,
                drop_doubles: self.drop_doubles,
                ..DrawingOptions::default()
            },
            ..default
        })
    }
}

/// Drawing that the reader of drawings, a module of its own, has read or refused.
#[wasm_bindgen]
#[derive(Clone, Debug)]
pub struct GivenDrawing(Result<FlatDrawing, PathFault>);

#[wasm_bindgen]
impl GivenDrawing {
    /// A drawing that was read.
    pub fn read(numbers: Vec<f64>, names: Vec<String>) -> Self {
        Self(Ok(FlatDrawing { numbers, names }))
    }

    /// A refusal; `line` is 0 where the file has no place for it.
    pub fn refused(line: u32, word: String, reason: String) -> Self {
        Self(Err(PathFault { line, word, reason }))
    }
}

#[wasm_bindgen]
impl Reading {
    /// Reads the job in `text`, G-code, or the `drawing` that was read from it, for the machine of this scene, as
    /// `trirrr run FILE --machine SCENE` does. Problems of the answer stand in the lines of that file.
    ///
    /// # Errors
    /// The scene is refused, or was read as a draft.
    #[wasm_bindgen(js_name = withJob)]
    pub fn with_job(
        &self,
        text: &str,
        file: &str,
        inputs: &JobInputs,
        drawing: Option<GivenDrawing>,
    ) -> Result<Self, String> {
        let scene = self.good()?;
        Ok(plan(scene, text, file, inputs, drawing))
    }
}

/// Reads and plans the job in `text`, or in `drawing`, for the machine of `machine`.
fn plan(
    machine: &Scene,
    text: &str,
    file: &str,
    inputs: &JobInputs,
    drawing: Option<GivenDrawing>,
) -> Reading {
    let refused =
        |refusal: JobRefusal, path: DrawnPath| Reading::of_refused_job(text, file, &refusal, path);
    let read = match read(machine, text, inputs, drawing) {
        Ok(read) => read,
        Err(refusal) => return refused(refusal, DrawnPath::default()),
    };
    let mut scene = job_scene(file, machine);
    let mut drawn = DrawnPath {
        points: points(&read.path, &machine.job.start),
        breach: None,
        notes: Vec::new(),
    };
    match scene.take_path(&read.path) {
        Ok(()) => {
            drawn.notes = notes(&read, &scene);
            Reading::of_job(scene, drawn)
        }
        Err(error) => {
            drawn.breach = breach(&error);
            refused(read.places.refusal(&error), drawn)
        }
    }
}

fn read(
    machine: &Scene,
    text: &str,
    inputs: &JobInputs,
    drawing: Option<GivenDrawing>,
) -> Result<ReadJob, JobRefusal> {
    let options = inputs.options().map_err(|reason| JobRefusal {
        line: None,
        text: format!(" {reason}"),
        reason,
    })?;
    let Some(GivenDrawing(given)) = drawing else {
        return Ok(gcode_job(text.as_bytes(), machine, &options)?);
    };
    let drawing = given?.drawing().ok_or_else(|| PathFault {
        line: 0,
        word: String::new(),
        reason: "the reader of drawings has answered with none".into(),
    })?;
    Ok(drawing_job(drawing, machine, &options)?)
}

/// Returns true for the name of a drawing; other files are G-code.
#[wasm_bindgen(js_name = isDrawing)]
pub fn is_drawing(file: &str) -> bool {
    let file = file.to_ascii_lowercase();
    file.ends_with(".svg") || file.ends_with(".svgz")
}

fn notes(read: &ReadJob, scene: &Scene) -> Vec<String> {
    let remarks = read.watch.remarks(scene);
    let fitted = read.fitted.map(|fitted| format!("--fit: as {fitted}"));
    let pauses = read.pauses.iter().map(|line| {
        format!(
            "line {line} waits for the user or an input; here the motion stops there and goes on"
        )
    });
    let remarks = remarks.iter().map(PathRemark::to_string);
    fitted.into_iter().chain(remarks).chain(pauses).collect()
}

/// Points along a path that begins at `start`.
fn points(path: &JobPath, start: &Pose<f64>) -> Vec<f64> {
    let count = (POINTS_MAX / path.pieces.len().max(1)).clamp(1, POINTS);
    let along = |piece: &Piece<f64>| {
        let places = (1..=count).map(|step| step as f64 / count as f64);
        let points = places.map(|place| piece.at(place).pose.position.into());
        points.collect::<Vec<[f64; 2]>>()
    };
    let pieces = path.pieces.iter().flat_map(|each| along(&each.piece));
    let all = std::iter::once(start.position.into()).chain(pieces);
    all.flatten().collect()
}
