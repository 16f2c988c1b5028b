//! Poses that are worth measuring next: D-optimal among candidates.
//!
//! The information of a set of poses is I + sum J^T J, with Jacobians in expected deviations of parameters and standard deviations of
//! the device. The set with the greatest determinant leaves the smallest volume of parameters that fit. Poses are added greedily, each
//! with the greatest log det(1 + J M^-1 J^T), and then exchanged while that helps.

use crate::calibrate::angles_told;
use crate::closure::LoopClosure;
use crate::directions::scaled_slopes;
use crate::forecast::{PoseError, deviation};
use crate::measurement::{DeviceReading, MOST_VALUES, MeasuredRow, MeasurementNoise};
use crate::parameter::{KinematicVector, PARAMETER_COUNT};
use crate::result::Calibration;
use crate::setup::CalibrationSetup;
use nalgebra::DMatrix;
use trirrr_core::machine::Parameters;

/// Rounds of exchanges.
const ROUNDS: u32 = 3;

/// Gain of log det for which a pose is exchanged.
const LEAST_GAIN: f64 = 1e-6;

/// Measurement that is to be made at the poses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlannedReading {
    /// Place and angle of the target.
    Pose,
    /// Place of the target alone.
    Place,
    /// Distance of the target from a fixed point, m.
    Distance([f64; 2]),
}

/// Poses to measure, in no order.
#[derive(Clone, Debug, PartialEq)]
pub struct Proposal {
    /// x, y in m, alpha in rad.
    pub poses: Vec<[f64; 3]>,
    /// log det of the information with these poses, above that without.
    pub gain: f64,
    /// Standard deviation over the candidates without the poses,
    pub before: PoseError,
    /// and once they are measured.
    pub after: PoseError,
}

struct PoseCandidate {
    pose: [f64; 3],
    /// Values by free parameters, scaled.
    slopes: DMatrix<f64>,
}

/// Proposes `count` poses of `candidates` for a machine: beside the measurements of `known`, if there are any.
pub fn propose(
    machine: &Parameters,
    setup: &CalibrationSetup,
    known: Option<&Calibration>,
    (reading, noise): (PlannedReading, MeasurementNoise),
    candidates: &[[f64; 3]],
    count: usize,
) -> Proposal {
    let nominal = KinematicVector::of(machine, setup.device, setup.target);
    let values = known.map_or(nominal, |known| known.values);
    let (free, expected) = (setup.free_indices(), setup.expected());
    let row_at = |pose: [f64; 3]| {
        let row = MeasuredRow {
            line: 0,
            angles_rad: angles_told(machine, &values, pose)?,
            reading: reading.at([0.0; 2]),
            noise,
        };
        Some((row, LoopClosure { pose, side: true }))
    };
    let each = candidates.iter().filter_map(|pose| {
        let (row, at) = row_at(*pose)?;
        Some(PoseCandidate {
            pose: *pose,
            slopes: scaled_slopes(setup, &[row], &values, &[at]),
        })
    });
    let each: Vec<PoseCandidate> = each.collect();
    let mut information = DMatrix::identity(free.len(), free.len());
    if let Some(known) = known {
        information += &known.information;
    }
    let begin = information.clone();
    let chosen = choose(&each, &mut information, count);
    let error = |information: &DMatrix<f64>| {
        let inverse = inverse_of(information);
        let mut covariance = DMatrix::zeros(PARAMETER_COUNT, PARAMETER_COUNT);
        for (row, &own) in free.iter().enumerate() {
            for (column, &other) in free.iter().enumerate() {
                covariance[(own, other)] = inverse[(row, column)] * expected[own] * expected[other];
            }
        }
        let over = each.iter().filter_map(|one| {
            let angles = angles_told(machine, &values, one.pose)?;
            Some((one.pose, deviation(&values, &covariance, &angles, one.pose)))
        });
        PoseError::over(over)
    };
    Proposal {
        poses: chosen.iter().map(|index| each[*index].pose).collect(),
        gain: log_det(&information) - log_det(&begin),
        before: error(&begin),
        after: error(&information),
    }
}

