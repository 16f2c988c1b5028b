//! The dyad's kernel in fixed point.
//!
//! d^2 and what is compared with it are held in 2^-58, exactly. Near a fold d, k and S are small
//! together, and the inner joint is a ratio of them. They are shifted left as far as d allows before
//! they are rounded, so that the joint is as accurate as d is.

use super::kernel::{DyadKernel, DyadPosition, OutOfReach, Triangle};
use crate::arithmetic::Fixed;
use crate::arithmetic::fixed::product::{
    joined, normalised, opaque, rounded, signed, signed_high, unsigned,
};
use crate::arithmetic::fixed::reciprocal::reciprocal;
use crate::arithmetic::fixed::root::inverse_root;
use crate::arithmetic::fixed::{FRACTION, Factor};
use nalgebra::Vector2;

impl DyadKernel for Fixed {
    #[inline(always)]
    fn intersect_circles(
        triangle: &Triangle<Self>,
        d: Vector2<Self>,
    ) -> Result<DyadPosition<Self>, OutOfReach> {
        intersect_circles(triangle, d)
    }

    /// A result that wraps is at least 2 long: 8 less twice 2.75 less 1/2.
    #[inline(always)]
    fn span(place: Self, base: Self, arm: Self) -> Self {
        Self(place.0.wrapping_sub(base.0).wrapping_add(arm.0))
    }

    #[inline(always)]
    fn within_reach_range(place: Self) -> bool {
        const FARTHEST: i32 = 11 << (FRACTION - 2);
        place.0 >= -FARTHEST && place.0 <= FARTHEST
    }
}

/// The two lengths are below 2 together.
#[inline(always)]
fn intersect_circles(
    triangle: &Triangle<Fixed>,
    d: Vector2<Fixed>,
) -> Result<DyadPosition<Fixed>, OutOfReach> {
    let square = |raw: i32| signed(raw, raw) as u64;
    let x = square(d.x.0) + square(d.y.0);
    // d^2 is at most 32, 2^63 here. A span that wraps is out of reach either way.
    let excess = (x as i64).wrapping_sub(triangle.folded_sq.0);
    let twice_dot = excess.wrapping_sub(triangle.twice_product.0);
    let missing = triangle.twice_product.0.wrapping_sub(twice_dot);
    if missing <= 0 || excess <= 0 {
        return Err(if missing == 0 || excess == 0 {
            OutOfReach::Singular
        } else {
            OutOfReach::Unreachable
        });
    }

    // 4 S^2 = u v = z 2^(12 - 2 half) with 1/4 <= z < 1, z in 2^-32.
    let (u, u_shift) = normalised(missing as u64);
    let (v, v_shift) = normalised(excess as u64);
    let product = (unsigned(u, v) >> 32) as u32;
    let shift = u_shift + v_shift;
    let (z, half) = match (shift & 1, product >> 31) {
        (0, _) => (product, shift >> 1),
        (_, 0) => (product << 1, (shift + 1) >> 1),
        _ => (product >> 1, shift >> 1),
    };
    // Beyond it S is not half a unit.
    if half > 32 {
        return Err(OutOfReach::Singular);
    }
    // 1/sqrt(z) in 2^-30, sqrt(z) in 2^-31; S = sqrt(z) 2^(5 - half), half at least 4.
    let inverse = inverse_root(z);
    let root = (unsigned(z, inverse as u32) >> 31) as u32;
    let area = ((root >> (half.wrapping_sub(4) & 31)) as i32 + 1) >> 1;

    // x = w 2^(6 - 2 j - odd) with 1/2 <= w < 1, w in 2^-32. d takes j - 1 bits, k and S j + 1 of
    // those that 2^-58 has and 2^-29 has not.
    let (w, w_shift) = normalised(x);
    let (j, odd) = ((w_shift >> 1) & 31, w_shift & 1);
    let two_k = excess.wrapping_sub(triangle.twice_shortfall.0) as u64;
    let k = joined((two_k >> 32) as u32, two_k as u32, j) as i32;
    let s = (root >> (half.saturating_sub(j + 1) & 31)) as i32;
    let up = j.wrapping_sub(1) & 31;
    let (dx, dy) = (d.x.0 << up, d.y.0 << up);

    let right = triangle.half_side.0 > 0;
    let (s, cross, significand) = if right {
        (-s, area, inverse)
    } else {
        (s, -area, -inverse)
    };
    let inverse_sq = reciprocal(w);
    let along = signed_high(k, inverse_sq) << odd;
    let across = signed_high(opaque(s), inverse_sq) << odd;
    let r1 = Vector2::new(
        rounded::<30>(signed(along, dx) - signed(across, dy)),
        rounded::<30>(signed(along, dy) + signed(across, dx)),
    );
    Ok(DyadPosition {
        r1: r1.map(Fixed),
        // Not longer than the second length: it fits.
        r2: Vector2::new(
            Fixed(d.x.0.wrapping_sub(r1.x)),
            Fixed(d.y.0.wrapping_sub(r1.y)),
        ),
        r1_cross_r2: Fixed(cross),
        inverse_cross: Factor {
            significand,
            // The mask changes nothing, but tells the compiler that the shift is a near one.
            shift: 33u32.wrapping_sub(half) as i32 & 31,
        },
        r1_dot_r2: Fixed(rounded::<30>(twice_dot)),
    })
}
