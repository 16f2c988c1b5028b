//! Directions of a parameter space that measurements see, by singular values.
//!
//! Columns of the Jacobian are scaled by the deviation that is expected of each parameter, rows by the noise. So a singular
//! value is a ratio of signal to noise: along its direction an expected deviation changes the measurements by so many standard
//! deviations. Below 1 the measurements know less than is expected anyway.

use nalgebra::{DMatrix, DVector};

/// Least ratio of signal to noise of a direction that is seen.
pub(crate) const LEAST_RATIO: f64 = 1.0;

/// Ratio to the greatest singular value below which a direction is not seen at all, but for rounding.
const ROUNDING: f64 = 1e-9;

/// Part of a named direction that lies in the span which it describes.
const INSIDE: f64 = 0.999;

/// Part of a named direction that no other named one has.
const INDEPENDENT: f64 = 0.1;

/// Directions that are seen, and those that are held, in scaled parameters.
#[derive(Clone, Debug)]
pub(crate) struct Sight {
    /// Orthonormal directions that are seen, as columns.
    pub(crate) seen: DMatrix<f64>,
    /// Orthonormal directions that no measurement sees at all.
    pub(crate) blind: DMatrix<f64>,
    /// Orthonormal directions that are seen less than they are known.
    pub(crate) weak: DMatrix<f64>,
    /// Singular values, the greatest first.
    pub(crate) ratios: Vec<f64>,
}

impl Sight {
    /// Directions that the scaled `jacobian` sees.
    pub(crate) fn of(jacobian: &DMatrix<f64>) -> Self {
        let (rows, columns) = jacobian.shape();
        let square = match rows > columns {
            // The triangle has the same directions, and far fewer rows.
            true => jacobian.clone().qr().r(),
            false => jacobian.clone(),
        };
        // With fewer rows than columns the decomposition would leave out directions.
        let padded = square.resize_vertically(columns, 0.0);
        let decomposed = padded.svd(false, true);
        let directions = decomposed
            .v_t
            .unwrap_or_else(|| DMatrix::identity(columns, columns));
        let values = &decomposed.singular_values;
        let greatest = values.iter().copied().fold(0.0, f64::max);
        let mut order: Vec<usize> = (0..columns).collect();
        order.sort_by(|one, other| values[*other].total_cmp(&values[*one]));
        let is_blind = |index: &usize| values[*index] <= ROUNDING * greatest;
        let is_seen = |index: &usize| values[*index] >= LEAST_RATIO && !is_blind(index);
        let pick = |keep: &dyn Fn(&usize) -> bool| {
            let kept = order.iter().filter(|index| keep(index));
            let kept: Vec<DVector<f64>> = kept
                .map(|index| directions.row(*index).transpose())
                .collect();
            columns_of(columns, &kept)
        };
        Self {
            seen: pick(&is_seen),
            blind: pick(&is_blind),
            weak: pick(&|index| !is_seen(index) && !is_blind(index)),
            ratios: order.iter().map(|index| values[*index]).collect(),
        }
    }

    /// Part of a unit of each parameter that lies in the seen directions, 0 to 1.
    pub(crate) fn shares(&self) -> Vec<f64> {
        let rows = self.seen.row_iter();
        rows.map(|row| row.norm_squared()).collect()
    }
}

/// Matrix of `rows` rows with these columns.
pub(crate) fn columns_of(rows: usize, columns: &[DVector<f64>]) -> DMatrix<f64> {
    DMatrix::from_fn(rows, columns.len(), |row, column| columns[column][row])
}

/// Names directions that span those of `whole`: those of `known` that lie in it, as far as they are independent, and what is left by its
/// largest parts.
pub(crate) fn in_words(
    whole: &DMatrix<f64>,
    known: &[(String, DVector<f64>)],
    name: impl Fn(usize) -> String,
) -> Vec<String> {
    let mut words = Vec::new();
    let mut rest = whole.clone();
    for (word, direction) in known {
        let length = direction.norm();
        if rest.ncols() == 0 || length == 0.0 {
            continue;
        }
        let unit = direction / length;
        let inside = |span: &DMatrix<f64>| span * (span.transpose() * &unit);
        let new = inside(&rest);
        if inside(whole).norm() < INSIDE || new.norm() < INDEPENDENT {
            continue;
        }
        words.push(word.clone());
        rest = without(&rest, &new.normalize());
    }
    for direction in rest.column_iter() {
        let mut order: Vec<usize> = (0..direction.len()).collect();
        order.sort_by(|one, other| direction[*other].abs().total_cmp(&direction[*one].abs()));
        let largest = direction[order[0]];
        let parts = order.iter().take(6).filter_map(|index| {
            let part = direction[*index] / largest;
            (part.abs() > 0.1).then(|| format!("{part:+.2} {}", name(*index)))
        });
        words.push(format!(
            "together, in expected deviations: {}",
            parts.collect::<Vec<_>>().join(", ")
        ));
    }
    words
}

/// Orthonormal columns that span those of `basis` but for `unit`, which lies in their span.
fn without(basis: &DMatrix<f64>, unit: &DVector<f64>) -> DMatrix<f64> {
    let mut kept: Vec<DVector<f64>> = Vec::new();
    for column in basis.column_iter() {
        let mut own = column.clone_owned();
        // Twice: once more takes away what rounding has left.
        for _ in 0..2 {
            own -= unit * unit.dot(&own);
            for other in &kept {
                own -= other * other.dot(&own);
            }
        }
        if own.norm() > 1e-6 && kept.len() + 1 < basis.ncols() {
            kept.push(own.normalize());
        }
    }
    columns_of(basis.nrows(), &kept)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_are_seen_weak_or_blind() {
        // Sees the first parameter well, the second weakly, and only the sum of the others.
        let jacobian = DMatrix::from_row_slice(
            3,
            4,
            &[10.0, 0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0, 0.0, 0.0, 3.0, 3.0],
        );
        let sight = Sight::of(&jacobian);
        assert_eq!(
            [&sight.seen, &sight.weak, &sight.blind].map(|it| it.ncols()),
            [2, 1, 1]
        );
        let shares = sight.shares();
        for (share, own) in shares.iter().zip([1.0, 0.0, 0.5, 0.5]) {
            assert!((share - own).abs() < 1e-12, "{shares:?}");
        }
        let difference = DVector::from_vec(vec![0.0, 0.0, 1.0, -1.0]);
        let known = [("the difference".to_owned(), difference)];
        let words = in_words(&sight.blind, &known, |index| format!("p{index}"));
        assert_eq!(words, ["the difference"]);
        let words = in_words(&sight.blind, &[], |index| format!("p{index}"));
        assert!(
            words[0].contains("+1.00 p") && words[0].contains("-1.00 p"),
            "{words:?}"
        );
        assert_eq!(
            in_words(&sight.weak, &[], |index| format!("p{index}")).len(),
            1
        );
    }
}
