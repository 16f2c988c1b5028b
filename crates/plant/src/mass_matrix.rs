//! The symmetric mass matrix of the platform's three coordinates.

/// Adds the upper triangle of `a^T b`, which is part of a symmetric sum.
#[inline(always)]
pub(crate) fn add_symmetric(m: &mut [f64; 6], a: &[f64; 3], b: &[f64; 3]) {
    m[0] += a[0] * b[0];
    m[1] += a[0] * b[1];
    m[2] += a[0] * b[2];
    m[3] += a[1] * b[1];
    m[4] += a[1] * b[2];
    m[5] += a[2] * b[2];
}

/// Solves M a = right by Cholesky's factors without roots; `None` where M is not positive
/// definite to within rounding.
#[inline(always)]
pub(crate) fn solve(m: &[f64; 6], right: [f64; 3]) -> Option<[f64; 3]> {
    let [xx, xy, xa, yy, ya, aa] = *m;
    let least = 16.0 * f64::EPSILON;
    let inverse_x = 1.0 / xx;
    let (l_yx, l_ax) = (xy * inverse_x, xa * inverse_x);
    let pivot_y = yy - l_yx * xy;
    let inverse_y = 1.0 / pivot_y;
    let rest = ya - l_ax * xy;
    let l_ay = rest * inverse_y;
    let pivot_a = aa - l_ax * xa - l_ay * rest;
    if !(xx > 0.0 && pivot_y > least * yy && pivot_a > least * aa) {
        return None;
    }
    let y = right[1] - l_yx * right[0];
    let a = (right[2] - l_ax * right[0] - l_ay * y) / pivot_a;
    let y = y * inverse_y - l_ay * a;
    Some([right[0] * inverse_x - l_yx * y - l_ax * a, y, a])
}
