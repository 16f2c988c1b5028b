//! Sine and cosine of a fraction of a turn.

use super::product::{signed, signed_high};

/// Sine and cosine in 2^-29 of `turn`, in 2^-32 of a turn.
///
/// The angle is brought within an eighth of a turn, x = 8 turns from the nearest quarter; then
/// sin = x p(x^2) and cos = 1 - x^2 q(x^2), p of degree 4 and q of degree 3, minimax by mpmath
/// (0.002 and 0.1 units in the last place). The error is below 0.9 units.
#[inline(always)]
pub(super) fn sin_cos(turn: u32) -> (i32, i32) {
    let quadrant = turn.wrapping_add(1 << 29) >> 30;
    let x = (turn.wrapping_sub(quadrant << 30) << 2) as i32;
    // x in 2^-31, z in 2^-30. A coefficient stands two bits higher than the one before it, which
    // is what the product with z takes off again.
    let z = signed_high(x, x);
    let p = 169_873;
    let p = -5_026_472 + signed_high(z, p);
    let p = 85_569_259 + signed_high(z, p);
    let p = -693_598_667 + signed_high(z, p);
    let p = 1_686_629_713 + signed_high(z, p);
    let sin = rounded32(signed(x, p));
    let q = -973_608;
    let q = 22_399_897 + signed_high(z, q);
    let q = -272_375_456 + signed_high(z, q);
    let q = 1_324_675_878 + signed_high(z, q);
    let cos = (1 << 29) - rounded32(signed(z, q));
    match quadrant & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// From 2^-62 to 2^-29.
#[inline(always)]
fn rounded32(wide: i64) -> i32 {
    ((wide >> 32) as i32 + 1) >> 1
}