impl PlannedReading {
    /// A reading of this kind.
    fn at(self, place_m: [f64; 2]) -> DeviceReading {
        match self {
            Self::Pose => DeviceReading::Place {
                place_m,
                angle_rad: Some(0.0),
            },
            Self::Place => DeviceReading::Place {
                place_m,
                angle_rad: None,
            },
            Self::Distance(centre_m) => DeviceReading::Distance {
                distance_m: 0.0,
                centre_m,
            },
        }
    }
}

/// Chooses candidates, greedily and by exchanges; `information` gets theirs.
fn choose(each: &[PoseCandidate], information: &mut DMatrix<f64>, count: usize) -> Vec<usize> {
    let mut chosen = Vec::new();
    let mut inverse = inverse_of(information);
    for _ in 0..count {
        let Some((index, _)) = best(each, &inverse) else {
            return chosen;
        };
        chosen.push(index);
        add(information, &each[index].slopes, 1.0);
        inverse = inverse_of(information);
    }
    for _ in 0..ROUNDS {
        let mut has_changed = false;
        for place in &mut chosen {
            let own = &each[*place].slopes;
            add(information, own, -1.0);
            let inverse = inverse_of(information);
            let mut index = *place;
            if let Some((better, most)) = best(each, &inverse)
                && most > gain(own, &inverse) + LEAST_GAIN
            {
                index = better;
                has_changed = true;
            }
            *place = index;
            add(information, &each[index].slopes, 1.0);
        }
        if !has_changed {
            break;
        }
    }
    chosen
}

fn add(information: &mut DMatrix<f64>, slopes: &DMatrix<f64>, sign: f64) {
    *information += slopes.transpose() * slopes * sign;
}

fn inverse_of(information: &DMatrix<f64>) -> DMatrix<f64> {
    // Positive definite: the identity is part of it.
    let factors = information.clone().cholesky();
    factors.map_or_else(
        || DMatrix::identity(information.nrows(), information.ncols()),
        |factors| factors.inverse(),
    )
}

fn log_det(information: &DMatrix<f64>) -> f64 {
    let factors = information.clone().cholesky();
    factors.map_or(0.0, |factors| {
        let diagonal = factors.l_dirty().diagonal();
        2.0 * diagonal.iter().map(|part| part.ln()).sum::<f64>()
    })
}

/// log det(1 + J M^-1 J^T), for the thousands of candidates of a step: in plain loops.
fn gain(slopes: &DMatrix<f64>, inverse: &DMatrix<f64>) -> f64 {
    let (count, size) = slopes.shape();
    // Columns of a symmetric matrix lie one after the other.
    let columns = inverse.as_slice();
    let mut inside = [[0.0; MOST_VALUES]; MOST_VALUES];
    for column in 0..size {
        let own = &columns[column * size..(column + 1) * size];
        for (row, line) in inside.iter_mut().enumerate().take(count) {
            let parts = own.iter().enumerate();
            let sum: f64 = parts.map(|(index, part)| slopes[(row, index)] * part).sum();
            for (other, cell) in line.iter_mut().enumerate().take(count) {
                *cell += sum * slopes[(other, column)];
            }
        }
    }
    for (index, row) in inside.iter_mut().enumerate() {
        row[index] += 1.0;
    }
    let [a, b, c] = inside;
    let determinant = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0])
        + a[2] * (b[0] * c[1] - b[1] * c[0]);
    determinant.max(f64::MIN_POSITIVE).ln()
}

fn best(each: &[PoseCandidate], inverse: &DMatrix<f64>) -> Option<(usize, f64)> {
    let gains = each.iter().map(|one| gain(&one.slopes, inverse));
    gains
        .enumerate()
        .max_by(|one, other| one.1.total_cmp(&other.1))
}
