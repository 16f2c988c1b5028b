//! The quick return: the pin of a crank slides along a slotted lever, which swings about a fixed
//! pivot below the crank; a rod joins the lever's end to a ram on a level guide.
//!
//! Crank + RPR (pin and lever, without offsets) + RRP (rod and ram). The ram returns while the
//! crank passes the smaller of the two angles between the lever's extremes.
//! [`slotted_quick_return`](super::slotted_quick_return) ends in another dyad.

use super::{Crank, DimensionError, branch, finite, fixed_guide, lengths};
use crate::rpr::Rpr;
use crate::rrp::Rrp;
use crate::{Drive, GuideMotion, LinkMotion, LinkageStatus, PointMotion, SlideMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths in m and the branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// From its centre, the origin, to the pin.
    pub crank: f64,
    /// Distance of the lever's pivot below the centre; more than the crank for a lever that
    /// swings.
    pub pivot_depth: f64,
    /// From the pivot to the lever's end.
    pub lever: f64,
    /// From the lever's end to the ram.
    pub rod: f64,
    /// Height of the ram's guide above the centre.
    pub guide_height: f64,
    /// +1: the ram lies to the right of the lever's end.
    pub branch: f64,
}

/// The lever swings by asin(0.1 / 0.25) to either side.
pub const SHIPPED: Dimensions = Dimensions {
    crank: 0.1,
    pivot_depth: 0.25,
    lever: 0.5,
    rod: 0.3,
    guide_height: 0.23,
    branch: 1.0,
};

/// Coefficients of a quick return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct QuickReturn<N> {
    crank: Crank<N>,
    pivot: PointMotion<N>,
    lever: Rpr<N>,
    lever_end: Vector2<N>,
    guide: GuideMotion<N>,
    ram: Rrp<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the centre, x axis towards the pin.
    pub crank: LinkMotion<N>,
    /// Origin at the pivot, x axis along the slot.
    pub lever: LinkMotion<N>,
    /// From the pivot to the pin along the slot.
    pub pin: SlideMotion<N>,
    /// Origin at the ram, x axis towards the lever's end.
    pub rod: LinkMotion<N>,
    /// Origin at the ram's joint, x axis along its guide.
    pub ram: LinkMotion<N>,
    /// From below the centre to the ram along its guide.
    pub stroke: SlideMotion<N>,
    /// Distance of rod and ram from their singularity, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> QuickReturn<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([
            ("crank", dimensions.crank),
            ("pivot_depth", dimensions.pivot_depth),
            ("lever", dimensions.lever),
            ("rod", dimensions.rod),
        ])?;
        finite([("guide_height", dimensions.guide_height)])?;
        branch("branch", dimensions.branch)?;
        let pivot = Vector2::new(0.0, -dimensions.pivot_depth);
        Ok(Self {
            crank: Crank::new(Vector2::new(0.0, 0.0), dimensions.crank),
            pivot: PointMotion::fixed(pivot.map(N::from_f64)),
            lever: Rpr::from_offsets(0.0, 0.0, 1.0),
            lever_end: Vector2::new(N::from_f64(dimensions.lever), N::ZERO),
            guide: fixed_guide(Vector2::new(0.0, dimensions.guide_height), 0.0),
            ram: Rrp::from_offsets(dimensions.rod, 0.0, 0.0, dimensions.branch),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let lever = self.lever.solve(&self.crank.tip(&crank), &self.pivot)?;
        let end = lever.second.point(self.lever_end);
        let ram = self.ram.solve(&end, &self.guide)?;
        Ok(Motion {
            crank,
            lever: lever.second,
            pin: lever.slide,
            rod: ram.link,
            ram: ram.slider,
            stroke: ram.slide,
            // The lever's dyad has no offset: it is singular only where pin and pivot coincide.
            singularity_distance: ram.singularity_distance,
        })
    }
}
