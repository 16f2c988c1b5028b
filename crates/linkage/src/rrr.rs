//! RRR dyad between two joints that move: [`SolveRrr`] adds the motions of links and joints to the
//! stages of [`Rrr`].

use crate::motion::{DyadMotion, LinkMotion, PointMotion};
use crate::status::LinkageStatus;
use nalgebra::Vector2;
pub use trirrr_core::dyad::{Accelerations, DyadPosition, OutOfReach, Rates, Rrr};
use trirrr_core::number::Number;

/// Solution of an [`Rrr`] for the motions of its ends.
pub trait SolveRrr<N> {
    /// Solves position, velocity and acceleration for the motions of A and C.
    ///
    /// The first link has its origin at A and its x axis towards B, the second its origin at the
    /// inner joint B and its x axis towards C.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    fn solve(
        &self,
        a: &PointMotion<N>,
        c: &PointMotion<N>,
    ) -> Result<DyadMotion<N, 0>, LinkageStatus>;
}

impl<N: Number> SolveRrr<N> for Rrr<N> {
    fn solve(
        &self,
        a: &PointMotion<N>,
        c: &PointMotion<N>,
    ) -> Result<DyadMotion<N, 0>, LinkageStatus> {
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
        DyadMotion {
            first: link(*a, at.r1, l1, rates.proximal, acc.proximal),
            second: link(joint, at.r2, l2, rates.distal, acc.distal),
            slides: [],
            singularity_distance: self.singularity_distance(&at),
        }
        .finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{assert_alike, moving};
    use trirrr_core::number::Arithmetic;

    #[test]
    fn solve_carries_both_ends() {
        let dyad = Rrr::<f64>::new(3.0, 4.0, -1.0);
        let (a, c) = (moving(1.0), moving(4.5));
        let at = dyad.solve(&a, &c).unwrap();
        assert_alike(
            &at.first.point(Vector2::new(3.0, 0.0)),
            &at.second.origin,
            2e-15,
        );
        assert_alike(&at.second.point(Vector2::new(4.0, 0.0)), &c, 2e-15);
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
