//! Directions of the parameters that rows see.

use crate::closure::LoopClosure;
use crate::fit::jacobian;
use crate::gauge::candidates;
use crate::measurement::{DeviceReading, MeasuredRow};
use crate::parameter::{KinematicVector, PARAMETER_COUNT, parameter_name};
use crate::setup::CalibrationSetup;
use crate::sight::{Sight, columns_of, in_words};
use nalgebra::{DMatrix, DVector};

/// Slopes of all values, in standard deviations, by the free parameters, in expected deviations.
pub(crate) fn scaled_slopes(
    setup: &CalibrationSetup,
    rows: &[MeasuredRow],
    values: &KinematicVector,
    closed: &[LoopClosure],
) -> DMatrix<f64> {
    let (free, expected) = (setup.free_indices(), setup.expected());
    let whole = jacobian(rows, values, closed);
    DMatrix::from_fn(whole.nrows(), free.len(), |row, column| {
        whole[(row, free[column])] * expected[free[column]]
    })
}

/// Directions of all parameters, in their units.
pub(crate) struct Directions {
    pub(crate) free: Vec<usize>,
    pub(crate) expected: [f64; PARAMETER_COUNT],
    pub(crate) sight: Sight,
    /// Angle of the platform in the first row.
    pub(crate) alpha: f64,
}

impl Directions {
    pub(crate) fn of(
        setup: &CalibrationSetup,
        rows: &[MeasuredRow],
        values: &KinematicVector,
        closed: &[LoopClosure],
    ) -> Self {
        Self {
            sight: Sight::of(&scaled_slopes(setup, rows, values, closed)),
            free: setup.free_indices(),
            expected: setup.expected(),
            alpha: closed.first().map_or(0.0, |at| at.pose[2]),
        }
    }

    /// Columns of scaled free parameters as columns of all parameters.
    pub(crate) fn unscaled(&self, directions: &DMatrix<f64>) -> DMatrix<f64> {
        let columns: Vec<DVector<f64>> = directions
            .column_iter()
            .map(|direction| {
                let mut column = DVector::zeros(PARAMETER_COUNT);
                for (part, index) in direction.iter().zip(&self.free) {
                    column[*index] = part * self.expected[*index];
                }
                column
            })
            .collect();
        columns_of(PARAMETER_COUNT, &columns)
    }

    /// Blind and weak directions in words.
    pub(crate) fn words(&self, values: &KinematicVector, rows: &[MeasuredRow]) -> [Vec<String>; 2] {
        let centres = rows.iter().filter_map(|row| match row.reading {
            DeviceReading::Distance { centre_m, .. } => Some(centre_m),
            DeviceReading::Place { .. } => None,
        });
        let centres: Vec<[f64; 2]> = centres.collect();
        let known = candidates(values, (&centres, self.alpha), &self.free, &self.expected);
        let name = |index: usize| parameter_name(self.free[index]);
        [&self.sight.blind, &self.sight.weak].map(|directions| in_words(directions, &known, name))
    }
}
