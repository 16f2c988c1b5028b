//! The error of the platform: Krawczyk's test on the three loop closures, over the whole box at once.
//!
//! The error z = (dx, dy, dalpha) solves g(z, v) = 0 for every v of the box, g the residuals of the loops. With a first
//! guess z0(v) that is linear in v, z = z0(v) + w, and Y near the inverse of the derivatives of g,
//!
//! ```text
//! K(W) = -Y g(z0(v), v) + (1 - Y g'(z0(v) + W, v)) W
//! ```
//!
//! lies inside W only if each v has exactly one solution w(v) in W, and g' is regular there. The solution is then
//! continuous in v. The nominal machine's, z = 0, is among them: so all of them belong to the assembly mode of the
//! commanded pose.

use crate::machine::{CommandedLeg, RealLeg, UncertainMachine, jacobian_row};
use crate::model::BoxModel;
use crate::parameter::TIME;
use nalgebra::{Matrix3, Vector3};
use trirrr_core::number::Arithmetic;

/// Attempts to find a W that holds its image; each starts with the image of the one before.
const ATTEMPTS: usize = 12;

impl UncertainMachine {
    /// The error of the platform over the box; `None` where no bound is proven.
    pub(crate) fn platform_error(
        &self,
        commanded: &[CommandedLeg; 3],
    ) -> Option<Vector3<BoxModel>> {
        let at_zero = self.real_legs(commanded, &Vector3::from([BoxModel::ZERO; 3]));
        let inverse = inverse_of_middle(&at_zero)?;
        let newton = |legs: &[RealLeg; 3]| -combined(&inverse, self.residuals(commanded, legs));
        let guess = newton(&at_zero).map(BoxModel::without_error);
        let step = newton(&self.real_legs(commanded, &guess));
        let reach = step.map(|step| step.magnitude());
        // The nominal machine's own solution, whatever rounding has made of it.
        let nominal = guess.map(|guess| guess.constant.abs() + guess.linear[TIME].abs());
        let mut half_widths = reach.zip_map(&nominal, |reach, nominal| 1.1 * reach + 2.0 * nominal);
        for _ in 0..ATTEMPTS {
            let around = guess.zip_map(&half_widths, BoxModel::widened);
            let legs = self.real_legs(commanded, &around);
            let excess = deviations(&inverse, &legs) * half_widths;
            // Sums of a few terms that are not negative.
            let image = (reach + excess) * (1.0 + 16.0 * f64::UNIT_ROUNDOFF);
            if !image.iter().all(|size| size.is_finite()) {
                return None;
            }
            if (0..3).all(|i| image[i] < half_widths[i] && nominal[i] < half_widths[i]) {
                return Some((guess + step).zip_map(&excess, BoxModel::widened));
            }
            half_widths = image.zip_map(&half_widths, |image, old| (1.2 * image).max(old));
        }
        None
    }
}

/// Y v.
fn combined(matrix: &Matrix3<f64>, v: [BoxModel; 3]) -> Vector3<BoxModel> {
    let row = |i: usize| {
        (0..3)
            .map(|j| BoxModel::point(matrix[(i, j)]) * v[j])
            .fold(BoxModel::ZERO, |sum, term| sum + term)
    };
    Vector3::new(row(0), row(1), row(2))
}

/// Sizes of the entries of 1 - Y A.
fn deviations(inverse: &Matrix3<f64>, legs: &[RealLeg; 3]) -> Matrix3<f64> {
    let rows = legs.each_ref().map(jacobian_row);
    let mut sizes = Matrix3::zeros();
    for column in 0..3 {
        let product = combined(inverse, rows.map(|row| row[column]));
        for row in 0..3 {
            let one = if row == column {
                BoxModel::ONE
            } else {
                BoxModel::ZERO
            };
            sizes[(row, column)] = (one - product[row]).magnitude();
        }
    }
    sizes
}

/// Inverse of A in the middle of the box, as near as binary64 has it; `None` if there is none.
fn inverse_of_middle(legs: &[RealLeg; 3]) -> Option<Matrix3<f64>> {
    let [a, b, c] = legs
        .each_ref()
        .map(|leg| jacobian_row(leg).map(|entry| entry.constant));
    let (b_c, c_a, a_b) = (b.cross(&c), c.cross(&a), a.cross(&b));
    let inverse = Matrix3::from_columns(&[b_c, c_a, a_b]) / a.dot(&b_c);
    inverse
        .iter()
        .all(|entry| entry.is_finite())
        .then_some(inverse)
}
