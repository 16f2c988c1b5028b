//! An inserter: a point of the coupler of a four-bar linkage pushes a slider through a rod.
//!
//! Crank + RRR (coupler and rocker) + RRP (rod and pusher). The crank turns about the origin.

use super::four_bar::towards_joint;
use super::{Crank, DimensionError, branch, finite, fixed_guide, lengths, smaller};
use crate::rrp::Rrp;
use crate::rrr::{Rrr, SolveRrr};
use crate::{Drive, GuideMotion, LinkMotion, LinkageStatus, PointMotion, SlideMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths and places in m, and the branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Of the crank.
    pub crank: f64,
    /// From the crank's tip to the rocker.
    pub coupler: f64,
    /// Of the rocker.
    pub rocker: f64,
    /// Fixed joint of the rocker.
    pub pivot: Vector2<f64>,
    /// Joint of rod and coupler, seen from the crank's tip, along and across the coupler.
    pub coupler_point: Vector2<f64>,
    /// From the coupler to the pusher.
    pub rod: f64,
    /// Height of the pusher's level guide above the origin.
    pub guide_height: f64,
    /// +1: the rocker's joint lies to the left of the way from the crank's tip to the pivot.
    pub rocker_branch: f64,
    /// +1: the pusher lies to the right of the coupler.
    pub pusher_branch: f64,
}

/// A crank-rocker below the pusher's guide.
pub const SHIPPED: Dimensions = Dimensions {
    crank: 0.06,
    coupler: 0.2,
    rocker: 0.14,
    pivot: Vector2::new(0.22, 0.0),
    coupler_point: Vector2::new(0.15, 0.12),
    rod: 0.3,
    guide_height: 0.2,
    rocker_branch: 1.0,
    pusher_branch: 1.0,
};

/// Coefficients of an inserter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Inserter<N: Number> {
    crank: Crank<N>,
    pivot: PointMotion<N>,
    rocker: Rrr<N>,
    coupler_point: Vector2<N>,
    guide: GuideMotion<N>,
    pusher: Rrp<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the centre, x axis towards the tip.
    pub crank: LinkMotion<N>,
    /// Origin at the crank's tip, x axis towards the rocker's joint.
    pub coupler: LinkMotion<N>,
    /// Origin at the pivot, x axis towards the coupler.
    pub rocker: LinkMotion<N>,
    /// Origin at the pusher, x axis towards the coupler's point.
    pub rod: LinkMotion<N>,
    /// Origin at the pusher's joint, x axis along its guide.
    pub pusher: LinkMotion<N>,
    /// From above the origin to the pusher.
    pub stroke: SlideMotion<N>,
    /// The smaller distance of the two dyads from their singularities, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> Inserter<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([
            ("crank", dimensions.crank),
            ("coupler", dimensions.coupler),
            ("rocker", dimensions.rocker),
            ("rod", dimensions.rod),
        ])?;
        finite([
            ("pivot x", dimensions.pivot.x),
            ("pivot y", dimensions.pivot.y),
            ("coupler_point x", dimensions.coupler_point.x),
            ("coupler_point y", dimensions.coupler_point.y),
            ("guide_height", dimensions.guide_height),
        ])?;
        branch("rocker_branch", dimensions.rocker_branch)?;
        branch("pusher_branch", dimensions.pusher_branch)?;
        Ok(Self {
            crank: Crank::new(Vector2::new(0.0, 0.0), dimensions.crank),
            pivot: PointMotion::fixed(dimensions.pivot.map(N::from_f64)),
            rocker: Rrr::new(
                dimensions.coupler,
                dimensions.rocker,
                dimensions.rocker_branch,
            ),
            coupler_point: dimensions.coupler_point.map(N::from_f64),
            guide: fixed_guide(Vector2::new(0.0, dimensions.guide_height), 0.0),
            pusher: Rrp::from_offsets(dimensions.rod, 0.0, 0.0, dimensions.pusher_branch),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let rocker = self.rocker.solve(&self.crank.tip(&crank), &self.pivot)?;
        let point = rocker.first.point(self.coupler_point);
        let pusher = self.pusher.solve(&point, &self.guide)?;
        Ok(Motion {
            crank,
            coupler: rocker.first,
            rocker: towards_joint(&rocker, &self.pivot),
            rod: pusher.link,
            pusher: pusher.slider,
            stroke: pusher.slide,
            singularity_distance: smaller(rocker.singularity_distance, pusher.singularity_distance),
        })
    }
}
