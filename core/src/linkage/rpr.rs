//! The RPR dyad: a link that turns about A and one that turns about B, one sliding along the
//! other. A and B are known.
//!
//! From A an arm z1 leads to the guide, from B an arm z3; between the arms' ends lies the length
//! z2 along the guide, whose direction is phi2. The arms stand at fixed angles to it:
//!
//! ```text
//! z1 e^(i phi1) - z2 e^(i phi2) - z3 e^(i phi3) = B - A,  phi1 = phi2 - pi + beta,
//!                                                         phi3 = phi2 - alpha
//! ```
//!
//! In the frame of the guide, u = e^(i phi2), the vector B -> A has a constant component across
//! it, however far the slide is:
//!
//! ```text
//! d = A - B = s u + o E u,   s = z2 + z1 cos beta + z3 cos alpha
//!                            o =      z1 sin beta - z3 sin alpha
//! s = sigma sqrt(d^2 - o^2),   u = (s d - o E d) / d^2
//! ```
//!
//! The branch sigma is the sign of s: +1 when the guide points from B towards A. With d's
//! velocity v and acceleration a, w and e the guide's angular velocity and acceleration:
//!
//! ```text
//! w = u x v / s                              s' = u . v + w o
//! e = (u x a - 2 s' w + w^2 o) / s           s'' = u . a + e o + w^2 s
//! ```
//!
//! Without arms, or with arms along the guide, o = 0: the guide passes through both joints. It is
//! singular at s = 0, where A and B are as close as the arms allow: the scale-free distance is
//! abs(s) / abs(d), 1 throughout for a dyad with o = 0 (singular only where A and B coincide).

use super::LinkageStatus;
use super::motion::{LinkMotion, PointMotion, SlideMotion, turned};
use crate::number::{Number, cross, dot};
use nalgebra::Vector2;

/// Coefficients of an RPR dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rpr<N> {
    /// z1 cos beta + z3 cos alpha
    along: N,
    /// o = z1 sin beta - z3 sin alpha
    across: N,
    /// o^2
    across_sq: N,
    /// sigma
    branch: N,
}

/// A dyad's configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position<N> {
    /// u: direction of the guide, a unit vector.
    pub direction: Vector2<N>,
    /// z2: from the end of B's arm to the end of A's arm along the guide.
    pub length: N,
    /// s: from B to A along the guide; zero at the singularity.
    pub along: N,
    /// abs(d): from B to A.
    pub distance: N,
    /// 1 / s.
    inverse: N,
}

/// Rates of the angle and of the slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<N> {
    /// Angular velocity of both links, positive counter-clockwise.
    pub turn: N,
    /// Rate of z2.
    pub slide: N,
}

/// Accelerations of the angle and of the slide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerations<N> {
    /// Angular acceleration of both links, positive counter-clockwise.
    pub turn: N,
    /// Second derivative of z2.
    pub slide: N,
}

/// What the dyad does for a motion of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// The link about A; its frame has its origin at A and its x axis along the guide.
    pub first: LinkMotion<N>,
    /// The link about B; origin at B, x axis along the guide.
    pub second: LinkMotion<N>,
    /// z2.
    pub slide: SlideMotion<N>,
    /// Distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> Rpr<N> {
    /// The dyad with arms `z1` at A and `z3` at B, the angles `beta` and `alpha` (rad) between the
    /// arms and the guide, and the sign of s as `branch`.
    pub fn new(z1: f64, beta: f64, z3: f64, alpha: f64, branch: f64) -> Self {
        let (sin_beta, cos_beta) = <f64 as Number>::sin_cos(beta);
        let (sin_alpha, cos_alpha) = <f64 as Number>::sin_cos(alpha);
        Self::from_offsets(
            z1 * cos_beta + z3 * cos_alpha,
            z1 * sin_beta - z3 * sin_alpha,
            branch,
        )
    }

    /// The dyad whose z2 is shorter by `along` than the way from B to A along the guide, and in
    /// which A lies by `across` to the left of the parallel to the guide through B.
    pub fn from_offsets(along: f64, across: f64, branch: f64) -> Self {
        Self {
            along: N::from_f64(along),
            across: N::from_f64(across),
            across_sq: N::from_f64(across * across),
            branch: N::from_f64(branch),
        }
    }

    /// The configuration for `d`, the vector B -> A.
    #[inline]
    pub fn position(&self, d: Vector2<N>) -> Result<Position<N>, LinkageStatus> {
        let distance_sq = dot(d, d);
        let s_sq = distance_sq - self.across_sq;
        if !(s_sq > N::ZERO) {
            return Err(if s_sq == N::ZERO {
                LinkageStatus::Singular
            } else {
                LinkageStatus::Unreachable
            });
        }
        let s = self.branch * s_sq.sqrt();
        let inverse_sq = N::ONE.div(distance_sq);
        let toward = Vector2::new(s * inverse_sq, -(self.across * inverse_sq));
        Ok(Position {
            direction: turned(d, toward),
            length: s - self.along,
            along: s,
            distance: distance_sq.sqrt(),
            inverse: N::ONE.div(s),
        })
    }

    /// Rates for `v`, the velocity of A relative to B.
    #[inline]
    pub fn rates(&self, at: &Position<N>, v: Vector2<N>) -> Rates<N> {
        let turn = cross(at.direction, v) * at.inverse;
        Rates {
            turn,
            slide: dot(at.direction, v) + turn * self.across,
        }
    }

    /// Accelerations for `a`, the acceleration of A relative to B.
    #[inline]
    pub fn accelerations(
        &self,
        at: &Position<N>,
        rates: &Rates<N>,
        a: Vector2<N>,
    ) -> Accelerations<N> {
        let square = rates.turn * rates.turn;
        let coriolis = N::ab_minus_cd(square, self.across, rates.slide + rates.slide, rates.turn);
        let turn = (cross(at.direction, a) + coriolis) * at.inverse;
        Accelerations {
            turn,
            slide: dot(at.direction, a) + N::ab_plus_cd(turn, self.across, square, at.along),
        }
    }

    /// abs(s) / abs(d): 0 where the dyad is singular, 1 where the guide points from joint to joint.
    #[inline]
    pub fn singularity_distance(&self, at: &Position<N>) -> N {
        at.along.abs().div(at.distance)
    }

    /// All of it for the motions of A and B.
    ///
    /// # Errors
    /// [`LinkageStatus`]; what is returned is finite.
    pub fn solve(
        &self,
        a: &PointMotion<N>,
        b: &PointMotion<N>,
    ) -> Result<Motion<N>, LinkageStatus> {
        let d = a.relative_to(b);
        let at = self.position(d.position)?;
        let rates = self.rates(&at, d.velocity);
        let acc = self.accelerations(&at, &rates, d.acceleration);
        let link = |origin: &PointMotion<N>| LinkMotion {
            origin: *origin,
            direction: at.direction,
            rate: rates.turn,
            acceleration: acc.turn,
        };
        let motion = Motion {
            first: link(a),
            second: link(b),
            slide: SlideMotion {
                length: at.length,
                rate: rates.slide,
                acceleration: acc.slide,
            },
            singularity_distance: self.singularity_distance(&at),
        };
        let finite = motion.first.is_finite()
            && motion.second.is_finite()
            && motion.slide.is_finite()
            && motion.singularity_distance.is_finite();
        finite.then_some(motion).ok_or(LinkageStatus::OutOfRange)
    }
}
