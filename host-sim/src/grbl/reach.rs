//! Look at a motion before the machine gets it.

use nalgebra::Vector3;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_grbl::MotionCheck;
use trirrr_jobs::{piece_from, pose_of};
use trirrr_scene::Scene;
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_toolpath::{ToolMotion, ToolPlace};

/// Longest way between two places that are looked at, m; and the most of them on a motion.
const STEP_M: f64 = 1e-3;
const MOST: f64 = 4000.0;

/// Fewest places that are looked at: alpha may turn while D stands.
const LEAST: f64 = 16.0;

/// Kinematics of the scene's machine. Between the places that are looked at nothing is proven: the machine does that.
pub(super) struct SceneReach<'a> {
    machine: Box<dyn Pipeline<f64>>,
    scene: &'a Scene,
    /// Side of the parallel singularity on which the machine stands.
    det_a: f64,
}

impl<'a> SceneReach<'a> {
    /// Builds the kinematics of `scene`.
    ///
    /// # Errors
    /// A machine that the scene's reader would have refused.
    pub(super) fn new(scene: &'a Scene) -> Result<Self, String> {
        let refused = |why: String| format!("scene {}: {why}", scene.name);
        let machine = pipeline::of_scene::<f64>(scene, Units::SI)
            .map_err(|error| refused(error.to_string()))?;
        let start = machine.evaluate(0.0, &at_rest(&scene.job.start));
        let det_a = start.map_err(|status| refused(status.to_string()))?.det_a;
        Ok(Self {
            machine,
            scene,
            det_a,
        })
    }

    fn look(&self, pose: &Pose<f64>) -> Result<(), String> {
        let [x, y] = [pose.position.x, pose.position.y].map(|length| length * 1000.0);
        let at = format!("at X{x:.3} Y{y:.3} A{:.3}", pose.angle.to_degrees());
        let record = self
            .machine
            .evaluate(0.0, &at_rest(pose))
            .map_err(|status| format!("{at}, in the frame of the machine: {status}"))?;
        let serial = record.legs.iter().map(|leg| leg.serial).fold(1.0, f64::min);
        let limits = &self.scene.limits;
        let near = |what: &str, distance: f64, least: f64| {
            format!(
                "{at}, in the frame of the machine: the distance to the {what} singularity is {distance:.4}, the least allowed is {least}"
            )
        };
        if serial < limits.serial_distance_min {
            return Err(near("serial", serial, limits.serial_distance_min));
        }
        let is_through = (record.det_a > 0.0) != (self.det_a > 0.0);
        if is_through || record.parallel < limits.parallel_distance_min {
            return Err(near(
                "parallel",
                record.parallel,
                limits.parallel_distance_min,
            ));
        }
        Ok(())
    }
}

impl MotionCheck for SceneReach<'_> {
    fn check(&self, from: ToolPlace, motion: &ToolMotion) -> Result<(), String> {
        let piece = piece_from(pose_of(&from), motion);
        let way = piece.length_m();
        if !way.is_finite() {
            return Err("the motion has no finite length".into());
        }
        let steps = (way / STEP_M).ceil().clamp(LEAST, MOST);
        (1..=steps as u32).try_for_each(|step| {
            let point = piece.at(f64::from(step) / steps);
            self.look(&point.pose)
        })
    }
}

fn at_rest(pose: &Pose<f64>) -> Setpoint<f64> {
    Setpoint {
        pose: *pose,
        velocity: Vector3::zeros(),
        acceleration: Vector3::zeros(),
    }
}
