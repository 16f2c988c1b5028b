//! Scale-free distances to the two kinds of singularity: 0 at the singularity, at most 1.
//!
//! | singularity | where | distance |
//! |---|---|---|
//! | serial \[type I\] | a leg is stretched or folded | abs(r1 x r2) / (l1 l2), the sine of the angle between the links |
//! | parallel \[type II\] | the three distal lines meet in one point or are parallel | abs(det A) / (l2_1 l2_2 l2_3 s), s half the perimeter of the platform's triangle |
//!
//! det A is the determinant of the rows [r2x, r2y, c x r2]. No distal links, however turned, give
//! it a size above l2_1 l2_2 l2_3 s; an equilateral platform held by links at right angles to its
//! radii reaches that.

use crate::inverse::{LegPosition, Position};
use crate::machine::Parameters;
use crate::number::Number;
use crate::to_source;
use crate::torque::lines::DistalLines;

/// Coefficients of the distances, apart from the tick's because a tick needs no distances.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distances<N: Number> {
    /// 1 / (l1 l2) of each leg.
    serial: [N::Factor; 3],
    /// 1 / (l2_1 l2_2 l2_3 s).
    parallel: N::Factor,
}

to_source!([N: Number] Distances [N] in trirrr_core::singularity {
    serial: [N::Factor; 3],
    parallel: N::Factor,
});

impl<N: Number> Distances<N> {
    /// Builds the coefficients from checked parameters.
    pub fn build(parameters: &Parameters) -> Self {
        let greatest = parameters.greatest_det_a();
        Self {
            serial: parameters
                .legs
                .map(|leg| N::factor_from_f64(1.0 / (leg.proximal_m * leg.distal_m))),
            // A platform whose joints coincide is singular everywhere.
            parallel: N::factor_from_f64(if greatest > 0.0 { 1.0 / greatest } else { 0.0 }),
        }
    }

    /// Distance of each leg from its serial singularity.
    #[inline]
    pub fn serial(&self, position: &Position<N>) -> [N; 3] {
        let distance = |leg: usize| self.serial_of(leg, &position.legs[leg]);
        [distance(0), distance(1), distance(2)]
    }

    /// Distance of leg `index` from its serial singularity.
    #[inline]
    pub fn serial_of(&self, index: usize, leg: &LegPosition<N>) -> N {
        self.signed_serial_of(index, leg).abs()
    }

    /// [`serial_of`](Self::serial_of) with the sign of r1 x r2.
    #[inline]
    pub fn signed_serial_of(&self, index: usize, leg: &LegPosition<N>) -> N {
        leg.links.r1_cross_r2.scaled(self.serial[index])
    }

    /// Distance of the machine from its parallel singularity.
    #[inline]
    pub fn parallel(&self, position: &Position<N>) -> N {
        self.signed_parallel_of(position.legs.each_ref()).abs()
    }

    /// [`parallel`](Self::parallel) of three separate legs, with the sign of det A.
    #[inline]
    pub fn signed_parallel_of(&self, legs: [&LegPosition<N>; 3]) -> N {
        self.signed_parallel(DistalLines::of(legs).det_a)
    }

    /// As [`signed_parallel_of`](Self::signed_parallel_of), of a known det A.
    #[inline]
    pub fn signed_parallel(&self, det_a: N) -> N {
        det_a.scaled(self.parallel)
    }
}

/// det A without the torques. Its sign differs on the two sides of a parallel singularity, so a path
/// on which the sign changes crosses one.
#[inline]
pub fn det_a<N: Number>(position: &Position<N>) -> N {
    DistalLines::of(position.legs.each_ref()).det_a
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machine::{Geometry, example};
    use crate::setpoint::Pose;
    use nalgebra::Vector2;

    /// Poses of the thesis machine where the three distal lines meet, to all digits.
    #[test]
    fn vanishes_at_the_known_parallel_singularities() {
        let parameters = example();
        let geometry = Geometry::<f64>::build(&parameters).unwrap();
        let distances = Distances::build(&parameters);
        for alpha in [-0.753_418_931_929_448_5, 2.401_557_361_435_242] {
            let at = |alpha| {
                geometry
                    .position(&Pose::from_f64(0.245, 0.25, alpha))
                    .unwrap()
            };
            assert!(distances.parallel(&at(alpha)) < 1e-15);
            let (before, after) = (det_a(&at(alpha - 1e-9)), det_a(&at(alpha + 1e-9)));
            assert!(before * after < 0.0, "no change of sign at {alpha}");
        }
    }

    #[test]
    fn reaches_one_for_links_at_right_angles() {
        // Every distal link at right angles to its radius, every elbow at a right angle.
        let mut parameters = example();
        for (leg, turn) in parameters.legs.iter_mut().zip([150f64, 30.0, 270.0]) {
            let (sin, cos) = turn.to_radians().sin_cos();
            let (radial, tangential) = (Vector2::new(cos, sin), Vector2::new(-sin, cos));
            let joint = radial * leg.joint_radius_m;
            // C = A + r1 + r2 with r2 along the tangent and r1 across it.
            leg.base_m = joint - tangential * leg.distal_m - radial * leg.proximal_m;
            leg.elbow = crate::machine::Elbow::Negative;
        }
        let geometry = Geometry::<f64>::build(&parameters).unwrap();
        let distances = Distances::build(&parameters);
        let position = geometry.position(&Pose::from_f64(0.0, 0.0, 0.0)).unwrap();
        assert!((distances.parallel(&position) - 1.0).abs() < 1e-14);
        for serial in distances.serial(&position) {
            assert!((serial - 1.0).abs() < 1e-14);
        }
    }
}
