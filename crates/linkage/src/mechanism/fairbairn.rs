//! A modified Fairbairn straight-line guide.
//!
//! A tracing link T-M-N is held at its middle M by a bridle O-M, half as long as the link. Were N
//! guided along the x axis through O, T would move on the straight line across it. Here N is held
//! by a long rocker G-N instead of a guide, so that the guide has turning joints only and the line
//! is nearly straight; a crank swings the bridle through a rod that ends at M.
//!
//! Crank + RRR (rod and bridle) + RRR (half the tracing link and rocker). O is the origin.

use super::four_bar::towards_joint;
use super::{Crank, DimensionError, branch, finite, lengths, smaller};
use crate::rrr::{Rrr, SolveRrr};
use crate::{Drive, LinkMotion, LinkageStatus, PointMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths and places in m, and the branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Centre of the crank.
    pub centre: Vector2<f64>,
    /// Of the crank.
    pub crank: f64,
    /// From the crank's tip to M.
    pub rod: f64,
    /// O-M, T-M and M-N.
    pub bridle: f64,
    /// Fixed joint G of the rocker.
    pub pivot: Vector2<f64>,
    /// G-N.
    pub rocker: f64,
    /// +1: M lies to the left of the way from the crank's tip to O.
    pub bridle_branch: f64,
    /// +1: N lies to the left of M -> G.
    pub rocker_branch: f64,
}

/// T moves up and down near the y axis.
pub const SHIPPED: Dimensions = Dimensions {
    centre: Vector2::new(0.33, -0.13),
    crank: 0.05,
    rod: 0.3,
    bridle: 0.2,
    pivot: Vector2::new(0.32, -0.8),
    rocker: 0.8,
    bridle_branch: -1.0,
    rocker_branch: 1.0,
};

/// Coefficients of the guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fairbairn<N: Number> {
    crank: Crank<N>,
    origin: PointMotion<N>,
    bridle: Rrr<N>,
    pivot: PointMotion<N>,
    rocker: Rrr<N>,
    tracer: Vector2<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the centre, x axis towards the tip.
    pub crank: LinkMotion<N>,
    /// Origin at the crank's tip, x axis towards M.
    pub rod: LinkMotion<N>,
    /// Origin at O, x axis towards M.
    pub bridle: LinkMotion<N>,
    /// Origin at M, x axis towards N.
    pub tracing: LinkMotion<N>,
    /// Origin at G, x axis towards N.
    pub rocker: LinkMotion<N>,
    /// The tracing point T.
    pub tracer: PointMotion<N>,
    /// The smaller distance of the two dyads from their singularities, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> Fairbairn<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([
            ("crank", dimensions.crank),
            ("rod", dimensions.rod),
            ("bridle", dimensions.bridle),
            ("rocker", dimensions.rocker),
        ])?;
        finite([
            ("centre x", dimensions.centre.x),
            ("centre y", dimensions.centre.y),
            ("pivot x", dimensions.pivot.x),
            ("pivot y", dimensions.pivot.y),
        ])?;
        branch("bridle_branch", dimensions.bridle_branch)?;
        branch("rocker_branch", dimensions.rocker_branch)?;
        let bridle = dimensions.bridle;
        Ok(Self {
            crank: Crank::new(dimensions.centre, dimensions.crank),
            origin: PointMotion::fixed(Vector2::new(N::ZERO, N::ZERO)),
            bridle: Rrr::new(dimensions.rod, bridle, dimensions.bridle_branch),
            pivot: PointMotion::fixed(dimensions.pivot.map(N::from_f64)),
            rocker: Rrr::new(bridle, dimensions.rocker, dimensions.rocker_branch),
            tracer: Vector2::new(-N::from_f64(bridle), N::ZERO),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let bridle = self.bridle.solve(&self.crank.tip(&crank), &self.origin)?;
        let rocker = self.rocker.solve(&bridle.joint, &self.pivot)?;
        Ok(Motion {
            crank,
            rod: bridle.first,
            bridle: towards_joint(&bridle, &self.origin),
            tracing: rocker.first,
            rocker: towards_joint(&rocker, &self.pivot),
            tracer: rocker.first.point(self.tracer),
            singularity_distance: smaller(bridle.singularity_distance, rocker.singularity_distance),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn traces_a_nearly_straight_line() {
        let guide = Fairbairn::<f64>::new(&SHIPPED).unwrap();
        let (mut left, mut right, mut low, mut high) = (1.0f64, -1.0f64, 1.0f64, -1.0f64);
        for k in 0..720 {
            let drive = Drive {
                angle: f64::from(k) * (core::f64::consts::PI / 360.0),
                rate: 1.0,
                acceleration: 0.0,
            };
            let at = guide.at(&drive).unwrap().tracer.position;
            (left, right) = (left.min(at.x), right.max(at.x));
            (low, high) = (low.min(at.y), high.max(at.y));
        }
        assert!(high - low > 0.16, "stroke {}", high - low);
        assert!(right - left < 0.03 * (high - low), "width {}", right - left);
    }
}
