//! Measure of how far a machine is from doing a job, by which a search finds its way to those that do.

use crate::modes::job_in;
use nalgebra::Vector3;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_scene::{JobPlayer, Scene, pipeline};

/// Poses along moves, and along each piece of a path, at which a machine is looked at, about.
const POSES: u32 = 64;
const PIECE_POSES: u32 = 8;

/// Shortfall of a pose that a leg does not reach: more than that of any singularity.
const UNREACHED: f64 = 3.0;

/// Shortfall of `scene`, a draft that is refused: 0 or more, less for a machine that is nearer to the job. First each pose has to be
/// reached, then the distances to the singularities have to be kept, then the limits.
pub(super) fn shortfall(scene: &Scene) -> f64 {
    let poses = poses(scene);
    let Ok(machine) = pipeline::build_in::<f64>(&scene.parameters, Units::SI) else {
        return 2.0 * UNREACHED;
    };
    let limits = &scene.limits;
    let mut side = None;
    let of_pose = |pose: &Pose<f64>| {
        let missing = missing_reach(&scene.parameters, pose);
        let setpoint = Setpoint {
            pose: *pose,
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        };
        let record = match machine.evaluate(0.0, &setpoint) {
            Ok(record) if missing == 0.0 => record,
            _ => return UNREACHED + missing,
        };
        let own = record.det_a > 0.0;
        let parallel = match own == *side.get_or_insert(own) {
            true => limits.parallel_distance_min - record.parallel,
            false => limits.parallel_distance_min + record.parallel,
        };
        let mut sum = parallel.max(0.0);
        for (motor, leg) in record.legs.iter().enumerate() {
            sum += (limits.serial_distance_min - leg.serial).max(0.0);
            if let Some(most) = limits.torque_nm {
                // Of a standing machine: no duration helps.
                sum += beyond(leg.torque.abs() / most[motor]);
            }
        }
        sum
    };
    let mean = poses.iter().map(of_pose).sum::<f64>() / poses.len().max(1) as f64;
    if mean > 0.0 || scene.job.moves.is_empty() {
        return 1.0 + mean;
    }
    let part = job_in(scene, 1.0).ok().and_then(|found| found.figures);
    part.map_or(1.0, |figures| beyond(figures.limit_part))
}

/// Excess of a part over 1, from 0 to 1.
fn beyond(part: f64) -> f64 {
    let excess = (part - 1.0).max(0.0);
    excess / (1.0 + excess)
}

/// Poses along the job.
fn poses(scene: &Scene) -> Vec<Pose<f64>> {
    let mut poses = vec![scene.job.start];
    if !scene.job.moves.is_empty() {
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let step = player.ticks() / POSES + 1;
        let ticks = (0..player.ticks()).step_by(step as usize);
        poses.extend(ticks.map(|tick| player.at(tick).pose));
        poses.extend(scene.job.moves.iter().map(|each| each.to));
        return poses;
    }
    for each in scene.job.path.iter().flat_map(|path| &path.pieces) {
        let places = (1..=PIECE_POSES).map(|part| f64::from(part) / f64::from(PIECE_POSES));
        poses.extend(places.map(|place| each.piece.at(place).pose));
    }
    poses
}

/// Lengths that the legs miss at a pose, in parts of their reach.
fn missing_reach(parameters: &Parameters, pose: &Pose<f64>) -> f64 {
    let missing = parameters.legs.iter().map(|leg| {
        let (sin, cos) = (pose.angle + leg.joint_angle_rad).sin_cos();
        let joint = nalgebra::Vector2::new(cos, sin) * leg.joint_radius_m;
        let span = pose.position + joint - leg.base_m;
        let (span, reach) = (span.x.hypot(span.y), leg.proximal_m + leg.distal_m);
        let folded = (leg.proximal_m - leg.distal_m).abs();
        (span - reach).max(folded - span).max(0.0) / reach
    });
    missing.sum()
}
