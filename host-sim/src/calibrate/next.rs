//! Poses to measure next: a table for the machine, and one to write the measurements into.

use super::{CalibrateArgs, MeasuredKind};
use crate::failure::CliError;
use std::fmt::Write;
use trirrr_calibration::{Calibration, PlannedReading, Proposal, SafeRegion, propose};
use trirrr_core::machine::Geometry;
use trirrr_core::setpoint::Pose;
use trirrr_scene::Scene;

/// Proposed poses in the order in which they are measured.
pub(super) struct NextPoses {
    pub(super) proposal: Proposal,
    /// Points on the way, then the pose: m and rad.
    pub(super) tour: Vec<(Vec<[f64; 2]>, [f64; 3])>,
    start_rad: f64,
    /// Motor angles at the poses, by the scene: as they are commanded.
    angles: Vec<[f64; 3]>,
}

impl NextPoses {
    /// Proposes `count` poses of `safe`.
    ///
    /// # Errors
    /// Refused: a pose without motor angles.
    pub(super) fn find(
        scene: &Scene,
        args: &CalibrateArgs,
        safe: &SafeRegion,
        known: Option<&Calibration>,
        count: u32,
    ) -> Result<Self, CliError> {
        let reading = match args.measure {
            MeasuredKind::Pose => PlannedReading::Pose,
            MeasuredKind::Place => PlannedReading::Place,
        };
        let planned = (reading, args.noise());
        let (machine, setup) = (&scene.parameters, args.setup());
        let count = count as usize;
        let proposal = propose(machine, &setup, known, planned, &safe.poses(), count);
        let tour = safe.tour(&proposal.poses);
        let failed = |reason: String| CliError::Refused(format!("{}: {reason}", scene.name));
        let geometry =
            Geometry::<f64>::build(machine).map_err(|error| failed(error.to_string()))?;
        let angles = tour.iter().map(|(_, pose)| {
            let pose = Pose::from_f64(pose[0], pose[1], pose[2]);
            let position = geometry.position(&pose);
            position.map(|position| geometry.motor_angles(&position))
        });
        let angles = angles.collect::<Result<Vec<_>, _>>();
        Ok(Self {
            proposal,
            angles: angles.map_err(|status| failed(status.to_string()))?,
            tour,
            start_rad: safe.start()[2],
        })
    }

    /// Table of poses, as `trirrr run TABLE.csv --machine SCENE.toml` takes it, with stands of `dwell_s`.
    pub(super) fn table(&self, dwell_s: f64) -> String {
        let mut text = String::from(
            "# Poses to measure: trirrr run poses.csv --machine SCENE.toml. The machine stands at each for a measurement.\nx_mm,y_mm,alpha_deg,dwell_s\n",
        );
        let mut alpha = self.start_rad;
        for (way, pose) in &self.tour {
            let from = alpha;
            for (index, point) in way.iter().enumerate() {
                // The platform turns evenly over the points.
                let part = (index + 1) as f64 / (way.len() + 1) as f64;
                alpha = from + part * (pose[2] - from);
                let _ = writeln!(text, "{}", row([point[0], point[1], alpha]));
            }
            alpha = pose[2];
            let _ = writeln!(text, "{}\n,,,{dwell_s}", row(*pose));
        }
        text
    }

    /// Table of measurements to fill in.
    pub(super) fn form(&self, args: &CalibrateArgs) -> String {
        let (names, empty) = match args.measure {
            MeasuredKind::Pose => ("x_m,y_m,alpha_rad", ",,"),
            MeasuredKind::Place => ("x_m,y_m", ","),
        };
        let mut text = format!(
            "# Fill in what the device measures at each pose. The angles are those that are commanded: put in those that the encoders tell.\nth1_1,th1_2,th1_3,{names},note\n"
        );
        for (number, angles) in (1..).zip(&self.angles) {
            let [a, b, c] = angles;
            let _ = writeln!(text, "{a:.9},{b:.9},{c:.9},{empty},pose {number}");
        }
        text
    }
}

fn row([x, y, alpha]: [f64; 3]) -> String {
    format!("{:.4},{:.4},{:.5},", 1e3 * x, 1e3 * y, alpha.to_degrees())
}
