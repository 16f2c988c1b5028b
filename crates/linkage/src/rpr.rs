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
use super::motion::{DyadMotion, LinkMotion, PointMotion, SlideMotion, turned, unit};
use nalgebra::Vector2;
use trirrr_core::number::{Number, cross, dot};

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

/// Configuration of an RPR dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RprPosition<N> {
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

impl<N: Number> Rpr<N> {
    /// The dyad with arms `z1` at A and `z3` at B, the angles `beta` and `alpha` (rad) between the
    /// arms and the guide, and the sign of s as `branch`.
    pub fn new(z1: f64, beta: f64, z3: f64, alpha: f64, branch: f64) -> Self {
        let (first, second) = (unit(beta) * z1, unit(alpha) * z3);
        Self::from_offsets(first.x + second.x, first.y - second.y, branch)
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
    pub fn position(&self, d: Vector2<N>) -> Result<RprPosition<N>, LinkageStatus> {
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
        Ok(RprPosition {
            direction: turned(d, toward),
            length: s - self.along,
            along: s,
            distance: distance_sq.sqrt(),
            inverse: N::ONE.div(s),
        })
    }

    /// abs(s) / abs(d): 0 where the dyad is singular, 1 where the guide points from joint to joint.
    #[inline]
    pub fn singularity_distance(&self, at: &RprPosition<N>) -> N {
        at.along.abs().div(at.distance)
    }

    /// Solves position, velocity and acceleration for the motions of A and B.
    ///
    /// The first link has its origin at A, the second at B; the x axes of both lie along the guide.
    /// The slide is z2.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn solve(
        &self,
        a: &PointMotion<N>,
        b: &PointMotion<N>,
    ) -> Result<DyadMotion<N, 1>, LinkageStatus> {
        let d = a.relative_to(b);
        let at = self.position(d.position)?;
        let u = at.direction;
        let rate = cross(u, d.velocity) * at.inverse;
        let slide_rate = dot(u, d.velocity) + rate * self.across;
        let square = rate * rate;
        let coriolis = N::ab_minus_cd(square, self.across, slide_rate + slide_rate, rate);
        let acceleration = (cross(u, d.acceleration) + coriolis) * at.inverse;
        let carried = N::ab_plus_cd(acceleration, self.across, square, at.along);
        let first = LinkMotion {
            origin: *a,
            direction: u,
            rate,
            acceleration,
        };
        DyadMotion {
            first,
            second: first.with_origin(*b),
            slides: [SlideMotion {
                length: at.length,
                rate: slide_rate,
                acceleration: dot(u, d.acceleration) + carried,
            }],
            singularity_distance: self.singularity_distance(&at),
        }
        .finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{assert_alike, moving};
    use core::f64::consts::PI;
    use trirrr_core::number::Arithmetic;

    #[test]
    fn closes_as_its_definition_says_on_both_branches() {
        let (z1, beta, z3, alpha) = (0.2, 1.3, 0.15, 0.7);
        let (a, b) = (Vector2::new(0.1, 0.6), Vector2::new(-0.3, -0.1));
        for branch in [1.0, -1.0] {
            let dyad = Rpr::<f64>::new(z1, beta, z3, alpha, branch);
            let at = dyad.position(a - b).unwrap();
            let phi2 = <f64 as Arithmetic>::atan2(at.direction.y, at.direction.x);
            let (phi1, phi3) = (phi2 - PI + beta, phi2 - alpha);
            let left = unit(phi1) * z1 - unit(phi2) * at.length - unit(phi3) * z3;
            assert!((left - (b - a)).abs().max() < 4e-16, "{left:?}");
            assert!(at.along * branch > 0.0);
        }
    }

    /// A crank of 0.1 m at 60 degrees, turning at 2 and -3 / s^2, carries A; B lies at 0.4 m; at
    /// B an arm of 0.17 m at 84 degrees. The values are those of the closure's worked example.
    #[test]
    fn solves_the_worked_example() {
        let dyad = Rpr::<f64>::new(0.0, 0.0, 0.17, 84.0 * (PI / 180.0), 1.0);
        let a = PointMotion::fixed(Vector2::new(0.0, 0.0)).carried(unit(PI / 3.0) * 0.1, 2.0, -3.0);
        let b = PointMotion::fixed(Vector2::new(0.4, 0.0));
        let at = dyad.solve(&a, &b).unwrap();
        // The example counts its angle along A -> B, the dyad along B -> A.
        let phi2 = <f64 as Arithmetic>::atan2(-at.first.direction.y, -at.first.direction.x);
        for (found, true_value) in [
            (phi2, 0.245_494_981_327_606_6),
            (at.slides[0].length, 0.300_688_584_228_405_1),
            (at.first.rate, -0.436_781_884_911_654_4),
            (at.slides[0].rate, 0.217_554_403_659_960_26),
            (at.first.acceleration, 2.053_187_283_912_183),
            (at.slides[0].acceleration, -0.223_743_389_602_775_4),
        ] {
            assert!(
                (found - true_value).abs() < 1e-15,
                "{found} for {true_value}"
            );
        }
    }

    #[test]
    fn both_links_meet_in_the_slide() {
        let dyad = Rpr::<f64>::from_offsets(0.1, -0.25, -1.0);
        let (a, b) = (moving(0.7), moving(-0.4));
        let at = dyad.solve(&a, &b).unwrap();
        // A slides along the guide of B's link.
        let slide = SlideMotion {
            length: at.slides[0].length + 0.1,
            ..at.slides[0]
        };
        assert_alike(&at.second.sliding(&slide, -0.25), &a, 4e-16);
    }

    #[test]
    fn without_offsets_it_points_from_joint_to_joint() {
        for branch in [1.0, -1.0] {
            let dyad = Rpr::<f32>::new(0.0, 0.3, 0.0, 0.4, branch);
            let at = dyad.position(Vector2::new(3.0, 4.0)).unwrap();
            let branch = branch as f32;
            assert_eq!(at.length, 5.0 * branch);
            assert!((at.direction - Vector2::new(0.6, 0.8) * branch).abs().max() < 1e-7);
            assert_eq!(dyad.singularity_distance(&at), 1.0);
            let coinciding = dyad.position(Vector2::new(0.0, 0.0)).map(|at| at.length);
            assert_eq!(coinciding, Err(LinkageStatus::Singular));
        }
    }

    #[test]
    fn says_what_is_out_of_reach() {
        let dyad = Rpr::<f32>::from_offsets(0.0, 2.0, 1.0);
        let reach = |x: f32| {
            let at = dyad.position(Vector2::new(x, 0.0))?;
            Ok(dyad.singularity_distance(&at))
        };
        assert_eq!(reach(2.0), Err(LinkageStatus::Singular));
        assert_eq!(reach(1.9), Err(LinkageStatus::Unreachable));
        assert_eq!(reach(f32::NAN), Err(LinkageStatus::Unreachable));
        assert!(reach(2.000_001).unwrap() < 2e-3);
        assert!(reach(2000.0).unwrap() > 0.999);
        let origin = PointMotion::fixed(Vector2::new(0.0, 0.0));
        let far = PointMotion::fixed(Vector2::new(f32::MAX, 0.0));
        assert_eq!(dyad.solve(&far, &origin), Err(LinkageStatus::OutOfRange));
    }
}
