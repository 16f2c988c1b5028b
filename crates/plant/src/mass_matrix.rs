//! The symmetric mass matrix of the three coordinates.

use crate::leg::{Carrier, product};
use crate::scalar::Differentiable;

/// Rows and columns of the upper triangle, in the order of its entries.
const UPPER: [(usize, usize); 6] = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)];

/// Adds the upper triangle of `a^T b`, which is part of a symmetric sum.
#[inline(always)]
pub(crate) fn add_symmetric<T: Differentiable>(m: &mut [T; 6], a: &[T; 3], b: &[T; 3]) {
    for (entry, (row, column)) in m.iter_mut().zip(UPPER) {
        *entry = *entry + a[row] * b[column];
    }
}

/// Mass matrix and forces of the platform, given for x, y and alpha, in other coordinates: J^T M J
/// and J^T (right - M b).
pub(crate) fn carried<T: Differentiable>(
    carrier: &Carrier<T>,
    m: &[T; 6],
    right: [T; 3],
) -> ([T; 6], [T; 3]) {
    let [xx, xy, xa, yy, ya, aa] = *m;
    let rows = [[xx, xy, xa], [xy, yy, ya], [xa, ya, aa]];
    let [bx, by] = carrier.bias;
    let forces: [T; 3] = std::array::from_fn(|i| right[i] - rows[i][0] * bx - rows[i][1] * by);
    let [x, y] = carrier.rows;
    let alpha = [T::from(0.0), T::from(0.0), T::from(1.0)];
    let mut carried = [T::from(0.0); 6];
    for (row, axis) in rows.iter().zip([&x, &y, &alpha]) {
        add_symmetric(&mut carried, axis, &carrier.carried(row));
    }
    let right = std::array::from_fn(|i| product(&[x[i], y[i], alpha[i]], &forces));
    (carried, right)
}

/// Solves M a = right by Cholesky's factors without roots; `None` where M is not positive
/// definite to within rounding.
#[inline(always)]
pub(crate) fn solve<T: Differentiable>(m: &[T; 6], right: [T; 3]) -> Option<[T; 3]> {
    let [xx, xy, xa, yy, ya, aa] = *m;
    let least = 16.0 * f64::EPSILON;
    let inverse_x = T::from(1.0) / xx;
    let (l_yx, l_ax) = (xy * inverse_x, xa * inverse_x);
    let pivot_y = yy - l_yx * xy;
    let inverse_y = T::from(1.0) / pivot_y;
    let rest = ya - l_ax * xy;
    let l_ay = rest * inverse_y;
    let pivot_a = aa - l_ax * xa - l_ay * rest;
    let positive = |pivot: T, of: T| pivot.value() > least * of.value();
    if !(xx.value() > 0.0 && positive(pivot_y, yy) && positive(pivot_a, aa)) {
        return None;
    }
    let y = right[1] - l_yx * right[0];
    let a = (right[2] - l_ax * right[0] - l_ay * y) / pivot_a;
    let y = y * inverse_y - l_ay * a;
    Some([right[0] * inverse_x - l_yx * y - l_ax * a, y, a])
}
