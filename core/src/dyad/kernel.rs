//! The inner joint of a dyad: the intersection of two circles about the end joints.
//!
//! With d = A -> C, x = d^2, l1 and l2 the radii and sigma the side of d that the inner joint B lies
//! on (+1 for the left):
//!
//! ```text
//! y       = x - (l1 - l2)^2                             0 folded, 4 l1 l2 stretched
//! 4 S^2   = y (4 l1 l2 - y)                             S: twice the area of A B C
//! 2 k     = y - 2 l1 (l2 - l1)                          k = d . r1
//! r1      = (k d + sigma S E d) / x                     A -> B
//! r1 x r2 = -sigma S,  r2 = d - r1
//! r1 . r2 = y / 2 - l1 l2
//! ```
//!
//! S^2 is formed from its factors: near a flat triangle the expanded form x l1^2 - k^2 loses every
//! digit. All follow from y, whose error is one of d; the other constants have the size of l1 l2 or
//! l1 (l2 - l1). So a short link at A loses no digits beside a long one at C. A short link at C keeps
//! the absolute error of the long one at A.

use crate::arithmetic::{RoundsEachStep, WideArithmetic, cross, dot};
use crate::to_source;
use nalgebra::Vector2;

/// The part of the dyad that depends on the number type: a division and a root for floats,
/// exponents of their own for x, k and S in fixed point.
pub trait DyadKernel: WideArithmetic {
    /// Intersects the circle of radius l1 about the start of `d` with the circle of radius l2 about
    /// its end, on the side of `d` that `triangle` names.
    ///
    /// # Errors
    /// [`OutOfReach`].
    fn intersect_circles(
        triangle: &Triangle<Self>,
        d: Vector2<Self>,
    ) -> Result<DyadPosition<Self>, OutOfReach>;

    /// As [`intersect_circles`](Self::intersect_circles), for callers that look at their results. A type that
    /// [propagates](crate::number::Arithmetic::PROPAGATES_NON_FINITE) what is not finite does not check: a
    /// position out of reach then has an `inverse_cross` that is not finite.
    #[inline(always)]
    fn intersect_circles_unchecked(
        triangle: &Triangle<Self>,
        d: Vector2<Self>,
    ) -> Result<DyadPosition<Self>, OutOfReach> {
        Self::intersect_circles(triangle, d)
    }

    /// Two sums over r1 x r2, by the [inverse](DyadPosition::inverse_cross) of a position.
    #[inline(always)]
    fn over_cross(sums: [Self::Sum; 2], inverse_cross: Self::Factor) -> [Self; 2] {
        Self::round_scaled_pair(sums, inverse_cross)
    }

    /// (place - base) + arm. The two places are exact inputs and are subtracted first, so that a
    /// large common offset cancels before any rounding. The arm is at most 1/2 long where values
    /// have to be [in range](crate::number::Arithmetic::in_range).
    #[inline(always)]
    fn span(place: Self, base: Self, arm: Self) -> Self {
        (place - base) + arm
    }

    /// `true` if a [`span`](Self::span) from any other such place is right, or longer than any leg.
    #[inline(always)]
    fn within_reach_range(_place: Self) -> bool {
        true
    }

    /// `arm`, as in a [`span`](Self::span), turned by the angle of this sine and cosine.
    #[inline(always)]
    fn turn_arm(arm: Vector2<Self>, sin: Self, cos: Self) -> Vector2<Self> {
        Vector2::new(
            Self::ab_minus_cd(arm.x, cos, arm.y, sin),
            Self::ab_plus_cd(arm.y, cos, arm.x, sin),
        )
    }

    /// `to` - `from`, two arms as in a [`span`](Self::span).
    #[inline(always)]
    fn arm_between(from: Vector2<Self>, to: Vector2<Self>) -> Vector2<Self> {
        Vector2::new(to.x - from.x, to.y - from.y)
    }

    /// a x b of links, or of a link and the difference of two arms.
    #[inline(always)]
    fn cross_links(a: Vector2<Self>, b: Vector2<Self>) -> Self {
        cross(a, b)
    }

    /// `v` + `rate` E `arm`: velocity of the end of an `arm`, as in a [`span`](Self::span). Both
    /// operands have to be in range.
    #[inline(always)]
    fn arm_velocity(v: Vector2<Self>, rate: Self, arm: Vector2<Self>) -> Vector2<Self> {
        Vector2::new(
            Self::round(v.x.widen() + Self::product(-arm.y, rate)),
            Self::round(v.y.widen() + Self::product(arm.x, rate)),
        )
    }

    /// `a` + `angular` E `arm` - `rate_sq` `arm`: acceleration of the end of an `arm`, as in a
    /// [`span`](Self::span). All operands have to be in range.
    #[inline(always)]
    fn arm_acceleration(
        a: Vector2<Self>,
        angular: Self,
        rate_sq: Self,
        arm: Vector2<Self>,
    ) -> Vector2<Self> {
        let part = |a: Self, across: Self, along: Self| {
            Self::round(a.widen() + Self::sum_ab_minus_cd(across, angular, along, rate_sq))
        };
        Vector2::new(part(a.x, -arm.y, arm.x), part(a.y, arm.x, arm.y))
    }
}

