//! One run of a case by one method, and what it cost.

use crate::error::ReportError;
use cpu_time::ThreadTime;
use std::sync::atomic::AtomicBool;
use std::time::Duration;
use trirrr_drives::stepper::Line;
use trirrr_plant::table::Row;
use trirrr_plant::{PlantEnd, PlantRun, job};
use trirrr_scene::{Method, Scene};

/// Solutions are compared every so often, s. No method takes longer steps.
pub const COMPARED_S: f64 = 0.02;
/// A run whose error stays below this, in m and rad, has followed the motion.
pub(super) const FOLLOWED: f64 = 1e-4;

/// A run.
#[derive(Clone, Debug)]
pub struct Trial {
    /// Time and pose (x and y in m, alpha in rad), up to the end.
    pub poses: Vec<(f64, [f64; 3])>,
    /// Reason why it ended, where not at its end.
    pub ended: Option<String>,
    /// Warnings about the method from before it began.
    pub warnings: Vec<String>,
    /// Derivatives evaluated, those of Jacobians among them.
    pub cost: u64,
    /// Processor time of the thread: threads beside it do not count.
    pub elapsed: Duration,
    /// Times faster than real time, on an idle machine.
    pub ratio: f64,
    /// Name of the method.
    pub method: &'static str,
}

impl Trial {
    /// Runs `scene` by `method`, with poses every [`COMPARED_S`].
    ///
    /// # Errors
    /// Why the scene is refused.
    pub fn run(scene: &Scene, method: Method) -> Result<Self, ReportError> {
        let mut scene = scene.clone();
        if let Some(plant) = &mut scene.plant {
            plant.method = method;
            plant.record_s = COMPARED_S;
        }
        Self::of(&scene)
    }

    /// Runs `scene` as it is.
    ///
    /// # Errors
    /// Why it is refused.
    pub fn of(scene: &Scene) -> Result<Self, ReportError> {
        let refused = |error: &dyn std::fmt::Display| ReportError::Refused(error.to_string());
        let line = Line::new();
        let mut run = PlantRun::<f64>::build(scene, &line).map_err(|error| refused(&error))?;
        let mut poses = Vec::new();
        let never = AtomicBool::new(false);
        let started = ThreadTime::now();
        let mut sink = |row: &Row| poses.push((row.t, row.pose));
        for output in job::outputs(scene).map_err(|error| refused(&error))? {
            run.tick(&output, &mut sink);
        }
        let outcome = run.finish(&never, &mut sink);
        let elapsed = started.elapsed();
        let ratio = outcome.ratio();
        let ended = match outcome.end {
            PlantEnd::Complete => None,
            PlantEnd::Ended(ending) => Some(ending.to_string()),
            PlantEnd::EnergyLost(loss) => Some(loss.to_string()),
            PlantEnd::Failed(cause) => Some(cause),
            PlantEnd::Interrupted { t } => Some(format!("interrupted at t = {t} s")),
        };
        Ok(Self {
            poses,
            ended,
            warnings: outcome.warnings,
            cost: outcome.tally.cost(outcome.dimension),
            elapsed,
            ratio,
            method: outcome.method.name(),
        })
    }

    /// Largest difference of poses from those of `truth`, in m and rad, over all of its instants;
    /// infinite where this run has none for one of them.
    pub fn error(&self, truth: &Self) -> f64 {
        let mut own = self.poses.iter();
        let mut largest: f64 = 0.0;
        for (t, known) in &truth.poses {
            // Rows at the same instant, by sums that are rounded differently.
            let Some((_, pose)) = own.find(|(own_t, _)| (own_t - t).abs() < 1e-9) else {
                return f64::INFINITY;
            };
            for (value, known) in pose.iter().zip(known) {
                largest = largest.max((value - known).abs());
            }
        }
        largest
    }
}
