//! Error of the platform over its workspace, before and after a calibration.

use crate::closure::close;
use crate::first_poses::NominalMachine;
use crate::measurement::{seen_at, seen_with_slopes};
use crate::parameter::KinematicVector;
use nalgebra::DMatrix;

/// Error of D, and of the angle, over places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PoseError {
    /// Root mean square of the distance, m.
    pub rms_m: f64,
    /// Its largest value, m.
    pub worst_m: f64,
    /// Pose at which that is: x, y in m, alpha in rad.
    pub worst_at: [f64; 3],
    /// Root mean square of the angle, rad.
    pub rms_rad: f64,
    /// Its largest value, rad.
    pub worst_rad: f64,
}

impl PoseError {
    /// Sums up errors, m and rad, at poses.
    pub fn over(errors: impl Iterator<Item = ([f64; 3], [f64; 2])>) -> Self {
        let mut sum = Self::default();
        let mut count = 0.0;
        for (pose, [distance, angle]) in errors {
            count += 1.0;
            sum.rms_m += distance * distance;
            sum.rms_rad += angle * angle;
            if distance > sum.worst_m {
                (sum.worst_m, sum.worst_at) = (distance, pose);
            }
            sum.worst_rad = sum.worst_rad.max(angle.abs());
        }
        if count > 0.0 {
            sum.rms_m = (sum.rms_m / count).sqrt();
            sum.rms_rad = (sum.rms_rad / count).sqrt();
        }
        sum
    }
}

/// Vectors from the commanded place of D to where it gets, by the machine of `values`, when the motors are commanded by the nominal machine: m and rad.
pub(crate) fn uncalibrated(
    nominal: &NominalMachine,
    values: &KinematicVector,
    pose: [f64; 3],
) -> Option<[f64; 3]> {
    let angles = nominal.angles(pose)?;
    let real = close(values, &angles, pose)?.pose;
    let (real, asked) = (seen_at(values, real), seen_at(values, pose));
    Some([0, 1, 2].map(|part| real[part] - asked[part]))
}

/// Standard deviations of the target in the frame of the device, m and rad, at a pose whose motor angles are `angles`.
/// `covariance` is that of the parameters.
pub(crate) fn deviation(
    values: &KinematicVector,
    covariance: &DMatrix<f64>,
    angles: &[f64; 3],
    pose: [f64; 3],
) -> [f64; 2] {
    let slopes = seen_with_slopes(values, angles, pose).slopes;
    let variance = |row: usize| {
        let slope = nalgebra::DVector::from_row_slice(&slopes[row]);
        (covariance * &slope).dot(&slope).max(0.0)
    };
    [(variance(0) + variance(1)).sqrt(), variance(2).sqrt()]
}
