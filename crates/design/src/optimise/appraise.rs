//! Candidates of a study: the scene with other values, and what it is worth.

use super::shortfall::shortfall;
use super::{DesignPoint, DesignSpace, Objective};
use crate::modes::{ModeFigures, job_in};
use crate::workspace::{CellGrid, Conditions, Workspace};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};
use trirrr_core::setpoint::Setpoint;
use trirrr_core::units::Units;
use trirrr_scene::read::Setting;
use trirrr_scene::{Scene, SceneError, pipeline};

/// Shortfall of a candidate with a value that the reader refuses.
const NO_DRAFT: f64 = 100.0;

/// Parts of its duration in which a job of moves is tried, and halvings between them.
const FASTEST: f64 = 0.02;
const HALVINGS: u32 = 24;

/// Maps of a study's candidates.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct MapSettings {
    /// Angle of the platform, rad; none: that of the job's start.
    pub alpha_rad: Option<f64>,
    /// Angle by which the platform can turn to both sides, rad.
    pub turn_rad: f64,
    /// Cells along the longer side.
    pub cells: usize,
}

/// Scene of a study, and what is looked at.
#[derive(Clone, Debug)]
pub struct StudyScene {
    /// The scene in TOML.
    pub text: String,
    /// Its name, to find the file of its machine.
    pub file: String,
    /// Values in place of its own.
    pub settings: Vec<Setting>,
    /// Values that are varied.
    pub space: DesignSpace,
    /// Quantities that are looked at, one or two.
    pub objectives: Vec<Objective>,
    /// Maps.
    pub maps: MapSettings,
}

/// Candidate that does not do the job.
#[derive(Clone, Debug, PartialEq)]
pub struct CandidateFault {
    /// Reason of the reader.
    pub reason: String,
    /// Measure of how far the candidate is from doing the job, 0 or more.
    pub shortfall: f64,
}

/// Candidate that was looked at.
#[derive(Clone, Debug, PartialEq)]
pub struct Appraisal {
    /// The candidate.
    pub point: DesignPoint,
    /// A value for each objective, or why there is none.
    pub found: Result<Vec<f64>, CandidateFault>,
}

impl StudyScene {
    /// Reads the scene with `settings` behind its own.
    fn read(
        &self,
        settings: Vec<Setting>,
        with: fn(&str, &str, &[Setting]) -> Result<Scene, SceneError>,
    ) -> Result<Scene, SceneError> {
        let all: Vec<Setting> = self.settings.iter().cloned().chain(settings).collect();
        with(&self.text, &self.file, &all)
    }

    /// The scene without other values, as far as its values go.
    ///
    /// # Errors
    /// The scene is refused.
    pub fn draft(&self) -> Result<Scene, SceneError> {
        self.read(Vec::new(), Scene::draft_set)
    }

    /// Checks that the reader takes the bounds of each range, and a value between them; and that moves have a least time.
    ///
    /// # Errors
    /// The range, the key and the reason.
    pub fn check(&self) -> Result<(), String> {
        let draft = self.draft().map_err(|error| error.to_string())?;
        if self.objectives.contains(&Objective::Time) && !has_least_time(&draft) {
            return Err(NO_LEAST_TIME.into());
        }
        for range in &self.space.ranges {
            let refused = |reason: String| format!("--vary {range}: {reason}");
            // A value with a fraction, so that a key that takes whole numbers is found.
            let between = range.at(0.381_966);
            let drafts = [range.low, range.high, between].map(|value| {
                self.read(range.settings(value), Scene::draft_set)
                    .map_err(|error| refused(first_reason(&error)))
            });
            let [low, high, between] = drafts;
            let (mut low, high, _) = (low?, high?, between?);
            low.key = high.key;
            if low == high {
                return Err(refused("changes nothing".into()));
            }
        }
        Ok(())
    }

    /// Looks at the scene without other values.
    pub fn own(&self) -> Result<Vec<f64>, CandidateFault> {
        self.look_at(Vec::new())
    }

    /// Looks at a candidate.
    pub fn appraise(&self, point: DesignPoint) -> Appraisal {
        let found = self.look_at(self.space.settings(&point));
        Appraisal { point, found }
    }

    fn look_at(&self, settings: Vec<Setting>) -> Result<Vec<f64>, CandidateFault> {
        let fault = |reason: String, shortfall| CandidateFault { reason, shortfall };
        match self.read(settings.clone(), Scene::parse_set) {
            Ok(scene) => self
                .values(&scene)
                .map_err(|reason| fault(reason, shortfall(&scene))),
            Err(refusal) => {
                let draft = self.read(settings, Scene::draft_set);
                let missing = draft.map_or(NO_DRAFT, |draft| shortfall(&draft));
                Err(fault(first_reason(&refusal), missing))
            }
        }
    }

