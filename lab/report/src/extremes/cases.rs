//! The extreme cases: those of the reference file, and more of them than a file would hold.

use crate::error::ReportError;
use crate::scenes::shipped;
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{Elbow, Parameters};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_scene::{JobMove, Scene, cases};

const FILE: &str = include_str!("../../../../tests/reference/extreme.csv");

/// A machine at an instant.
pub(crate) struct ExtremeCase {
    /// Group of the case, by what is extreme: cases of one group stand in one row of the summary.
    pub(crate) group: &'static str,
    /// Its own name.
    pub(crate) name: String,
    /// The machine.
    pub(crate) parameters: Parameters,
    /// State of the machine, or its place on a move.
    pub(crate) motion: CaseMotion,
}

/// A state, or a place on a move.
pub(crate) enum CaseMotion {
    /// A state.
    State(Setpoint<f64>),
    /// One tick of the move that is the scene's job.
    Move {
        /// The scene.
        scene: Box<Scene>,
        /// Number of the tick.
        tick: u32,
    },
}

/// Parallel singularity of the thesis machine at (0.245, 0.25): alpha where det A = 0.
const PARALLEL: [f64; 2] = [-0.753_418_931_929_448_5, 2.401_557_361_435_242];

/// Powers of one half down to the last step of an f64 near 1.
const HALVINGS: [i32; 11] = [2, 5, 10, 15, 20, 24, 30, 36, 42, 47, 52];

/// All cases, group by group.
pub(crate) fn all() -> Result<Vec<ExtremeCase>, ReportError> {
    let scenes = shipped()?;
    let [thesis, links, ..] = scenes.as_slice() else {
        return Err(ReportError::Failed(
            "the report's scenes are missing".into(),
        ));
    };
    let the_move = thesis.job.moves[0];
    let mut cases = reference()?;
    let mut add = |group, name: String, parameters: &Parameters, motion| {
        let mut case = ExtremeCase {
            group,
            name,
            parameters: *parameters,
            motion,
        };
        if let CaseMotion::Move { scene, .. } = &mut case.motion {
            scene.parameters = *parameters;
        }
        cases.push(case);
    };

    // A quarter of the way in: velocity and acceleration both count. Without limits, which would
    // ask for a range of their own.
    let on = |each: JobMove, rate_hz: f64| {
        let mut scene = links.clone();
        scene.limits.rate_rad_s = None;
        scene.limits.acceleration_rad_s2 = None;
        scene.limits.torque_nm = None;
        scene.limits.power_w = None;
        scene.tick_rate_hz = rate_hz;
        scene.job.start = each.from;
        scene.job.moves = vec![JobMove {
            duration_ticks: 100,
            ..each
        }];
        CaseMotion::Move {
            scene: Box::new(scene),
            tick: 25,
        }
    };
    for exponent in -3..=4 {
        let rate_hz = 100.0 / 10f64.powi(exponent);
        let name = format!("the thesis's move in 1e{exponent} s");
        add("durations", name, &links.parameters, on(the_move, rate_hz));
    }
    for way in [1e-1, 1e-3, 1e-6, 1e-9, 0.0] {
        let mut each = the_move;
        let start = each.from;
        each.to = Pose::from_f64(start.position.x + way, start.position.y, start.angle + way);
        let name = format!("a move of {way:e} m and rad in 1 s");
        add("short moves", name, &links.parameters, on(each, 100.0));
    }
    for turns in [1.0, -10.0, 1e3, 1e6] {
        let mut each = the_move;
        for pose in [&mut each.from, &mut each.to] {
            pose.angle += turns * core::f64::consts::TAU;
        }
        let name = format!("the thesis's move {turns:e} turns on");
        add("many turns", name, &links.parameters, on(each, 100.0));
    }
    for exponent in -3..=3 {
        // 0.5 m between the bases of the thesis's machine.
        let scale = 10f64.powi(exponent) / 0.5;
        let mut each = the_move;
        for pose in [&mut each.from, &mut each.to] {
            pose.position *= scale;
        }
        let name = format!("a machine of 1e{exponent} m");
        let parameters = scaled(&links.parameters, scale);
        add("sizes", name, &parameters, on(each, 100.0));
    }
    for mode in 0..8u32 {
        let mut parameters = links.parameters;
        for (leg, bit) in parameters.legs.iter_mut().zip([4, 2, 1]) {
            leg.elbow = match mode & bit {
                0 => Elbow::Positive,
                _ => Elbow::Negative,
            };
        }
        let name = format!("the thesis's move in mode {mode:03b}");
        add("working modes", name, &parameters, on(the_move, 100.0));
    }
    for halvings in HALVINGS {
        let left = 0.5f64.powi(halvings);
        let name = format!("leg 1 stretched but for 2^-{halvings}");
        let state = at_leg_1(&links.parameters, 0.4 * (1.0 - left));
        add("serial singularity", name, &links.parameters, state);
        let name = format!("leg 1 folded but for 2^-{halvings}");
        let parameters = with_leg_1_at(&links.parameters, 0.4 * left);
        add("serial singularity", name, &parameters, folded_pose());
        for root in PARALLEL {
            let name = format!("alpha {root:.3} + 2^-{halvings}");
            let state = at_rest(0.245, 0.25, root + left);
            add("parallel singularity", name, &thesis.parameters, state);
        }
    }
    Ok(cases)
}

