//! RRR dyad between two joints that move: [`SolveRrr`] adds the motions of links and joints to the
//! stages of [`Rrr`].

use crate::motion::{LinkMotion, PointMotion};
use crate::status::LinkageStatus;
use nalgebra::Vector2;
pub use trirrr_core::dyad::{Accelerations, DyadPosition, OutOfReach, Rates, Rrr};
use trirrr_core::number::Number;

/// Motion of the links of a dyad between two moving joints.
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

/// Solution of an [`Rrr`] for the motions of its ends.
pub trait SolveRrr<N> {
    /// Solves position, velocity and acceleration for the motions of A and C. Every result is
    /// finite.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    fn solve(&self, a: &PointMotion<N>, c: &PointMotion<N>) -> Result<Motion<N>, LinkageStatus>;
}

impl<N: Number> SolveRrr<N> for Rrr<N> {
    fn solve(&self, a: &PointMotion<N>, c: &PointMotion<N>) -> Result<Motion<N>, LinkageStatus> {
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
        let (l1, l2) = self.lengths();
        let motion = Motion {
            joint,
            first: link(*a, at.r1, l1, rates.proximal, acc.proximal),
            second: link(joint, at.r2, l2, rates.distal, acc.distal),
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
    use trirrr_core::number::Arithmetic;

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
        let sine = <f64 as Arithmetic>::sin_cos(angle).0.abs();
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
