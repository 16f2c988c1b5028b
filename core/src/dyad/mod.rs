//! RRR dyad, a leg of the machine: two links A -> B -> C with revolute joints at A, B and C.
//!
//! The dyad finds the inner joint B from the ends A and C. A, B and C are the corners of a
//! [`Triangle`] over d = C - A with the branch sigma, the side of A -> C on which B lies (+1 for
//! the left). With S twice its area:
//!
//! ```text
//! r1  = A -> B,   r2  = B -> C = d - r1
//! r1 x r2 = -sigma S
//! ```
//!
//! The stages need no angle; the motor angle is the direction of r1. The dyad is singular where
//! S = 0. The scale-free distance from there is S / (l1 l2), the sine of the angle between the
//! links. Both ends may move: the stages take position, velocity and acceleration of C relative
//! to A. Source: thesis (3.2) to (3.21), corrected; the sign of r2 is B -> C.

mod fixed;
mod kernel;

pub use kernel::{DyadKernel, DyadPosition, OutOfReach, Triangle};

use crate::arithmetic::{WideArithmetic, sum_dot};
use crate::to_source;
use nalgebra::Vector2;

/// Coefficients of an RRR dyad, built from its two lengths and its branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrr<N: WideArithmetic> {
    /// A, B and C.
    triangle: Triangle<N>,
    /// l1
    l1: N::Length,
    /// l1^2
    l1_sq: N,
    /// l2^2
    l2_sq: N,
}

to_source!([N: WideArithmetic] Rrr [N] in trirrr_core::dyad {
    triangle: Triangle<N>,
    l1: N::Length,
    l1_sq: N,
    l2_sq: N,
});

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

impl<N: DyadKernel> Rrr<N> {
    /// The dyad with lengths `l1` (A -> B) and `l2` (B -> C), both positive, whose inner joint
    /// lies to the left of A -> C for `branch` = +1, to the right for -1.
    pub fn new(l1: f64, l2: f64, branch: f64) -> Self {
        Self {
            triangle: Triangle::new(l1, l2, branch),
            l1: N::length_from_f64(l1),
            l1_sq: N::from_f64(l1 * l1),
            l2_sq: N::from_f64(l2 * l2),
        }
    }

    /// The configuration for `d`, the vector A -> C.
    #[inline(always)]
    pub fn position(&self, d: Vector2<N>) -> Result<DyadPosition<N>, OutOfReach> {
        N::intersect_circles(&self.triangle, d)
    }

    /// As [`position`](Self::position), for callers that
    /// [look at their results](DyadKernel::intersect_circles_unchecked).
    #[inline(always)]
    pub fn position_unchecked(&self, d: Vector2<N>) -> Result<DyadPosition<N>, OutOfReach> {
        N::intersect_circles_unchecked(&self.triangle, d)
    }

    /// Direction of A -> B, counter-clockwise from the x axis, in (-pi, pi].
    #[inline(always)]
    pub fn proximal_angle(&self, at: &DyadPosition<N>) -> N::Angle {
        N::direction(at.r1.x, at.r1.y, &self.l1)
    }

    /// Directions of A -> B of three dyads, as [`proximal_angle`](Self::proximal_angle).
    #[inline(always)]
    pub fn proximal_angles(dyads: [&Self; 3], at: [&DyadPosition<N>; 3]) -> [N::Angle; 3] {
        N::directions(at.map(|at| at.r1), dyads.map(|dyad| &dyad.l1))
    }

    /// Link rates for `v`, the velocity of C relative to A: v = E (rate1 r1 + rate2 r2).
    #[inline(always)]
    pub fn rates(&self, at: &DyadPosition<N>, v: Vector2<N>) -> Rates<N> {
        let products = [sum_dot(at.r2, v), sum_dot(at.r1, v)];
        let [proximal, opposite] = N::over_cross(products, at.inverse_cross);
        Rates {
            proximal,
            distal: -opposite,
        }
    }

    /// Rate of the first link alone, as of [`rates`](Self::rates).
    pub fn proximal_rate(&self, at: &DyadPosition<N>, v: Vector2<N>) -> N {
        N::round_scaled(sum_dot(at.r2, v), at.inverse_cross)
    }

    /// Link accelerations for `a`, the acceleration of C relative to A.
    #[inline(always)]
    pub fn accelerations(
        &self,
        at: &DyadPosition<N>,
        rates: &Rates<N>,
        a: Vector2<N>,
    ) -> Accelerations<N> {
        // b = a + rate1^2 r1 + rate2^2 r2 is what the angular accelerations have to supply. Its
        // products with r1 and r2 are formed from l1^2, l2^2 and r1.r2, which saves forming b.
        let w1 = rates.proximal * rates.proximal;
        let w2 = rates.distal * rates.distal;
        let r2_dot_b = sum_dot(at.r2, a) + N::sum_ab_plus_cd(w1, at.r1_dot_r2, w2, self.l2_sq);
        let r1_dot_b = sum_dot(at.r1, a) + N::sum_ab_plus_cd(w1, self.l1_sq, w2, at.r1_dot_r2);
        let [proximal, opposite] = N::over_cross([r2_dot_b, r1_dot_b], at.inverse_cross);
        Accelerations {
            proximal,
            distal: -opposite,
        }
    }

