//! The five-bar linkage: two cranks about A and E, both driven, joined by two links that meet at
//! C. A is the origin, E lies on the x axis.

use super::four_bar::towards_joint;
use super::{Crank, DimensionError, branch, lengths};
use crate::rrr::{Rrr, SolveRrr};
use crate::{Drive, LinkMotion, LinkageStatus, PointMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths in m and the branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// A-E.
    pub ground: f64,
    /// A-B.
    pub left_crank: f64,
    /// B-C.
    pub left_link: f64,
    /// D-C.
    pub right_link: f64,
    /// E-D.
    pub right_crank: f64,
    /// +1: C lies to the left of B -> D.
    pub branch: f64,
}

/// Both cranks turn fully, at whatever phase.
pub const SHIPPED: Dimensions = Dimensions {
    ground: 0.15,
    left_crank: 0.05,
    left_link: 0.2,
    right_link: 0.22,
    right_crank: 0.04,
    branch: 1.0,
};

/// Coefficients of a five-bar linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FiveBar<N: Number> {
    left: Crank<N>,
    right: Crank<N>,
    dyad: Rrr<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at A, x axis towards B.
    pub left_crank: LinkMotion<N>,
    /// Origin at B, x axis towards C.
    pub left_link: LinkMotion<N>,
    /// Origin at D, x axis towards C.
    pub right_link: LinkMotion<N>,
    /// Origin at E, x axis towards D.
    pub right_crank: LinkMotion<N>,
    /// The joint C.
    pub joint: PointMotion<N>,
    /// Distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> FiveBar<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        lengths([
            ("ground", dimensions.ground),
            ("left_crank", dimensions.left_crank),
            ("left_link", dimensions.left_link),
            ("right_link", dimensions.right_link),
            ("right_crank", dimensions.right_crank),
        ])?;
        branch("branch", dimensions.branch)?;
        Ok(Self {
            left: Crank::new(Vector2::new(0.0, 0.0), dimensions.left_crank),
            right: Crank::new(Vector2::new(dimensions.ground, 0.0), dimensions.right_crank),
            dyad: Rrr::new(
                dimensions.left_link,
                dimensions.right_link,
                dimensions.branch,
            ),
        })
    }

    /// The links for the two cranks driven by `left` and `right`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, left: &Drive<N>, right: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let left_crank = self.left.at(left);
        let right_crank = self.right.at(right);
        let end = self.right.tip(&right_crank);
        let dyad = self.dyad.solve(&self.left.tip(&left_crank), &end)?;
        Ok(Motion {
            left_crank,
            left_link: dyad.first,
            right_link: towards_joint(&dyad, &end),
            right_crank,
            joint: dyad.joint,
            singularity_distance: dyad.singularity_distance,
        })
    }
}
