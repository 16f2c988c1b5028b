//! Fits of rows without those that are far off, and the spread of the result.

use crate::closure::LoopClosure;
use crate::directions::Directions;
use crate::fit::{Fit, Fitted, jacobian, residuals};
use crate::measurement::MeasuredRow;
use crate::parameter::{KinematicVector, PARAMETER_COUNT};
use crate::refusal::CalibrationRefusal;
use crate::setup::CalibrationSetup;
use crate::sight::columns_of;
use nalgebra::{DMatrix, DVector};

/// Values beyond the directions that are seen: without them nothing is left to judge the fit by.
const SPARE_VALUES: usize = 3;

/// Residual of an outlier, in standard deviations.
const OUTLIER: f64 = 5.0;

/// Root mean square of the residuals, in standard deviations, from which on a search has not found the machine.
const LOST: f64 = 5.0;

/// Parts of the rows that are fitted first where the search is lost.
const FIRST_PARTS: [f64; 3] = [0.9, 0.75, 0.5];

/// Rows with the poses from which their loops are closed.
#[derive(Clone)]
pub(crate) struct MeasuredRows {
    pub(crate) rows: Vec<MeasuredRow>,
    pub(crate) closed: Vec<LoopClosure>,
}

impl MeasuredRows {
    /// Root mean square of the residuals, in standard deviations.
    fn rms(&self, fitted: &Fitted) -> f64 {
        let values = residuals(&self.rows, &fitted.values, &fitted.closed);
        let squares: f64 = values.iter().map(|value| value * value).sum();
        (squares / values.len().max(1) as f64).sqrt()
    }
}

pub(crate) struct FoundValues {
    pub(crate) directions: Directions,
    pub(crate) fitted: Fitted,
}

pub(crate) fn fit(
    setup: &CalibrationSetup,
    rows: &MeasuredRows,
    base: KinematicVector,
) -> Result<FoundValues, CalibrationRefusal> {
    let directions = Directions::of(setup, &rows.rows, &base, &rows.closed);
    let seen = directions.sight.seen.ncols();
    let values: usize = rows.rows.iter().map(MeasuredRow::value_count).sum();
    if seen == 0 {
        let [blind, weak] = directions.words(&base, &rows.rows);
        return Err(CalibrationRefusal::Blind([blind, weak].concat().join("; ")));
    }
    // Directions that are not seen are counted as far as the rows could see them.
    let asked = seen.max(values.min(directions.free.len()));
    if values < asked + SPARE_VALUES {
        return Err(CalibrationRefusal::TooFew {
            values,
            seen,
            needed: asked + SPARE_VALUES,
        });
    }
    let along = directions.unscaled(&directions.sight.seen);
    let from_base = Fit::run(
        &rows.rows,
        rows.closed.clone(),
        base,
        &along,
        DVector::zeros(seen),
    );
    let fitted = match from_base {
        Some(fitted) if rows.rms(&fitted) < LOST => fitted,
        lost => {
            let steps = FIRST_PARTS.iter();
            let steps = steps.filter_map(|part| in_two_steps(rows, base, &along, *part));
            let found = lost.into_iter().chain(steps);
            let best = found.min_by(|one, other| rows.rms(one).total_cmp(&rows.rms(other)));
            best.ok_or(CalibrationRefusal::NoFit)?
        }
    };
    Ok(FoundValues { directions, fitted })
}

/// Fits the `part` of the rows that is least off, then all rows from there. Near a parallel singularity a small error of the parts moves the
/// platform far, and a step that helps the other rows leads such a row out of its assembly mode: the search ends before it has begun.
fn in_two_steps(
    rows: &MeasuredRows,
    base: KinematicVector,
    along: &DMatrix<f64>,
    part: f64,
) -> Option<Fitted> {
    let off = |index: usize| {
        let row = &rows.rows[index];
        let residuals = row.residuals(&base, rows.closed[index].pose);
        let values = residuals.iter().take(row.value_count());
        values.fold(0.0, |most: f64, value| most.max(value.abs()))
    };
    let mut order: Vec<usize> = (0..rows.rows.len()).collect();
    order.sort_by(|one, other| off(*one).total_cmp(&off(*other)));
    order.truncate((part * order.len() as f64).ceil() as usize);
    let first = MeasuredRows {
        rows: order.iter().map(|index| rows.rows[*index]).collect(),
        closed: order.iter().map(|index| rows.closed[*index]).collect(),
    };
    let zero = DVector::zeros(along.ncols());
    let found = Fit::run(&first.rows, first.closed, base, along, zero)?;
    let starts = rows.closed.clone();
    Fit::run(&rows.rows, starts, base, along, found.variables)
}

