//! Result of a calibration.

use crate::forecast::PoseError;
use crate::measurement::{DeviceReading, MeasuredRow};
use crate::parameter::{KinematicVector, PARAMETER_COUNT};
use crate::sight::LEAST_RATIO;
use nalgebra::DMatrix;

/// Row of a table, judged.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedRow {
    /// The measurement.
    pub row: MeasuredRow,
    /// Measured less computed values of the machine as it was: m, m, rad, or m for a distance.
    pub before: [f64; 3],
    /// The same of the calibrated machine.
    pub after: [f64; 3],
    /// The same of the machine that was fitted without the rows that check it; none for rows that were in the fit.
    pub checked: Option<[f64; 3]>,
    /// Largest residual of the row after the fit, in its standard deviations.
    pub sigmas: f64,
    /// The row was left out of the fit, or would be.
    pub is_outlier: bool,
}

/// A calibrated machine.
#[derive(Clone, Debug)]
pub struct Calibration {
    /// Parameters before, the device where it fits best.
    pub nominal: KinematicVector,
    /// Parameters that fit.
    pub values: KinematicVector,
    /// Standard deviations of the parameters, in the directions that are seen.
    pub deviations: [f64; PARAMETER_COUNT],
    /// Parts of the parameters that the measurements see, 0 to 1; the rest stays nominal.
    pub shares: [f64; PARAMETER_COUNT],
    /// Indices of the free parameters.
    pub free: Vec<usize>,
    /// Ratios of signal to noise along the directions, the greatest first.
    pub ratios: Vec<f64>,
    /// Directions that no measurement sees, in words; held.
    pub blind: Vec<String>,
    /// Directions that are seen less than they are known, in words; held.
    pub weak: Vec<String>,
    /// All rows.
    pub rows: Vec<JudgedRow>,
    /// Root mean square of the residuals of the fit over the given noise: 1 where the noise is as given.
    pub noise_factor: f64,
    /// Error of the machine as it was over the workspace, by the calibrated one.
    pub before: PoseError,
    /// Error that is expected of the calibrated machine there: standard deviations.
    pub after: PoseError,
    /// Parameters that are off by far more than is expected.
    pub unlikely: Vec<usize>,
    /// Information of the rows in the fit on the free parameters, scaled by their expected deviations.
    pub(crate) information: DMatrix<f64>,
}

/// Size of the residuals of rows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualSize {
    /// Rows.
    pub rows: usize,
    /// Root mean square of the distance of places, m; none without any.
    pub place_m: Option<f64>,
    /// Root mean square of angles, rad.
    pub angle_rad: Option<f64>,
    /// Root mean square of distances, m.
    pub distance_m: Option<f64>,
}

impl ResidualSize {
    /// Sums up `differences` of rows.
    pub fn of<'a>(rows: impl Iterator<Item = (&'a MeasuredRow, [f64; 3])>) -> Self {
        let (mut size, mut sums) = (Self::default(), [[0.0; 2]; 3]);
        for (row, [first, second, third]) in rows {
            size.rows += 1;
            let mut add = |which: usize, square: f64| {
                sums[which][0] += 1.0;
                sums[which][1] += square;
            };
            match row.reading {
                DeviceReading::Place { angle_rad, .. } => {
                    add(0, first * first + second * second);
                    if angle_rad.is_some() {
                        add(1, third * third);
                    }
                }
                DeviceReading::Distance { .. } => add(2, first * first),
            }
        }
        let root = |[count, sum]: [f64; 2]| (count > 0.0).then(|| (sum / count).sqrt());
        [size.place_m, size.angle_rad, size.distance_m] = sums.map(root);
        size
    }
}

impl Calibration {
    /// Number of directions that are seen.
    pub fn seen(&self) -> usize {
        self.ratios
            .iter()
            .filter(|ratio| **ratio >= LEAST_RATIO)
            .count()
    }

    /// Residuals of the rows in the fit, before and after.
    pub fn fit_sizes(&self) -> [ResidualSize; 2] {
        let rows = || self.rows.iter().filter(|row| !row.is_outlier);
        [
            ResidualSize::of(rows().map(|row| (&row.row, row.before))),
            ResidualSize::of(rows().map(|row| (&row.row, row.after))),
        ]
    }

    /// Residuals of the rows that were kept out of a fit of the others: before and after that fit. None where too few rows are left.
    pub fn check_sizes(&self) -> Option<[ResidualSize; 2]> {
        let checked = || {
            let rows = self.rows.iter();
            rows.filter_map(|row| Some((&row.row, row.before, row.checked?)))
        };
        (checked().count() > 0).then(|| {
            [
                ResidualSize::of(checked().map(|(row, before, _)| (row, before))),
                ResidualSize::of(checked().map(|(row, _, after)| (row, after))),
            ]
        })
    }
}
