//! The dyad's kernel in fixed point.
//!
//! d^2 and what is compared with it are held in 2^-58, exactly. Near a fold d, k and S are small
//! together, and the inner joint is a ratio of them. They are shifted left as far as d allows before
//! they are rounded, so that the joint is as accurate as d is.

use super::kernel::{DyadKernel, DyadPosition, OutOfReach, Triangle};
use crate::arithmetic::fixed::factor::low_quotient;
use crate::arithmetic::fixed::product::{
    joined, normalised, normalised_high, opaque, rounded, signed, signed_high, unsigned,
};
use crate::arithmetic::fixed::reciprocal::reciprocal;
use crate::arithmetic::fixed::root::inverse_root;
use crate::arithmetic::fixed::{FRACTION, Factor, Sum};
use crate::arithmetic::{Fixed, sum_cross};
use nalgebra::Vector2;

impl DyadKernel for Fixed {
    #[inline(always)]
    fn intersect_circles(
        triangle: &Triangle<Self>,
        d: Vector2<Self>,
    ) -> Result<DyadPosition<Self>, OutOfReach> {
        intersect_circles(triangle, d)
    }

    #[inline(always)]
    fn over_cross(sums: [Sum; 2], inverse_cross: Factor) -> [Self; 2] {
        let [first, second] = sums;
        let shift = inverse_cross.shift as u32 & 31;
        // The shift is not 0. What fits is, with half of what a shifted high word holds, not negative
        // and below all of it.
        let half = (1 << shift) >> 1;
        let above = |sum: Sum| ((sum.0 >> 32) as u32).wrapping_add(half);
        if (above(first) | above(second)) >> shift != 0 {
            return inverse_cross.times_pair_far(first.0, second.0).map(Self);
        }
        let quotient = |sum: Sum| Self(inverse_cross.times_shifted(low_quotient(sum.0, shift)));
        [quotient(first), quotient(second)]
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

    #[inline(always)]
    fn turn_arm(arm: Vector2<Self>, sin: Self, cos: Self) -> Vector2<Self> {
        let (arm, sin, cos) = (in_31_bits(arm), sin.0 << 1, cos.0 << 1);
        Vector2::new(
            Self(with_products(
                0,
                [(arm.x, cos), (arm.y, sin.wrapping_neg())],
            )),
            Self(with_products(0, [(arm.y, cos), (arm.x, sin)])),
        )
    }

    #[inline(always)]
    fn arm_between(from: Vector2<Self>, to: Vector2<Self>) -> Vector2<Self> {
        to.zip_map(&from, |to, from| Self(to.0.wrapping_sub(from.0)))
    }

    /// Links are shorter than 2, and a difference of arms is hardly longer than 1: it fits.
    #[inline(always)]
    fn cross_links(a: Vector2<Self>, b: Vector2<Self>) -> Self {
        Self(rounded::<FRACTION>(sum_cross(a, b).0))
    }

    #[inline(always)]
    fn arm_velocity(v: Vector2<Self>, rate: Self, arm: Vector2<Self>) -> Vector2<Self> {
        let (arm, rate) = (in_31_bits(arm), rate.0 << 1);
        Vector2::new(
            Self(with_products(v.x.0, [(arm.y.wrapping_neg(), rate)])),
            Self(with_products(v.y.0, [(arm.x, rate)])),
        )
    }

    #[inline(always)]
    fn arm_acceleration(
        a: Vector2<Self>,
        angular: Self,
        rate_sq: Self,
        arm: Vector2<Self>,
    ) -> Vector2<Self> {
        let (arm, angular) = (in_31_bits(arm), angular.0 << 1);
        let (back, inwards) = (
            arm.y.wrapping_neg(),
            opaque((rate_sq.0 << 1).wrapping_neg()),
        );
        let (x, y) = (
            [(back, angular), (arm.x, inwards)],
            [(arm.x, angular), (arm.y, inwards)],
        );
        Vector2::new(Self(with_products(a.x.0, x)), Self(with_products(a.y.0, y)))
    }
}

/// An arm in 2^-31. It is at most 1/2 long.
#[inline(always)]
fn in_31_bits(arm: Vector2<Fixed>) -> Vector2<i32> {
    arm.map(|part| part.0 << 2)
}

/// `start` in 2^-29 and products of factors in 2^-31 and 2^-30, rounded once: the high word.
#[inline(always)]
fn with_products<const COUNT: usize>(start: i32, products: [(i32, i32); COUNT]) -> i32 {
    let sum = products
        .into_iter()
        .fold(0i64, |sum, (a, b)| sum.wrapping_add(signed(a, b)));
    let carry = (sum as u32 >> 31) as i32;
    ((sum >> 32) as i32).wrapping_add(carry).wrapping_add(start)
}

/// The square of the distance, its excess over the folded one and its gap to the stretched one, each
/// [`normalised`].
struct Sizes {
    missing: (u32, u32),
    excess: (u32, u32),
    base_sq: (u32, u32),
}

impl Sizes {
    /// For a leg that is nearly folded or stretched, or out of reach.
    #[cold]
    #[inline(never)]
    fn near_edge(missing: i64, excess: i64, base_sq: u64) -> Result<Self, OutOfReach> {
        if missing <= 0 || excess <= 0 {
            return Err(if missing == 0 || excess == 0 {
                OutOfReach::Singular
            } else {
                OutOfReach::Unreachable
            });
        }
        let (missing, excess) = (normalised(missing as u64), normalised(excess as u64));
        // Beyond it S is not half a unit.
        let shift = missing.1 + excess.1;
        if shift > 65 || (shift == 65 && unsigned(missing.0, excess.0) >> 63 == 0) {
            return Err(OutOfReach::Singular);
        }
        Ok(Self {
            missing,
            excess,
            base_sq: normalised(base_sq),
        })
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
    let sizes = if (missing >> 32) as i32 > 0 && (excess >> 32) as i32 > 0 {
        // d^2 is not less than what it exceeds.
        Sizes {
            missing: normalised_high(missing as u64),
            excess: normalised_high(excess as u64),
            base_sq: normalised_high(x),
        }
    } else {
        Sizes::near_edge(missing, excess, x)?
    };
    let ((u, u_shift), (v, v_shift)) = (sizes.missing, sizes.excess);

    // 4 S^2 = u v = z 2^(12 - 2 half) with 1/4 <= z < 1, z in 2^-32.
    let product = (unsigned(u, v) >> 32) as u32;
    let shift = u_shift + v_shift;
    let (z, half) = match (shift & 1, product >> 31) {
        (0, _) => (product, shift >> 1),
        (_, 0) => (product << 1, (shift + 1) >> 1),
        _ => (product >> 1, shift >> 1),
    };
    // 1/sqrt(z) in 2^-30, sqrt(z) in 2^-31; S = sqrt(z) 2^(5 - half), half at least 4.
    let inverse = inverse_root(z);
    let root = (unsigned(z, inverse as u32) >> 31) as u32;
    let area = ((root >> (half.wrapping_sub(4) & 31)) as i32 + 1) >> 1;

    // x = w 2^(6 - 2 j - odd) with 1/2 <= w < 1, w in 2^-32. d takes j - 1 bits, k and S j + 1 of
    // those that 2^-58 has and 2^-29 has not.
    let (w, w_shift) = sizes.base_sq;
    let (j, odd) = ((w_shift >> 1) & 31, w_shift & 1);
    let two_k = excess.wrapping_sub(triangle.twice_shortfall.0) as u64;
    let k = joined((two_k >> 32) as u32, two_k as u32, j) as i32;
    // S is not more than d: half is more than j.
    let s = (root >> (half.wrapping_sub(j + 1) & 31)) as i32;
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

#[cfg(test)]
mod tests;