/// Fits, leaves out the row that is farthest off while that is an outlier, and fits again.
pub(crate) fn without_outliers(
    setup: &CalibrationSetup,
    mut rows: MeasuredRows,
    base: KinematicVector,
) -> Result<(MeasuredRows, FoundValues), CalibrationRefusal> {
    let most = rows.rows.len() / 10;
    let mut left_out = 0;
    loop {
        let found = fit(setup, &rows, base)?;
        let judged = studentised(&rows, &found);
        let scale = robust_scale(&judged).max(1.0);
        let worst = judged
            .iter()
            .enumerate()
            .max_by(|one, other| one.1.total_cmp(other.1));
        match worst {
            Some((index, sigmas))
                if *sigmas > OUTLIER * scale && left_out < most && !setup.keeps_outliers =>
            {
                rows.rows.remove(index);
                rows.closed.remove(index);
                left_out += 1;
            }
            _ => return Ok((rows, found)),
        }
    }
}

/// Residual of each row over what it should be by the fit: the largest of its values.
pub(crate) fn studentised(rows: &MeasuredRows, found: &FoundValues) -> Vec<f64> {
    let FoundValues { directions, fitted } = found;
    let along = directions.unscaled(&directions.sight.seen);
    let slopes = jacobian(&rows.rows, &fitted.values, &fitted.closed) * along;
    // Part of each value that the fit makes up itself.
    let own = slopes.clone().svd(true, false).u;
    let leverage = |value: usize| own.as_ref().map_or(0.0, |u| u.row(value).norm_squared());
    let values = residuals(&rows.rows, &fitted.values, &fitted.closed);
    let mut next = 0;
    let each = rows.rows.iter().map(|row| {
        let range = next..next + row.value_count();
        next = range.end;
        range.fold(0.0, |most: f64, value| {
            let freedom = (1.0 - leverage(value)).max(0.02);
            most.max(values[value].abs() / freedom.sqrt())
        })
    });
    each.collect()
}

/// Standard deviation by the median, which outliers do not move: of the largest of three values.
pub(crate) fn robust_scale(judged: &[f64]) -> f64 {
    let mut sorted = judged.to_vec();
    sorted.sort_by(f64::total_cmp);
    // The median of the largest of three normal values is 1.26 of their deviation.
    sorted
        .get(sorted.len() / 2)
        .map_or(0.0, |median| median / 1.26)
}

/// Spread of the parameters.
pub(crate) struct Spread {
    pub(crate) deviations: [f64; PARAMETER_COUNT],
    pub(crate) noise_factor: f64,
    pub(crate) covariance: DMatrix<f64>,
}

impl Spread {
    pub(crate) fn of(rows: &MeasuredRows, found: &FoundValues) -> Self {
        let FoundValues { directions, fitted } = found;
        let along = directions.unscaled(&directions.sight.seen);
        let slopes = jacobian(&rows.rows, &fitted.values, &fitted.closed) * &along;
        let values = residuals(&rows.rows, &fitted.values, &fitted.closed);
        let squares: f64 = values.iter().map(|value| value * value).sum();
        let freedom = (values.len() - along.ncols()).max(1) as f64;
        let noise_factor = (squares / freedom).sqrt();
        // A smaller scatter than was given may be luck; a greater one is not.
        let factor = noise_factor.max(1.0);
        let information = slopes.transpose() * &slopes;
        let inverse = information
            .try_inverse()
            .unwrap_or_else(|| DMatrix::identity(along.ncols(), along.ncols()));
        let of_seen = &along * inverse * along.transpose() * (factor * factor);
        let held = directions.unscaled(&columns_of(
            directions.free.len(),
            &[&directions.sight.blind, &directions.sight.weak]
                .iter()
                .flat_map(|it| it.column_iter().map(|column| column.clone_owned()))
                .collect::<Vec<_>>(),
        ));
        let deviations = std::array::from_fn(|index| of_seen[(index, index)].max(0.0).sqrt());
        Self {
            deviations,
            noise_factor,
            covariance: of_seen + &held * held.transpose(),
        }
    }
}
