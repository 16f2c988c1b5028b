//! The RRR dyad: two links A -> B -> C, revolute joints at A, B and C; the motions of A and C are
//! known, the inner joint B is wanted.
//!
//! A, B and C are the corners of a [`Triangle`] over d = C - A with the branch sigma (the side of
//! A -> C on which B lies, +1 for the left). With S twice its area:
//!
//! ```text
//! r1  = A -> B,   r2  = B -> C = d - r1
//! r1 x r2 = -sigma S
//! ```
//!
//! No angle is needed anywhere; whoever wants one takes the arctangent of r1 or r2. Singular where S = 0; the scale-free distance is S / (l1 l2), the sine
//! of the angle between the links. Both ends may move: the stages take the position, velocity and
//! acceleration of C relative to A, and [`Rrr::solve`] the two motions themselves. Source: thesis (3.2) to (3.21), corrected; the sign of r2 is B -> C.

use super::motion::{LinkMotion, PointMotion};
use super::status::LinkageStatus;
/// A dyad's configuration: its inner joint B is the corner of its triangle.
pub use crate::number::Apex as Position;
pub use crate::number::OutOfReach;
use crate::number::{Number, Triangle, sum_dot};
use nalgebra::Vector2;

/// Coefficients of an RRR dyad, built from its two lengths and its branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrr<N: Number> {
    /// A, B and C.
    pub triangle: Triangle<N>,
    /// l1^2 + l2^2
    pub sum_of_squares: N,
    /// l1
    pub l1: N::Length,
    /// l1^2
    pub l1_sq: N,
    /// l2^2
    pub l2_sq: N,
}

/// Angular velocities of the two links, positive counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates<N> {
    /// Of link A -> B.
    pub proximal: N,
    /// Of link B -> C.
    pub distal: N,
}

/// Angular accelerations of the two links, positive counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Accelerations<N> {
    /// Of link A -> B.
    pub proximal: N,
    /// Of link B -> C.
    pub distal: N,
}

