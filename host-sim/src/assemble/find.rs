//! Modes of the machine of a scene.

use super::args::{AssembleArgs, Standing};
use crate::failure::CliError;
use trirrr_core::machine::Elbow;
use trirrr_core::setpoint::Pose;
use trirrr_design::assembly::{AssemblyModes, elbows_of, reach_gaps_m, working_modes};
use trirrr_scene::Scene;
use trirrr_scene::record::Record;

/// Assembly modes, and the working modes at one of their poses.
pub(super) struct Modes {
    pub(super) scene: Scene,
    /// Angles of the motors, rad.
    pub(super) angles_rad: [f64; 3],
    /// The source of the angles, in words.
    pub(super) given: String,
    pub(super) found: AssemblyModes,
    /// For each assembly mode true if elbows and sign of det A are those of the scene.
    pub(super) is_own: Vec<bool>,
    /// Index of the assembly mode whose pose the working modes are for: the pose that was given, or that of the scene's mode, or the first.
    pub(super) chosen: usize,
    /// The eight working modes there.
    pub(super) working: [([Elbow; 3], Record); 8],
}

impl Modes {
    /// Reads the scene and finds all modes.
    pub(super) fn find(args: &AssembleArgs) -> Result<Self, CliError> {
        let scene = args.set.scene(&args.scene)?;
        let parameters = &scene.parameters;
        let name = args.scene.display();
        let refused = |reason: String| CliError::Refused(format!("{name}: {reason}"));
        let own = parameters.legs.map(|leg| leg.elbow);
        // The machine in the mode of the scene at `pose`.
        let standing_at = |pose: Pose<f64>, what: &str| {
            let modes = working_modes(parameters, pose).map_err(|reason| {
                refused(format!(
                    "{what}: {reason}{}",
                    gaps(reach_gaps_m(parameters, pose))
                ))
            })?;
            let own = modes.iter().find(|(elbows, _)| *elbows == own);
            own.map(|(_, record)| *record)
                .ok_or_else(|| refused("no working mode has its elbows".into()))
        };
        let start = standing_at(scene.job.start, "the start of the job")?;
        let angles_of = |record: &Record| record.legs.map(|leg| leg.th1);
        let (angles_rad, pose, given) = match args.standing.standing() {
            Standing::Start => (
                angles_of(&start),
                Some(scene.job.start),
                "those at the start of the job".to_owned(),
            ),
            Standing::Angles(angles) => (angles, None, "as given".to_owned()),
            Standing::Pose([x, y, alpha]) => {
                let pose = Pose::from_f64(x, y, alpha);
                let text = format!(
                    "those at the pose {x} m, {y} m, {:.4} deg in the working mode of the scene",
                    alpha.to_degrees()
                );
                (angles_of(&standing_at(pose, "the pose")?), Some(pose), text)
            }
        };
        let in_words = angles_rad
            .map(|angle| format!("{:.4}", angle.to_degrees()))
            .join(", ");
        let found = AssemblyModes::of(parameters, angles_rad)
            .map_err(|fault| refused(format!("at the motor angles {in_words} deg: {fault}")))?;
        let side = start.det_a > 0.0;
        let is_own: Vec<bool> = found
            .modes
            .iter()
            .map(|mode| {
                elbows_of(&mode.record) == own.map(Some) && (mode.record.det_a > 0.0) == side
            })
            .collect();
        let asked = pose.and_then(|pose| found.nearest(parameters, pose));
        let chosen = asked.or(is_own.iter().position(|own| *own)).unwrap_or(0);
        let Some(mode) = found.modes.get(chosen) else {
            return Err(refused(format!(
                "no assembly: at the motor angles {in_words} deg the distal links hold the platform nowhere; choose other angles, or a pose by --at-deg"
            )));
        };
        let [x, y, angle] = mode.record.pose;
        let working = working_modes(parameters, Pose::from_f64(x, y, angle)).map_err(refused)?;
        Ok(Self {
            angles_rad,
            given,
            found,
            is_own,
            chosen,
            working,
            scene,
        })
    }
}

/// Legs that do not reach, and by how much they miss.
fn gaps(gaps_m: [f64; 3]) -> String {
    let missing = gaps_m.iter().enumerate().filter(|(_, gap)| **gap != 0.0);
    let each = missing.map(|(leg, gap)| {
        let side = if *gap > 0.0 {
            "short of"
        } else {
            "too long for"
        };
        format!(
            "; leg {} is {:.6} m {side} its platform joint",
            leg + 1,
            gap.abs()
        )
    });
    each.collect()
}
