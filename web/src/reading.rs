//! The text of a scene, checked.

use crate::{JobMode, Machine, PlayedJob, SimulatedPlant};
use std::path::Path;
use trirrr_jobs::JobRefusal;
use trirrr_scene::read::machine_file_of;
use trirrr_scene::words::tick_time;
use trirrr_scene::{Scene, SceneError, visible};
use wasm_bindgen::prelude::wasm_bindgen;

/// One thing that is wrong with a scene.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Line in the text, from 1.
    pub line: u32,
    /// Column in the line, in characters from 1.
    pub column: u32,
    /// The sentence of `trirrr check`, without file and line: key, value, reason.
    pub sentence: String,
    /// The reason alone, for a message beside key and value.
    pub reason: String,
}

/// Name of the file that the scene in `text` takes its machine from, without folders; none of a scene with a machine of its own.
#[wasm_bindgen(js_name = machineFile)]
pub fn machine_file(text: &str) -> Option<String> {
    machine_file_of(text).map(|path| base_name(Path::new(&path)))
}

fn base_name(path: &Path) -> String {
    let name = path.file_name().unwrap_or_default();
    name.to_string_lossy().into_owned()
}

/// Text of the file of a machine, or what to do about it.
fn machine_text(machine: &Option<String>, path: &Path) -> Result<String, String> {
    machine.clone().ok_or_else(|| {
        let name = base_name(path);
        format!("the page has no file {name}: open or drop {name}, too")
    })
}

/// Line of `text` that names the file of the machine.
fn machine_line(text: &str) -> u32 {
    let names = |line: &str| {
        let key = line.split_once('=').map(|(key, _)| key.trim());
        key == Some("machine")
    };
    text.lines()
        .position(names)
        .map_or(1, |line| line as u32 + 1)
}

/// Path of a file, as it is drawn.
#[derive(Clone, Debug, Default)]
pub(crate) struct DrawnPath {
    /// Points of D, x and y in turns, m.
    pub(crate) points: Vec<f64>,
    /// Place at which the path has no plan.
    pub(crate) breach: Option<[f64; 2]>,
    /// Place and scale that were found, as arguments; warnings of stops for the user.
    pub(crate) notes: Vec<String>,
}

/// A text that was read as a scene.
#[wasm_bindgen]
#[derive(Debug)]
pub struct Reading {
    problems: Vec<Problem>,
    /// Text that `trirrr check` prints of a scene that is refused.
    refusal: Option<String>,
    /// The scene; of one that is refused only where its values are right and its job is not.
    scene: Option<Scene>,
    /// Path of a job in a file of its own.
    drawn: DrawnPath,
}

#[wasm_bindgen]
impl Reading {
    /// Reads the values of `text` and looks at no pose: quick enough for each key stroke. `file` is named in messages. `machine` is the
    /// text of the file that the scene takes its machine from, if [`machine_file`] names one.
    pub fn draft(text: &str, file: &str, machine: Option<String>) -> Self {
        match Scene::draft_from(text, file, &|path| machine_text(&machine, path)) {
            Ok(scene) => Self::of_job(scene, DrawnPath::default()),
            Err(error) => Self::refused(&error, None, text),
        }
    }

    /// Reads `text` as every command of `trirrr` does: poses, limits, and each move by the admission of the machine's service; a path is
    /// planned. Arguments as in [`draft`](Self::draft).
    pub fn whole(text: &str, file: &str, machine: Option<String>) -> Self {
        let (read, shown) =
            Scene::parse_shown(text, file, &[], &|path| machine_text(&machine, path));
        match read {
            Ok(scene) => Self::of_job(scene, DrawnPath::default()),
            Err(error) => Self::refused(&error, shown, text),
        }
    }

    fn refused(error: &SceneError, scene: Option<Scene>, text: &str) -> Self {
        let problems: &[trirrr_scene::Problem] = match error {
            SceneError::Refused { problems, .. } => problems,
            SceneError::Unreadable { .. } => &[],
        };
        let problems = problems.iter().map(|problem| {
            let words = problem.to_string();
            if let Some(source) = &problem.source {
                // The file of the machine has no lines on the page: the line that names it stands for them.
                let sentence = format!("{}:{words}", visible(source));
                return Problem {
                    line: machine_line(text),
                    column: 1,
                    reason: sentence.clone(),
                    sentence,
                };
            }
            // The page shows the line itself.
            let line = format!("{}: ", problem.line);
            Problem {
                line: problem.line as u32,
                column: problem.column as u32,
                sentence: words.strip_prefix(&line).unwrap_or(&words).to_owned(),
                reason: visible(&problem.reason).into_owned(),
            }
        });
        Self {
            problems: problems.collect(),
            refusal: Some(error.to_string()),
            scene,
            drawn: DrawnPath::default(),
        }
    }

