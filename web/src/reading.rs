//! The text of a scene, checked.

use crate::job_file::{self, DrawnPath};
use crate::{JobInputs, JobMode, Machine, PlayedJob};
use trirrr_jobs::JobRefusal;
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
    /// Reads the values of `text` and looks at no pose: quick enough for each key stroke. `file` is named in messages.
    pub fn draft(text: &str, file: &str) -> Self {
        match Scene::draft_set(text, file, &[]) {
            Ok(scene) => Self::of_job(scene, DrawnPath::default()),
            Err(error) => Self::refused(&error, None),
        }
    }

    /// Reads `text` as every command of `trirrr` does: poses, limits, and each move by the admission of the machine's service; a path is
    /// planned.
    pub fn whole(text: &str, file: &str) -> Self {
        let (read, shown) = Scene::parse_shown(text, file, &[]);
        match read {
            Ok(scene) => Self::of_job(scene, DrawnPath::default()),
            Err(error) => Self::refused(&error, shown),
        }
    }

    fn refused(error: &SceneError, scene: Option<Scene>) -> Self {
        let problems: &[trirrr_scene::Problem] = match error {
            SceneError::Refused { problems, .. } => problems,
            SceneError::Unreadable { .. } => &[],
        };
        let problems = problems.iter().map(|problem| {
            let text = problem.to_string();
            // The page shows the line itself.
            let line = format!("{}: ", problem.line);
            Problem {
                line: problem.line as u32,
                column: problem.column as u32,
                sentence: text.strip_prefix(&line).unwrap_or(&text).to_owned(),
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

    /// Reads the job in `text`, G-code or a drawing by the name of its `file`, for the machine of this scene, as
    /// `trirrr run FILE --machine SCENE` does. Problems of the answer stand in the lines of that file.
    ///
    /// # Errors
    /// The scene is refused, or was read as a draft.
    #[wasm_bindgen(js_name = withJob)]
    pub fn with_job(&self, text: &str, file: &str, inputs: &JobInputs) -> Result<Self, String> {
        Ok(job_file::plan(self.good()?, text, file, inputs))
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

    /// What the command line says about a job's file: the place that was found for it, lines that wait for the user.
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
            f64::from(scene.ticks()) * scene.period_s(),
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

    /// The scene, if its job can be played.
    pub(crate) fn good(&self) -> Result<&Scene, String> {
        match (&self.scene, &self.refusal) {
            (Some(scene), None) if !scene.job.moves.is_empty() => Ok(scene),
            (Some(_), None) => Err("the path of the job is not planned in a draft".into()),
            _ => Err("the scene is refused".into()),
        }
    }
}
