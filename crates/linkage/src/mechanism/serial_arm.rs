//! The serial planar 3R arm: three links in an open chain from a fixed base, the origin.
//!
//! Forward, from the links' directions to the tool, nothing has to be solved. Inverse, from the
//! tool's point and direction, the wrist is known, and the first two links are an RRR dyad between
//! base and wrist: two solutions.

use super::{DimensionError, lengths};
use crate::rrr::{Rrr, SolveRrr};
use crate::{Drive, LinkMotion, LinkageStatus, PointMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// From the base to the elbow.
    pub upper: f64,
    /// From the elbow to the wrist.
    pub fore: f64,
    /// From the wrist to the tool's point.
    pub tool: f64,
}

/// An arm that reaches 0.8 m.
pub const SHIPPED: Dimensions = Dimensions {
    upper: 0.4,
    fore: 0.3,
    tool: 0.1,
};

/// Coefficients of the arm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SerialArm<N: Number> {
    lengths: [N; 3],
    /// Elbow to the left and to the right of the way from base to wrist.
    dyads: [Rrr<N>; 2],
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the base, x axis towards the elbow.
    pub upper: LinkMotion<N>,
    /// Origin at the elbow, x axis towards the wrist.
    pub fore: LinkMotion<N>,
    /// Origin at the wrist, x axis towards the tool's point.
    pub tool: LinkMotion<N>,
    /// The tool's point.
    pub tip: PointMotion<N>,
}

impl<N: Number> SerialArm<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        let (upper, fore, tool) = (dimensions.upper, dimensions.fore, dimensions.tool);
        lengths([("upper", upper), ("fore", fore), ("tool", tool)])?;
        Ok(Self {
            lengths: [upper, fore, tool].map(N::from_f64),
            dyads: [1.0, -1.0].map(|branch| Rrr::new(upper, fore, branch)),
        })
    }

    /// The links for their absolute directions, counted from the x axis.
    pub fn forward(&self, drives: &[Drive<N>; 3]) -> Motion<N> {
        let end = |link: &LinkMotion<N>, length| link.point(Vector2::new(length, N::ZERO));
        let base = PointMotion::fixed(Vector2::new(N::ZERO, N::ZERO));
        let upper = drives[0].link(base);
        let fore = drives[1].link(end(&upper, self.lengths[0]));
        let tool = drives[2].link(end(&fore, self.lengths[1]));
        Motion {
            tip: end(&tool, self.lengths[2]),
            upper,
            fore,
            tool,
        }
    }

    /// The links for the motion `tip` of the tool's point and `tool` of its direction: with the
    /// elbow to the left of the way from base to wrist, then to the right.
    ///
    /// # Errors
    /// [`LinkageStatus`]: both solutions exist, or none.
    pub fn inverse(
        &self,
        tip: &PointMotion<N>,
        tool: &Drive<N>,
    ) -> Result<[Motion<N>; 2], LinkageStatus> {
        let base = PointMotion::fixed(Vector2::new(N::ZERO, N::ZERO));
        let at_tip = tool.link(*tip);
        let wrist = at_tip.point(Vector2::new(-self.lengths[2], N::ZERO));
        let solve = |dyad: &Rrr<N>| -> Result<Motion<N>, LinkageStatus> {
            let arm = dyad.solve(&base, &wrist)?;
            Ok(Motion {
                upper: arm.first,
                fore: arm.second,
                tool: LinkMotion {
                    origin: wrist,
                    ..at_tip
                },
                tip: *tip,
            })
        };
        Ok([solve(&self.dyads[0])?, solve(&self.dyads[1])?])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drives(angles: [f64; 3]) -> [Drive<f64>; 3] {
        let rates = [0.7, -1.3, 0.4];
        core::array::from_fn(|i| Drive {
            angle: angles[i],
            rate: rates[i],
            acceleration: 2.0 * rates[i] + 0.1,
        })
    }

    #[test]
    fn inverse_undoes_forward_on_its_side() {
        let arm = SerialArm::<f64>::new(&SHIPPED).unwrap();
        for (angles, side) in [([1.0, 0.2, -0.5], 1), ([0.2, 1.0, 2.5], 0)] {
            let drives = drives(angles);
            let there = arm.forward(&drives);
            let both = arm.inverse(&there.tip, &drives[2]).unwrap();
            // Turning left at the elbow puts it to the right of the way to the wrist.
            let (same, other) = (both[1 - side], both[side]);
            for (link, drive) in [same.upper, same.fore].iter().zip(drives) {
                assert!((link.angle() - drive.angle).abs() < 1e-14, "{link:?}");
                assert!((link.rate - drive.rate).abs() < 1e-13);
                assert!((link.acceleration - drive.acceleration).abs() < 1e-12);
            }
            // The other solution leads to the same wrist.
            let wrist = other.fore.point(Vector2::new(SHIPPED.fore, 0.0));
            assert!((wrist.position - there.tool.origin.position).abs().max() < 1e-15);
            assert!((wrist.velocity - there.tool.origin.velocity).abs().max() < 1e-14);
            assert!((other.upper.direction - same.upper.direction).abs().max() > 0.1);
        }
    }

    #[test]
    fn says_what_is_out_of_reach() {
        let arm = SerialArm::<f32>::new(&SHIPPED).unwrap();
        let still = |angle| Drive {
            angle,
            rate: 0.0,
            acceleration: 0.0,
        };
        let at = |x| arm.inverse(&PointMotion::fixed(Vector2::new(x, 0.0)), &still(0.0));
        assert_eq!(at(0.81), Err(LinkageStatus::Unreachable));
        assert!(at(0.79).is_ok());
        assert_eq!(at(f32::NAN), Err(LinkageStatus::Unreachable));
    }
}