    /// A scene that is good, with the path of its file if the job has one.
    pub(crate) fn of_job(scene: Scene, drawn: DrawnPath) -> Self {
        Self {
            problems: Vec::new(),
            refusal: None,
            scene: Some(scene),
            drawn,
        }
    }

    /// The refusal of the job in `text`.
    pub(crate) fn of_refused_job(
        text: &str,
        file: &str,
        refusal: &JobRefusal,
        drawn: DrawnPath,
    ) -> Self {
        let line = refusal.line.unwrap_or(1);
        let written = text.lines().nth(line as usize - 1).unwrap_or_default();
        // A reason begins with the word of the line that it is about.
        let word = refusal.reason.split_once(": ").map(|(word, _)| word);
        let before = word.and_then(|word| {
            let at = written
                .to_ascii_uppercase()
                .find(&word.to_ascii_uppercase());
            written.get(..at?)
        });
        let problem = Problem {
            line,
            column: 1 + before.map_or(0, |before| before.chars().count() as u32),
            sentence: match refusal.line {
                Some(_) => visible(&refusal.reason).into_owned(),
                None => visible(refusal.text.trim_start()).into_owned(),
            },
            reason: visible(&refusal.reason).into_owned(),
        };
        Self {
            problems: vec![problem],
            refusal: Some(format!("{file}:{refusal}")),
            scene: None,
            drawn,
        }
    }

    /// Points of the path in a job's file, x and y in turns, m; none where it cannot be read.
    #[wasm_bindgen(getter)]
    pub fn path(&self) -> Vec<f64> {
        self.drawn.points.clone()
    }

    /// Place at which the path has no plan: x and y, m.
    #[wasm_bindgen(getter)]
    pub fn breach(&self) -> Option<Vec<f64>> {
        self.drawn.breach.map(Vec::from)
    }

    /// Notes of the command line on a job's file: the place that was found for it, lines that wait for the user.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        self.drawn.notes.clone()
    }

    /// Everything that is wrong, in the order of the text; nothing of a good scene.
    #[wasm_bindgen(getter)]
    pub fn problems(&self) -> Vec<Problem> {
        self.problems.clone()
    }

    /// The refusal as `trirrr check` prints it; none of a good scene.
    #[wasm_bindgen(getter)]
    pub fn refusal(&self) -> Option<String> {
        self.refusal.clone()
    }

    /// Extent of a good scene's job in words; none of a scene that is refused.
    #[wasm_bindgen(getter)]
    pub fn verdict(&self) -> Option<String> {
        let scene = self.good().ok()?;
        let moves = scene.job.count();
        Some(format!(
            "{moves} {}, {} s: {} ticks at {} Hz in {}",
            if moves == 1 { "move" } else { "moves" },
            tick_time(scene.duration_s()),
            scene.ticks(),
            scene.tick_rate_hz,
            scene.number,
        ))
    }

    /// Warning of limits that the scene ought to have.
    #[wasm_bindgen(getter)]
    pub fn warning(&self) -> Option<String> {
        self.good().ok().and_then(Scene::limits_warning)
    }

    /// Machine of the scene, also of one whose job alone is refused.
    ///
    /// # Errors
    /// The text gives no machine.
    pub fn machine(&self) -> Result<Machine, String> {
        let scene = self.scene.as_ref();
        let scene = scene.ok_or("the scene is refused: its machine is not known")?;
        Machine::of(scene)
    }

    /// Plays the job of a scene that was read [whole](Self::whole), and keeps up to `rows` rows of it.
    ///
    /// # Errors
    /// The scene is refused, or was read as a draft.
    pub fn job(&self, rows: u32) -> Result<PlayedJob, String> {
        PlayedJob::of(self.good()?, rows)
    }

    /// The job in each of the eight working modes; nothing of a job of more than a million ticks.
    ///
    /// # Errors
    /// As [`job`](Self::job).
    #[wasm_bindgen(js_name = jobModes)]
    pub fn job_modes(&self) -> Result<Vec<JobMode>, String> {
        JobMode::all(self.good()?)
    }

    /// The scene has a plant, and its job can be played.
    #[wasm_bindgen(getter, js_name = hasPlant)]
    pub fn has_plant(&self) -> bool {
        self.good().is_ok_and(|scene| scene.plant.is_some())
    }

    /// Simulates the plant of the scene under the job, and keeps up to `rows` rows of it; nothing of a scene without a plant.
    ///
    /// # Errors
    /// As [`job`](Self::job); the plant is refused.
    pub fn plant(&self, rows: u32) -> Result<Option<SimulatedPlant>, String> {
        SimulatedPlant::of(self.good()?, rows)
    }

    /// The scene, if its job can be played.
    pub(crate) fn good(&self) -> Result<&Scene, String> {
        match (&self.scene, &self.refusal) {
            (Some(scene), None) if !scene.job.moves.is_empty() => Ok(scene),
            (Some(_), None) => Err("the path of the job is not planned in a draft".into()),
            _ => Err("the scene is refused".into()),
        }
    }
}
