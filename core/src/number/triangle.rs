//! The third corner of a triangle whose sides are given in length and one of them in place.
//!
//! With d the side in place, x = d^2, l1 and l2 the other two and sigma the side of d that the
//! corner lies on (+1 for the left):
//!
//! ```text
//! k   = (x + l1^2 - l2^2) / 2
//! S^2 = ((l1 + l2)^2 - x) (x - (l1 - l2)^2) / 4            twice the area, squared
//! r1  = (k d + sigma S E d) / x                             from the start of d to the corner
//! r1 x r2 = -sigma S,  r2 = d - r1
//! ```
//!
//! S^2 is formed from its factors: near a flat triangle the expanded form x l1^2 - k^2 loses every
//! digit. It belongs to the number floor because it is where the number types differ: a division
//! and a root for floats, exponents of their own for x, k and S in fixed point.

use super::{Number, dot};
use nalgebra::Vector2;

/// Coefficients of a triangle, built from the two lengths and the side of the corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Triangle<N: Number> {
    /// (l1 + l2)^2
    pub stretched_sq: N::Sum,
    /// (l1 - l2)^2
    pub folded_sq: N::Sum,
    /// l1^2 - l2^2
    pub difference_of_squares: N::Sum,
    /// sigma
    pub branch: N,
}

/// The corner and what comes with it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Apex<N: Number> {
    /// From the start of d to the corner.
    pub r1: Vector2<N>,
    /// From the corner to the end of d.
    pub r2: Vector2<N>,
    /// r1 x r2 = -sigma S: zero where the triangle is flat, at most l1 l2 in size.
    pub r1_cross_r2: N,
    /// 1 / (r1 x r2).
    pub inverse_cross: N::Factor,
    /// d^2.
    pub base_sq: N,
}

/// The sides do not make a triangle. In a dyad: the end joints are too far apart or too close, or
/// exactly so far that the two links lie on one line, where the inner joint has no defined
/// velocity.
///
/// As wide as a number: behind a narrower error the compiler copies the corner, in a [`Result`] that
/// is not taken apart in registers, from odd addresses, byte by byte.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u32)]
pub enum OutOfReach {
    /// d > l1 + l2 or d < |l1 - l2|.
    Unreachable,
    /// d = l1 + l2 or d = |l1 - l2|: stretched or folded, a serial singularity.
    Singular,
}

impl<N: Number> Triangle<N> {
    /// The triangle with the lengths `l1` at the start of d and `l2` at its end, both positive,
    /// whose corner lies to the left of d for `branch` = +1, to the right for -1.
    pub fn new(l1: f64, l2: f64, branch: f64) -> Self {
        Self {
            stretched_sq: N::sum_from_f64((l1 + l2) * (l1 + l2)),
            folded_sq: N::sum_from_f64((l1 - l2) * (l1 - l2)),
            difference_of_squares: N::sum_from_f64((l1 - l2) * (l1 + l2)),
            branch: N::from_f64(branch),
        }
    }

    /// The shortest and the longest d.
    pub fn reach(&self) -> (N, N) {
        let root = |square| N::round(square).sqrt();
        (root(self.folded_sq), root(self.stretched_sq))
    }
}

/// The corner by one root and two divisions, for the floats.
#[inline(always)]
pub fn apex_by_division<N>(triangle: &Triangle<N>, d: Vector2<N>) -> Result<Apex<N>, OutOfReach>
where
    N: Number<Sum = N, Factor = N>,
{
    let base_sq = dot(d, d);
    let four_s_sq = (triangle.stretched_sq - base_sq) * (base_sq - triangle.folded_sq);
    if !(four_s_sq > N::ZERO) {
        return Err(if four_s_sq == N::ZERO {
            OutOfReach::Singular
        } else {
            OutOfReach::Unreachable
        });
    }
    let two_sigma_s = triangle.branch * four_s_sq.sqrt();
    let two_k = base_sq + triangle.difference_of_squares;
    // 1 / (2 d^2): the halves of k and S are taken here, once.
    let half_inverse = N::HALF.div(base_sq);
    let along = two_k * half_inverse;
    let across = two_sigma_s * half_inverse;
    let r1 = Vector2::new(
        N::ab_minus_cd(along, d.x, across, d.y),
        N::ab_plus_cd(along, d.y, across, d.x),
    );
    Ok(Apex {
        r1,
        r2: d - r1,
        r1_cross_r2: -(N::HALF * two_sigma_s),
        inverse_cross: (-(N::ONE + N::ONE)).div(two_sigma_s),
        base_sq,
    })
}
