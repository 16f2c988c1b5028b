//! Least squares along the directions that are seen.

use crate::closure::{LoopClosure, close};
use crate::measurement::MeasuredRow;
use crate::parameter::{KinematicVector, PARAMETER_COUNT};
use levenberg_marquardt::{LeastSquaresProblem, LevenbergMarquardt};
use nalgebra::storage::Owned;
use nalgebra::{DMatrix, DVector, Dyn};

/// Residual of a trial whose loops do not close: such a step is never taken.
const NO_MOTION: f64 = 1e8;

/// Parameters `base + directions q` that are fitted to rows.
pub(crate) struct Fit<'a> {
    rows: &'a [MeasuredRow],
    base: KinematicVector,
    /// Parameters by fitted variables.
    directions: &'a DMatrix<f64>,
    /// Poses of the rows from which Newton's method starts.
    starts: Vec<LoopClosure>,
    variables: DVector<f64>,
    values: KinematicVector,
    /// Poses at `values`; none where a loop does not close, or the assembly mode is another one.
    closed: Option<Vec<LoopClosure>>,
}

/// Parameters that fit, and the poses of the rows there.
pub(crate) struct Fitted {
    /// Along the fitted directions.
    pub(crate) variables: DVector<f64>,
    pub(crate) values: KinematicVector,
    pub(crate) closed: Vec<LoopClosure>,
}

impl<'a> Fit<'a> {
    /// Fits `rows`, whose loops close at `starts` with the parameters `base`. The search starts at `variables` along `directions`. None where no step leads on.
    pub(crate) fn run(
        rows: &'a [MeasuredRow],
        starts: Vec<LoopClosure>,
        base: KinematicVector,
        directions: &'a DMatrix<f64>,
        variables: DVector<f64>,
    ) -> Option<Fitted> {
        let mut fit = Self {
            rows,
            base,
            directions,
            starts,
            variables: DVector::zeros(directions.ncols()),
            values: base,
            closed: None,
        };
        fit.move_to(variables);
        if directions.ncols() == 0 {
            return fit.end();
        }
        let (fit, report) = LevenbergMarquardt::new().minimize(fit);
        match report.termination.was_successful() {
            true => fit.end(),
            false => None,
        }
    }

    fn end(self) -> Option<Fitted> {
        Some(Fitted {
            variables: self.variables,
            values: self.values,
            closed: self.closed?,
        })
    }

    fn move_to(&mut self, variables: DVector<f64>) {
        let by = self.directions * &variables;
        self.variables = variables;
        let mut values = self.base;
        for (value, by) in values.0.iter_mut().zip(by.iter()) {
            *value += by;
        }
        self.values = values;
        self.closed = close_all(self.rows, &values, &self.starts);
    }
}

/// Poses of all rows, from `starts` on in their assembly modes.
pub(crate) fn close_all(
    rows: &[MeasuredRow],
    values: &KinematicVector,
    starts: &[LoopClosure],
) -> Option<Vec<LoopClosure>> {
    let each = rows.iter().zip(starts).map(|(row, start)| {
        let found = close(values, &row.angles_rad, start.pose)?;
        (found.side == start.side).then_some(found)
    });
    each.collect()
}

/// Slopes of all values by the parameters, in standard deviations: a row for each value.
pub(crate) fn jacobian(
    rows: &[MeasuredRow],
    values: &KinematicVector,
    closed: &[LoopClosure],
) -> DMatrix<f64> {
    let count: usize = rows.iter().map(MeasuredRow::value_count).sum();
    let mut jacobian = DMatrix::zeros(count, PARAMETER_COUNT);
    let mut next = 0;
    for (row, at) in rows.iter().zip(closed) {
        let linear = row.linearised(values, at);
        for slopes in &linear.slopes[..linear.count] {
            for (column, slope) in slopes.iter().enumerate() {
                jacobian[(next, column)] = *slope;
            }
            next += 1;
        }
    }
    jacobian
}

/// Residuals of all values, in standard deviations.
pub(crate) fn residuals(
    rows: &[MeasuredRow],
    values: &KinematicVector,
    closed: &[LoopClosure],
) -> Vec<f64> {
    let each = rows.iter().zip(closed).flat_map(|(row, at)| {
        let own = row.residuals(values, at.pose);
        own.into_iter().take(row.value_count())
    });
    each.collect()
}

impl LeastSquaresProblem<f64, Dyn, Dyn> for Fit<'_> {
    type ResidualStorage = Owned<f64, Dyn>;
    type JacobianStorage = Owned<f64, Dyn, Dyn>;
    type ParameterStorage = Owned<f64, Dyn>;

    fn set_params(&mut self, variables: &DVector<f64>) {
        self.move_to(variables.clone_owned());
    }

    fn params(&self) -> DVector<f64> {
        self.variables.clone()
    }

    fn residuals(&self) -> Option<DVector<f64>> {
        let found = match &self.closed {
            Some(closed) => residuals(self.rows, &self.values, closed),
            None => {
                let count = self.rows.iter().map(MeasuredRow::value_count).sum();
                vec![NO_MOTION; count]
            }
        };
        Some(DVector::from_vec(found))
    }

    fn jacobian(&self) -> Option<DMatrix<f64>> {
        let closed = self.closed.as_ref()?;
        // A residual falls where the computed value grows.
        Some(-jacobian(self.rows, &self.values, closed) * self.directions)
    }
}