    fn values(&self, scene: &Scene) -> Result<Vec<f64>, String> {
        let asks = |grows: bool| self.objectives.iter().any(|each| each.grows() == grows);
        let map = match asks(true) {
            true => Some(self.map(scene)?),
            false => None,
        };
        let figures = match asks(false) {
            true => Some(job_figures(scene, 1.0)?),
            false => None,
        };
        let largest = |values: [f64; 3]| values.into_iter().fold(0.0, f64::max);
        let value = |objective: &Objective| {
            let value = match objective {
                Objective::Workspace => map.map(|map| map[0]),
                Objective::Disc => map.map(|map| map[1]),
                Objective::Rectangle => map.map(|map| map[2]),
                Objective::Torque => figures.map(|figures| largest(figures.torque_peak_nm)),
                Objective::Rms => figures.map(|figures| largest(figures.torque_rms_nm)),
                Objective::Time => Some(shortest_s(scene)?),
            };
            value.ok_or_else(|| format!("no {objective}"))
        };
        self.objectives.iter().map(value).collect()
    }

    /// Connected area, radius of the largest circle, area of the largest rectangle.
    fn map(&self, scene: &Scene) -> Result<[f64; 3], String> {
        let start = scene.job.start;
        let machine = pipeline::build_in::<f64>(&scene.parameters, Units::SI)
            .map_err(|error| error.to_string())?;
        let at_rest = Setpoint {
            pose: start,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        let record = machine
            .evaluate(0.0, &at_rest)
            .map_err(|status| status.to_string())?;
        let alpha = self.maps.alpha_rad.unwrap_or(start.angle);
        let conditions = Conditions {
            serial_min: scene.limits.serial_distance_min,
            parallel_min: scene.limits.parallel_distance_min,
            side: Some(record.det_a > 0.0),
            alpha_rad: [alpha - self.maps.turn_rad, alpha + self.maps.turn_rad],
        };
        let grid = CellGrid::around(&scene.parameters, self.maps.cells);
        let map = Workspace::map(&scene.parameters, &conditions, grid);
        let Some(kept) = map.connected(start.position.into()) else {
            return Ok([0.0; 3]);
        };
        let cell = grid.cell_m * grid.cell_m;
        let area = cell * kept.iter().filter(|is_kept| **is_kept).count() as f64;
        let disc = grid.largest_disc(&kept).map_or(0.0, |disc| disc.radius_m);
        let rectangle = grid.largest_rectangle(&kept);
        let rectangle = rectangle.map_or(0.0, |each| each.size_m[0] * each.size_m[1]);
        Ok([area, disc, rectangle])
    }
}

/// First problem of a refusal, without the name of the file.
fn first_reason(error: &SceneError) -> String {
    match error {
        SceneError::Refused { problems, .. } => match problems.first() {
            Some(problem) => problem.to_string().trim_start().to_owned(),
            None => error.to_string(),
        },
        SceneError::Unreadable { .. } => error.to_string(),
    }
}

fn job_figures(scene: &Scene, factor: f64) -> Result<ModeFigures, String> {
    let found = job_in(scene, factor)?;
    match (found.fault, found.figures) {
        (None, Some(figures)) => Ok(figures),
        (Some(fault), _) => Err(fault.reason),
        (None, None) => Err("the job has no setpoint".into()),
    }
}

/// Refusal of a time that nothing bounds.
const NO_LEAST_TIME: &str = "--for time: moves have no least time without [limits] of the motors, such as rate_rad_s and torque_nm";

/// Returns true if a limit of the motors bounds the duration of the job.
fn has_least_time(scene: &Scene) -> bool {
    let limits = &scene.limits;
    let of_motors = [
        limits.rate_rad_s,
        limits.acceleration_rad_s2,
        limits.torque_nm,
        limits.power_w,
    ];
    scene.job.path.is_some() || of_motors.iter().any(Option::is_some)
}

/// Shortest duration of the job, s: that of its plan; that of given moves, all of them faster by the same factor, until a motor is at
/// a limit.
fn shortest_s(scene: &Scene) -> Result<f64, String> {
    let own_s = scene.duration_s();
    if scene.job.path.is_some() {
        return Ok(own_s);
    }
    if !has_least_time(scene) {
        return Err(NO_LEAST_TIME.into());
    }
    let is_kept = |factor| job_figures(scene, factor).map(|figures| figures.limit_part <= 1.0);
    if is_kept(FASTEST)? {
        return Ok(FASTEST * own_s);
    }
    let (mut low, mut high) = (FASTEST, 1.0);
    for _ in 0..HALVINGS {
        let middle = 0.5 * (low + high);
        match is_kept(middle)? {
            true => high = middle,
            false => low = middle,
        }
    }
    Ok(high * own_s)
}