    /// Acceleration of the first link alone, as of [`accelerations`](Self::accelerations).
    pub fn proximal_acceleration(
        &self,
        at: &DyadPosition<N>,
        rates: &Rates<N>,
        a: Vector2<N>,
    ) -> N {
        let w1 = rates.proximal * rates.proximal;
        let w2 = rates.distal * rates.distal;
        let r2_dot_b = sum_dot(at.r2, a) + N::sum_ab_plus_cd(w1, at.r1_dot_r2, w2, self.l2_sq);
        N::round_scaled(r2_dot_b, at.inverse_cross)
    }

    /// Jerk of the first link for `j`, the jerk of C relative to A.
    ///
    /// The derivative of the acceleration of C leaves for each link (jerk - rate^3) E r - 3 rate acceleration r.
    pub fn proximal_jerk(
        &self,
        at: &DyadPosition<N>,
        rates: &Rates<N>,
        accelerations: &Accelerations<N>,
        j: Vector2<N>,
    ) -> N {
        let three = |x: N| x + x + x;
        let w1 = three(rates.proximal * accelerations.proximal);
        let w2 = three(rates.distal * accelerations.distal);
        let r2_dot_b = sum_dot(at.r2, j) + N::sum_ab_plus_cd(w1, at.r1_dot_r2, w2, self.l2_sq);
        let turning = N::round_scaled(r2_dot_b, at.inverse_cross);
        turning + rates.proximal * rates.proximal * rates.proximal
    }

    /// The least and the greatest distance of the end joints, abs(l1 - l2) and l1 + l2.
    pub fn reach(&self) -> (N, N) {
        self.triangle.reach()
    }

    /// Returns the lengths of the links A -> B and B -> C.
    #[inline]
    pub fn lengths(&self) -> (N, N) {
        // The stages need no l2, so it is not stored.
        (N::length(&self.l1), self.l2_sq.sqrt())
    }

    /// Returns the squares of the lengths of the links A -> B and B -> C.
    #[inline]
    pub fn squared_lengths(&self) -> [N; 2] {
        [self.l1_sq, self.l2_sq]
    }

    /// abs(r1 x r2) / (l1 l2): 0 where the dyad is stretched or folded, 1 where it is at right
    /// angles.
    #[inline]
    pub fn singularity_distance(&self, at: &DyadPosition<N>) -> N {
        let (l1, l2) = self.lengths();
        at.r1_cross_r2.abs().div(l1 * l2)
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
            assert!(at.r1_dot_r2.abs() < 1e-14);
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
    fn the_first_link_alone_has_the_same_rate_and_acceleration() {
        fn check<N: DyadKernel>() {
            let vector = |x, y| Vector2::new(N::from_f64(x), N::from_f64(y));
            let dyad = Rrr::<N>::new(0.3, 0.4, -1.0);
            let at = dyad.position(vector(0.5, 0.1)).unwrap();
            let (v, a) = (vector(0.07, -0.03), vector(-0.2, 0.1));
            let rates = dyad.rates(&at, v);
            let acc = dyad.accelerations(&at, &rates, a);
            for (alone, both) in [
                (dyad.proximal_rate(&at, v), rates.proximal),
                (dyad.proximal_acceleration(&at, &rates, a), acc.proximal),
            ] {
                let difference = (alone.to_f64() - both.to_f64()).abs();
                assert!(
                    difference <= 4.0 * N::UNIT_ROUNDOFF.to_f64(),
                    "{difference:e}"
                );
                assert!(both.to_f64().abs() > 0.01);
            }
        }
        check::<f64>();
        check::<f32>();
        check::<crate::number::Fixed>();
    }

    /// Along a path of C the jerk is the rate of change of the acceleration, by central differences at two steps.
    #[test]
    fn the_jerk_is_the_derivative_of_the_acceleration() {
        let dyad = Rrr::<f64>::new(3.0, 4.0, -1.0);
        let (d, v) = (Vector2::new(5.5, 1.0), Vector2::new(0.7, -0.3));
        let (a, j) = (Vector2::new(-2.0, 5.0), Vector2::new(11.0, -7.0));
        let motion = |t: f64| {
            let at = dyad.position(d + (v + (a / 2.0 + j * (t / 6.0)) * t) * t);
            let at = at.expect("in reach");
            let rates = dyad.rates(&at, v + (a + j * (t / 2.0)) * t);
            let accelerations = dyad.accelerations(&at, &rates, a + j * t);
            (at, rates, accelerations)
        };
        let (at, rates, accelerations) = motion(0.0);
        let jerk = dyad.proximal_jerk(&at, &rates, &accelerations, j);
        let slope = |h: f64| {
            let [before, after] = [-h, h].map(|t| motion(t).2.proximal);
            (after - before) / (2.0 * h)
        };
        let limit = (4.0 * slope(1e-3) - slope(2e-3)) / 3.0;
        assert!(
            jerk.abs() > 0.1 && (jerk - limit).abs() < 1e-8,
            "{jerk} {limit}"
        );
    }
}
