//! All poses of the platform for given motor angles, and all motor angles for a given pose.

use crate::modes::MODES;
use nalgebra::{Vector2, Vector3};
use trirrr_core::forward::{AssemblyError, Completeness, Forward};
use trirrr_core::machine::{BuildError, Elbow, Geometry, Parameters};
use trirrr_core::number::cross;
use trirrr_core::setpoint::Pose;
use trirrr_scene::record::{LegRecord, Record};

/// Sine of the angle between two links below which a leg counts as stretched or folded: it has no elbow sign.
const STRAIGHT: f64 = 1e-9;

/// Platform in one assembly mode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AssemblyMode {
    /// The machine at rest there: pose, links, det A and distances. Rates and torques are zero.
    pub record: Record,
    /// Largest error of the length of a distal link, m.
    pub residual_m: f64,
    /// Two modes meet here: a parallel singularity.
    pub double: bool,
}

/// All assembly modes of a machine at one set of motor angles.
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblyModes {
    /// The modes, sorted by the angle of the platform.
    pub modes: Vec<AssemblyMode>,
    /// Completeness of the list.
    pub completeness: Completeness,
}

/// Reason why there is no list of modes.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum AssemblyFault {
    /// The machine is refused.
    #[error("{0}")]
    Machine(BuildError),
    /// There is no finite list.
    #[error("{0}")]
    Modes(AssemblyError),
}

impl AssemblyModes {
    /// Finds all modes of the machine whose motors stand at `angles_rad`.
    ///
    /// # Errors
    /// [`AssemblyFault`]. Angles that fit no pose are no error: the list is empty.
    pub fn of(parameters: &Parameters, angles_rad: [f64; 3]) -> Result<Self, AssemblyFault> {
        let geometry = Geometry::<f64>::build(parameters).map_err(AssemblyFault::Machine)?;
        let found = Forward::build(parameters, &geometry).assemblies(&angles_rad);
        let found = found.map_err(AssemblyFault::Modes)?;
        let modes = found.modes().iter().map(|mode| {
            let record = record_at(parameters, mode.pose, angles_rad);
            let legs = record.legs.iter().zip(&parameters.legs);
            let errors =
                legs.map(|(leg, given)| (leg.r2[0].hypot(leg.r2[1]) - given.distal_m).abs());
            AssemblyMode {
                record,
                residual_m: errors.fold(0.0, f64::max),
                double: mode.double,
            }
        });
        Ok(Self {
            modes: modes.collect(),
            completeness: found.completeness,
        })
    }

    /// Index of the mode whose platform joints are nearest to those at `pose`; none of an empty list.
    pub fn nearest(&self, parameters: &Parameters, pose: Pose<f64>) -> Option<usize> {
        let joints = |pose: Pose<f64>| parameters.legs.map(|leg| platform_joint(&leg, pose));
        let asked = joints(pose);
        let off = |mode: &AssemblyMode| {
            let [x, y, angle] = mode.record.pose;
            let here = joints(Pose::from_f64(x, y, angle));
            let each = here
                .iter()
                .zip(&asked)
                .map(|(one, other)| length(one - other));
            each.fold(0.0, f64::max)
        };
        let modes = self.modes.iter().enumerate();
        let nearest = modes.min_by(|(_, one), (_, other)| off(one).total_cmp(&off(other)));
        nearest.map(|(index, _)| index)
    }
}

/// Elbow signs that a machine has; none for a leg that is stretched or folded.
pub fn elbows_of(record: &Record) -> [Option<Elbow>; 3] {
    record.legs.map(|leg| match leg.cross {
        _ if leg.serial < STRAIGHT => None,
        cross if cross < 0.0 => Some(Elbow::Positive),
        _ => Some(Elbow::Negative),
    })
}

/// Length by which each leg misses the platform at `pose`, m: positive if the platform is too far from the base joint, negative
/// if it is too near, 0 if the leg reaches.
pub fn reach_gaps_m(parameters: &Parameters, pose: Pose<f64>) -> [f64; 3] {
    parameters.legs.map(|leg| {
        let distance = length(platform_joint(&leg, pose) - leg.base_m);
        let (shortest, longest) = (
            (leg.proximal_m - leg.distal_m).abs(),
            leg.proximal_m + leg.distal_m,
        );
        distance - distance.clamp(shortest, longest)
    })
}

/// The machine at rest at `pose` in each of the eight working modes, in the order of [`MODES`].
///
/// A leg that is stretched or folded has one position for both signs of its elbow.
///
/// # Errors
/// The machine is refused, in words, or a leg does not reach: [`reach_gaps_m`] says by how much.
pub fn working_modes(
    parameters: &Parameters,
    pose: Pose<f64>,
) -> Result<[([Elbow; 3], Record); 8], String> {
    let mut modes = [(MODES[0], Record::default()); 8];
    for (mode, elbows) in modes.iter_mut().zip(MODES) {
        let mut changed = *parameters;
        for (leg, elbow) in changed.legs.iter_mut().zip(elbows) {
            leg.elbow = elbow;
        }
        let geometry = Geometry::<f64>::build(&changed).map_err(|error| error.to_string())?;
        let position = geometry
            .position(&pose)
            .map_err(|status| status.to_string())?;
        let angles = geometry.motor_angles(&position);
        *mode = (elbows, record_at(parameters, pose, angles));
    }
    Ok(modes)
}

fn length(way: Vector2<f64>) -> f64 {
    way.x.hypot(way.y)
}

fn platform_joint(leg: &trirrr_core::machine::LegParameters, pose: Pose<f64>) -> Vector2<f64> {
    let (sin, cos) = (pose.angle + leg.joint_angle_rad).sin_cos();
    pose.position + Vector2::new(cos, sin) * leg.joint_radius_m
}

/// The machine at rest with its motors at `angles_rad` and its platform at `pose`; distal links are what lies between.
fn record_at(parameters: &Parameters, pose: Pose<f64>, angles_rad: [f64; 3]) -> Record {
    let mut rows = [Vector3::zeros(); 3];
    let mut legs = [LegRecord::default(); 3];
    for (index, (leg, th1)) in parameters.legs.iter().zip(angles_rad).enumerate() {
        let r1 = Vector2::new(th1.cos(), th1.sin()) * leg.proximal_m;
        let joint = platform_joint(leg, pose);
        let r2 = joint - leg.base_m - r1;
        let arm = joint - pose.position;
        rows[index] = Vector3::new(r2.x, r2.y, cross(arm, r2));
        let r1_cross_r2 = cross(r1, r2);
        legs[index] = LegRecord {
            th1,
            th2: r2.y.atan2(r2.x),
            cross: r1_cross_r2,
            serial: r1_cross_r2.abs() / (leg.proximal_m * leg.distal_m),
            base: leg.base_m.into(),
            r1: r1.into(),
            r2: r2.into(),
            ..LegRecord::default()
        };
    }
    let det_a = rows[0].dot(&rows[1].cross(&rows[2]));
    let greatest = parameters.greatest_det_a();
    Record {
        pose: [pose.position.x, pose.position.y, pose.angle],
        legs,
        det_a,
        parallel: if greatest > 0.0 {
            det_a.abs() / greatest
        } else {
            0.0
        },
        ..Record::default()
    }
}