/// What the dyad does for a motion of its ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// The inner joint B.
    pub joint: PointMotion<N>,
    /// The link A -> B; origin at A, x axis towards B.
    pub first: LinkMotion<N>,
    /// The link B -> C; origin at B, x axis towards C.
    pub second: LinkMotion<N>,
    /// Distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> Rrr<N> {
    /// The dyad with lengths `l1` (A -> B) and `l2` (B -> C), both positive, whose inner joint
    /// lies to the left of A -> C for `branch` = +1, to the right for -1.
    pub fn new(l1: f64, l2: f64, branch: f64) -> Self {
        Self {
            triangle: Triangle::new(l1, l2, branch),
            sum_of_squares: N::from_f64(l1 * l1 + l2 * l2),
            l1: N::length_from_f64(l1),
            l1_sq: N::from_f64(l1 * l1),
            l2_sq: N::from_f64(l2 * l2),
        }
    }

    /// The configuration for `d`, the vector A -> C.
    #[inline(always)]
    pub fn position(&self, d: Vector2<N>) -> Result<Position<N>, OutOfReach> {
        N::apex(&self.triangle, d)
    }

    /// Direction of A -> B, counter-clockwise from the x axis, in (-pi, pi].
    #[inline(always)]
    pub fn proximal_angle(&self, at: &Position<N>) -> N::Angle {
        N::direction(at.r1.x, at.r1.y, &self.l1)
    }

    /// r1 . r2 = (d^2 - l1^2 - l2^2) / 2 = l1 l2 cos(theta2 - theta1).
    #[inline(always)]
    pub fn r1_dot_r2(&self, at: &Position<N>) -> N {
        N::half_difference(at.base_sq, self.sum_of_squares)
    }

    /// Link rates for `v`, the velocity of C relative to A: v = E (rate1 r1 + rate2 r2).
    #[inline(always)]
    pub fn rates(&self, at: &Position<N>, v: Vector2<N>) -> Rates<N> {
        Rates {
            proximal: N::round_scaled(sum_dot(at.r2, v), at.inverse_cross),
            distal: -N::round_scaled(sum_dot(at.r1, v), at.inverse_cross),
        }
    }

    /// Link accelerations for `a`, the acceleration of C relative to A.
    #[inline(always)]
    pub fn accelerations(
        &self,
        at: &Position<N>,
        rates: &Rates<N>,
        a: Vector2<N>,
    ) -> Accelerations<N> {
        // b = a + rate1^2 r1 + rate2^2 r2 is what the angular accelerations have to supply. Its
        // products with r1 and r2 are formed from l1^2, l2^2 and r1.r2, which saves forming b.
        let w1 = rates.proximal * rates.proximal;
        let w2 = rates.distal * rates.distal;
        let r1_dot_r2 = self.r1_dot_r2(at);
        let r2_dot_b = sum_dot(at.r2, a) + N::sum_ab_plus_cd(w1, r1_dot_r2, w2, self.l2_sq);
        let r1_dot_b = sum_dot(at.r1, a) + N::sum_ab_plus_cd(w1, self.l1_sq, w2, r1_dot_r2);
        Accelerations {
            proximal: N::round_scaled(r2_dot_b, at.inverse_cross),
            distal: -N::round_scaled(r1_dot_b, at.inverse_cross),
        }
    }

    /// The least and the greatest distance of the end joints, abs(l1 - l2) and l1 + l2.
    pub fn reach(&self) -> (N, N) {
        self.triangle.reach()
    }

    /// l2. Not among the coefficients: the stages, which the machine's tick consists of, need its
    /// square only.
    #[inline]
    fn l2(&self) -> N {
        self.l2_sq.sqrt()
    }

    /// abs(r1 x r2) / (l1 l2): 0 where the dyad is stretched or folded, 1 where it is at right
    /// angles.
    #[inline]
    pub fn singularity_distance(&self, at: &Position<N>) -> N {
        at.r1_cross_r2.abs().div(N::length(&self.l1) * self.l2())
    }

    /// All of it for the motions of A and C.
    ///
    /// # Errors
    /// [`LinkageStatus`]; what is returned is finite.
    pub fn solve(
        &self,
        a: &PointMotion<N>,
        c: &PointMotion<N>,
    ) -> Result<Motion<N>, LinkageStatus> {
        let d = c.relative_to(a);
        let at = self.position(d.position)?;
        let rates = self.rates(&at, d.velocity);
        let acc = self.accelerations(&at, &rates, d.acceleration);
        let joint = a.carried(at.r1, rates.proximal, acc.proximal);
        let link = |origin, r: Vector2<N>, length, rate, acceleration| LinkMotion {
            origin,
            direction: r * N::ONE.div(length),
            rate,
            acceleration,
        };
        let motion = Motion {
            joint,
            first: link(*a, at.r1, N::length(&self.l1), rates.proximal, acc.proximal),
            second: link(joint, at.r2, self.l2(), rates.distal, acc.distal),
            singularity_distance: self.singularity_distance(&at),
        };
        let finite = motion.first.is_finite()
            && motion.second.is_finite()
            && motion.singularity_distance.is_finite();
        finite.then_some(motion).ok_or(LinkageStatus::OutOfRange)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Links 3 and 4 with their ends 5 apart: right-angled at B.
    #[test]
    fn each_branch_lies_on_its_side() {
        for (branch, side) in [(1.0, 1.0), (-1.0, -1.0)] {
            let dyad = Rrr::<f64>::new(3.0, 4.0, branch);
            let at = dyad.position(Vector2::new(5.0, 0.0)).unwrap();
            let expected = Vector2::new(1.8, side * 2.4);
            assert!((at.r1 - expected).abs().max() < 1e-15, "{:?}", at.r1);
            assert!((at.r1 + at.r2 - Vector2::new(5.0, 0.0)).abs().max() < 1e-15);
            assert!((at.r1_cross_r2 + side * 12.0).abs() < 1e-14);
            assert!(dyad.r1_dot_r2(&at).abs() < 1e-14);
        }
    }

    #[test]
    fn says_what_is_out_of_reach() {
        let dyad = Rrr::<f32>::new(3.0, 4.0, 1.0);
        let solve = |x: f32| dyad.position(Vector2::new(x, 0.0)).map(|at| at.r1);
        assert_eq!(solve(7.0), Err(OutOfReach::Singular));
        assert_eq!(solve(1.0), Err(OutOfReach::Singular));
        assert_eq!(solve(7.0f32.next_up()), Err(OutOfReach::Unreachable));
        assert_eq!(solve(0.5), Err(OutOfReach::Unreachable));
        assert_eq!(solve(0.0), Err(OutOfReach::Unreachable));
        assert_eq!(solve(f32::NAN), Err(OutOfReach::Unreachable));
        assert!(solve(7.0f32.next_down()).is_ok());
    }

    #[test]
    fn rates_and_accelerations_carry_c_as_asked() {
        let dyad = Rrr::<f64>::new(3.0, 4.0, 1.0);
        let at = dyad.position(Vector2::new(5.5, 1.0)).unwrap();
        let (v, a) = (Vector2::new(0.7, -0.3), Vector2::new(-2.0, 5.0));
        let rates = dyad.rates(&at, v);
        let acc = dyad.accelerations(&at, &rates, a);
        // Forwards again, by the velocity and acceleration of a point of a turning body.
        let turned = |r: Vector2<f64>| Vector2::new(-r.y, r.x);
        let v_again = turned(at.r1) * rates.proximal + turned(at.r2) * rates.distal;
        let of_link = |r, w: f64, e: f64| turned(r) * e - r * (w * w);
        let a_again =
            of_link(at.r1, rates.proximal, acc.proximal) + of_link(at.r2, rates.distal, acc.distal);
        assert!((v_again - v).abs().max() < 1e-15, "{v_again:?}");
        assert!((a_again - a).abs().max() < 1e-14, "{a_again:?}");
    }

    #[test]
    fn solve_carries_both_ends() {
        let dyad = Rrr::<f64>::new(3.0, 4.0, -1.0);
        let moving = |x: f64| PointMotion {
            position: Vector2::new(x, 0.3 * x),
            velocity: Vector2::new(0.5, -x),
            acceleration: Vector2::new(x, 2.0),
        };
        let (a, c) = (moving(1.0), moving(6.0));
        let at = dyad.solve(&a, &c).unwrap();
        let joint = at.first.point(Vector2::new(3.0, 0.0));
        let end = at.second.point(Vector2::new(4.0, 0.0));
        for (found, asked) in [(joint, at.joint), (end, c)] {
            assert!((found.position - asked.position).abs().max() < 2e-15);
            assert!((found.velocity - asked.velocity).abs().max() < 1e-14);
            assert!((found.acceleration - asked.acceleration).abs().max() < 1e-13);
        }
        let angle = at.second.angle() - at.first.angle();
        let sine = <f64 as Number>::sin_cos(angle).0.abs();
        assert!((at.singularity_distance - sine).abs() < 1e-15);
    }

    /// Ends that coincide leave equal links free to turn and cannot be joined by others.
    #[test]
    fn solve_refuses_coinciding_and_endless_ends() {
        let at = |l2: f64, x: f32| {
            let c = PointMotion::fixed(Vector2::new(x, 0.0));
            let origin = PointMotion::fixed(Vector2::new(0.0, 0.0));
            Rrr::<f32>::new(2.0, l2, 1.0).solve(&origin, &c).map(|_| ())
        };
        assert_eq!(at(2.0, 0.0), Err(LinkageStatus::Singular));
        assert_eq!(at(3.0, 0.0), Err(LinkageStatus::Unreachable));
        assert_eq!(at(2.0, f32::MAX), Err(LinkageStatus::Unreachable));
        // So close that the inverse square of the distance overflows.
        assert_eq!(at(2.0, 1e-20), Err(LinkageStatus::OutOfRange));
        assert_eq!(at(2.0, 1e-10), Ok(()));
    }
}
