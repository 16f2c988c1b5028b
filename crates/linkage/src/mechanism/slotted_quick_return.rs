//! The quick return whose ram is pinned to a block in the lever's slot: no rod between them.
//!
//! Crank + RPR (pin and lever, without offsets) + PRP (the lever's slot and the ram's level
//! guide): the slot, a guide that turns, is known once the first dyad is solved.

use super::{Crank, DimensionError, finite, fixed_guide, lengths};
use crate::prp::Prp;
use crate::rpr::Rpr;
use crate::{Drive, GuideMotion, LinkMotion, LinkageStatus, PointMotion, SlideMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths in m.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// From its centre, the origin, to the pin.
    pub crank: f64,
    /// Distance of the lever's pivot below the centre; more than the crank for a lever that
    /// swings.
    pub pivot_depth: f64,
    /// Height of the ram's guide above the centre.
    pub guide_height: f64,
    /// Height of the ram's joint above the guide of the ram.
    pub joint_height: f64,
}

/// The lever swings by asin(0.1 / 0.25) to either side.
pub const SHIPPED: Dimensions = Dimensions {
    crank: 0.1,
    pivot_depth: 0.25,
    guide_height: 0.2,
    joint_height: 0.03,
};

/// Coefficients of a slotted quick return.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlottedQuickReturn<N> {
    crank: Crank<N>,
    pivot: PointMotion<N>,
    lever: Rpr<N>,
    guide: GuideMotion<N>,
    ram: Prp<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the centre, x axis towards the pin.
    pub crank: LinkMotion<N>,
    /// Origin at the pivot, x axis along the slot.
    pub lever: LinkMotion<N>,
    /// From the pivot to the crank's pin along the slot.
    pub pin: SlideMotion<N>,
    /// From the pivot to the ram's joint along the slot.
    pub block: SlideMotion<N>,
    /// Origin at the ram's joint, x axis along its guide.
    pub ram: LinkMotion<N>,
    /// From above the centre to the ram along its guide.
    pub stroke: SlideMotion<N>,
    /// Distance of slot and guide from being parallel, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> SlottedQuickReturn<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([
            ("crank", dimensions.crank),
            ("pivot_depth", dimensions.pivot_depth),
        ])?;
        finite([
            ("guide_height", dimensions.guide_height),
            ("joint_height", dimensions.joint_height),
        ])?;
        let pivot = Vector2::new(0.0, -dimensions.pivot_depth);
        Ok(Self {
            crank: Crank::new(Vector2::new(0.0, 0.0), dimensions.crank),
            pivot: PointMotion::fixed(pivot.map(N::from_f64)),
            lever: Rpr::from_offsets(0.0, 0.0, 1.0),
            guide: fixed_guide(Vector2::new(0.0, dimensions.guide_height), 0.0),
            ram: Prp::from_offsets(
                Vector2::new(0.0, 0.0),
                Vector2::new(0.0, dimensions.joint_height),
            ),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let lever = self.lever.solve(&self.crank.tip(&crank), &self.pivot)?;
        let ram = self.ram.solve(&lever.second, &self.guide)?;
        Ok(Motion {
            crank,
            lever: lever.second,
            pin: lever.slide,
            block: ram.first_slide,
            ram: ram.second,
            stroke: ram.second_slide,
            singularity_distance: ram.singularity_distance,
        })
    }
}