/// The thesis's machine with link masses.
pub(super) fn thesis_links() -> Result<Parameters, ReportError> {
    match shipped()?.get(1) {
        Some(scene) => Ok(scene.parameters),
        None => Err(ReportError::Failed(
            "the report's scenes are missing".into(),
        )),
    }
}

/// The cases of the reference file.
fn reference() -> Result<Vec<ExtremeCase>, ReportError> {
    let group = |name: &str| match name {
        _ if name.starts_with("stretch") || name.starts_with("fold") => "serial singularity",
        _ if name.starts_with("type2") => "parallel singularity",
        _ if name.starts_with("mode") => "working modes",
        _ if name.starts_with("alpha") => "many turns",
        _ if name.starts_with("scale") => "sizes",
        _ => "machines and masses",
    };
    let rows = cases::read_all(FILE)
        .map_err(|reason| ReportError::Refused(format!("extreme.csv: {reason}")))?;
    Ok(rows
        .into_iter()
        .map(|(name, case)| ExtremeCase {
            group: group(&name),
            name,
            parameters: case.parameters,
            motion: CaseMotion::State(case.setpoint),
        })
        .collect())
}

/// The machine built of the same stuff, `scale` times as large.
fn scaled(parameters: &Parameters, scale: f64) -> Parameters {
    let mut scaled = *parameters;
    let (mass, inertia) = (scale.powi(3), scale.powi(5));
    for leg in &mut scaled.legs {
        leg.base_m *= scale;
        leg.proximal_m *= scale;
        leg.distal_m *= scale;
        leg.joint_radius_m *= scale;
        for link in [&mut leg.proximal, &mut leg.distal] {
            link.mass_kg *= mass;
            link.com_m *= scale;
            link.inertia_kgm2 *= inertia;
        }
    }
    scaled.platform.mass_kg *= mass;
    scaled.platform.inertia_kgm2 *= inertia;
    scaled
}

/// At rest, about to move.
fn at_rest(x: f64, y: f64, alpha: f64) -> CaseMotion {
    CaseMotion::State(Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::zeros(),
        acceleration: Vector3::new(0.3, -0.2, 0.5),
    })
}

pub(super) fn polar(length: f64, angle: f64) -> Vector2<f64> {
    Vector2::new(angle.cos(), angle.sin()) * length
}

/// At rest with platform joint 1 at `length` from base joint 1, towards the middle.
fn at_leg_1(parameters: &Parameters, length: f64) -> CaseMotion {
    let (leg, alpha) = (&parameters.legs[0], 0.1f64);
    let joint = leg.base_m + polar(length, -0.5);
    let centre = joint - polar(leg.joint_radius_m, alpha + leg.joint_angle_rad);
    at_rest(centre.x, centre.y, alpha)
}

fn folded_pose() -> CaseMotion {
    at_rest(0.245, 0.25, 0.1)
}

/// The machine with base joint 1 at `length` from where platform joint 1 is in [`folded_pose`]: at
/// its own place a folded leg would take the others out of reach.
fn with_leg_1_at(parameters: &Parameters, length: f64) -> Parameters {
    let mut moved = *parameters;
    let leg = &mut moved.legs[0];
    let joint = Vector2::new(0.245, 0.25) + polar(leg.joint_radius_m, 0.1 + leg.joint_angle_rad);
    leg.base_m = joint - polar(length, -0.5);
    moved
}