/// Coefficients of the triangle A B C, built from two lengths and the side of B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<N: WideArithmetic> {
    /// (l1 - l2)^2
    pub(super) folded_sq: N::Sum,
    /// 2 l1 l2
    pub(super) twice_product: N::Sum,
    /// 2 l1 (l2 - l1)
    pub(super) twice_shortfall: N::Sum,
    /// -sigma / 2
    pub(super) half_side: N,
}

to_source!([N: WideArithmetic] Triangle [N] in trirrr_core::dyad {
    folded_sq: N::Sum,
    twice_product: N::Sum,
    twice_shortfall: N::Sum,
    half_side: N,
});

/// Configuration of a dyad: its inner joint, and the quantities that the later stages reuse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DyadPosition<N: WideArithmetic> {
    /// From A to the inner joint B.
    pub r1: Vector2<N>,
    /// From the inner joint B to C.
    pub r2: Vector2<N>,
    /// r1 x r2 = -sigma S: zero where the triangle is flat, at most l1 l2 in size.
    pub r1_cross_r2: N,
    /// 1 / (r1 x r2).
    pub inverse_cross: N::Factor,
    /// r1 . r2 = l1 l2 cos(theta2 - theta1).
    pub r1_dot_r2: N,
}

/// Refusal of two circles that do not cross: the end joints are too far apart or too close, or the
/// circles touch. The two links then lie on one line, where B has no defined velocity.
///
/// As wide as a number: behind a narrower error the compiler copies the position, in a [`Result`]
/// that is not taken apart in registers, from odd addresses, byte by byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum OutOfReach {
    /// d > l1 + l2 or d < |l1 - l2|.
    Unreachable,
    /// d = l1 + l2 or d = |l1 - l2|: stretched or folded, a serial singularity.
    Singular,
}

impl<N: WideArithmetic> Triangle<N> {
    /// The triangle with the lengths `l1` at the start of d and `l2` at its end, both positive,
    /// whose corner B lies to the left of d for `branch` = +1, to the right for -1.
    pub fn new(l1: f64, l2: f64, branch: f64) -> Self {
        Self {
            folded_sq: N::sum_from_f64((l1 - l2) * (l1 - l2)),
            twice_product: N::sum_from_f64(2.0 * (l1 * l2)),
            twice_shortfall: N::sum_from_f64(2.0 * l1 * (l2 - l1)),
            half_side: N::from_f64(-0.5 * branch),
        }
    }

    /// The shortest and the longest d.
    pub fn reach(&self) -> (N, N) {
        let root = |square| N::round(square).sqrt();
        (
            root(self.folded_sq),
            root(self.folded_sq + self.twice_product + self.twice_product),
        )
    }
}

impl<N: RoundsEachStep> DyadKernel for N {
    #[inline(always)]
    fn intersect_circles(
        triangle: &Triangle<N>,
        d: Vector2<N>,
    ) -> Result<DyadPosition<N>, OutOfReach> {
        let squares = Squares::of(triangle, d);
        let four_s_sq = squares.four_s_sq;
        // Not a number compares as false and is refused as well.
        if four_s_sq > N::ZERO {
            Ok(squares.intersect(triangle, d))
        } else if four_s_sq == N::ZERO {
            Err(OutOfReach::Singular)
        } else {
            Err(OutOfReach::Unreachable)
        }
    }

    /// 1 / 0 and the root of a negative number are not finite, and `inverse_cross` is a multiple of them.
    #[inline(always)]
    fn intersect_circles_unchecked(
        triangle: &Triangle<N>,
        d: Vector2<N>,
    ) -> Result<DyadPosition<N>, OutOfReach> {
        Ok(Squares::of(triangle, d).intersect(triangle, d))
    }
}

/// Squares of a triangle's lengths, of which the rest is made.
struct Squares<N> {
    /// x
    base_sq: N,
    /// y
    excess: N,
    /// y - 2 l1 l2
    twice_dot: N,
    four_s_sq: N,
}

impl<N: RoundsEachStep> Squares<N> {
    #[inline(always)]
    fn of(triangle: &Triangle<N>, d: Vector2<N>) -> Self {
        let base_sq = dot(d, d);
        let excess = base_sq - triangle.folded_sq;
        let twice_dot = excess - triangle.twice_product;
        Self {
            base_sq,
            excess,
            twice_dot,
            four_s_sq: excess * (triangle.twice_product - twice_dot),
        }
    }

    /// By one root and one division.
    #[inline(always)]
    fn intersect(&self, triangle: &Triangle<N>, d: Vector2<N>) -> DyadPosition<N> {
        let r1_cross_r2 = triangle.half_side * self.four_s_sq.sqrt();
        let inverse_sq = self.base_sq.reciprocal();
        let along = N::HALF * (self.excess - triangle.twice_shortfall) * inverse_sq;
        let across = r1_cross_r2 * inverse_sq;
        let r1 = Vector2::new(
            N::ab_plus_cd(along, d.x, across, d.y),
            N::ab_minus_cd(along, d.y, across, d.x),
        );
        DyadPosition {
            r1,
            r2: Vector2::new(d.x - r1.x, d.y - r1.y),
            r1_cross_r2,
            inverse_cross: r1_cross_r2.reciprocal(),
            r1_dot_r2: N::HALF * self.twice_dot,
        }
    }
}
