//! Check that torques are in N m, at the joints.

use super::bodies::{BODY_COUNT, BodyVector, FRICTION, PASSIVE};
use super::equations::TorqueEquation;
use super::linear::in_blocks;
use super::result::TorqueFactor;
use nalgebra::{DMatrix, DVector};

/// Factor between torques and those of the scene from which on no guess of masses is that wrong.
const WRONG: f64 = 10.0;

/// Standard deviations by which the factor has to be beyond [`WRONG`].
const CERTAIN: f64 = 3.0;

/// Returns the factor between the torques and those of the bodies of `nominal`, if it is certain that no machine like that of the scene
/// takes such torques. Friction of the motors explains whatever it can.
pub(super) fn wrong_factor(
    equations: &[&TorqueEquation],
    nominal: &BodyVector,
) -> Option<TorqueFactor> {
    let mut bodies = *nominal;
    bodies.0[FRICTION..BODY_COUNT].fill(0.0);
    let of_bodies = DVector::from_fn(equations.len(), |row, _| equations[row].by(&bodies));
    let of_friction = (FRICTION..PASSIVE)
        .map(|index| DVector::from_fn(equations.len(), |row, _| equations[row].slopes[index]));
    // A motor that stands has no column; all columns of one size.
    let columns = std::iter::once(of_bodies.clone()).chain(of_friction);
    let columns: Vec<_> = columns
        .filter_map(|column| column.try_normalize(0.0))
        .collect();
    let slopes = DMatrix::from_columns(&columns);
    let torques = DVector::from_iterator(equations.len(), equations.iter().map(|it| it.torque));
    let size = of_bodies.norm();
    // Bodies without torques, and friction that cannot be told from them, leave nothing to compare.
    if size == 0.0 {
        return None;
    }
    let information = slopes.transpose() * &slopes;
    let found = information
        .cholesky()?
        .solve(&(slopes.transpose() * &torques));
    let covariance = in_blocks(&slopes, &(&torques - &slopes * &found), equations);
    let (factor, deviation) = (found[0] / size, covariance[(0, 0)].max(0.0).sqrt() / size);
    let reach = CERTAIN * deviation;
    let is_wrong = factor - reach > WRONG || factor + reach < 1.0 / WRONG;
    let rms = |norm: f64| norm / (equations.len() as f64).sqrt();
    is_wrong.then(|| TorqueFactor {
        factor,
        measured_nm: rms(torques.norm()),
        expected_nm: rms(size),
    })
}
