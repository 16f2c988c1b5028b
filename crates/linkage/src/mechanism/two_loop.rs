//! The linkage of two loops and one degree of freedom, whose loops are solved in order.
//!
//! First loop: crank z1, coupler z2 + z3 (one straight link with the point P between the two),
//! rocker z4 to the fixed joint D at z5 on the x axis. Second loop: from P an arm z6, a slide z7
//! and an arm z8 to the fixed joint Q, z9 beyond D. The arms stand at fixed angles to the slide:
//!
//! ```text
//! z1 + z2 + z3 + z4 - z5 = 0            phi3 = phi2
//! z6 + z7 + z8 - z9 - z4 - z3 = 0       phi7 = phi6 + pi + chi,  phi8 = phi7 - beta
//! ```
//!
//! Crank + RRR + RPR: P is known once the first loop is closed, so there is no other order.

use super::four_bar::towards_joint;
use super::{Crank, DimensionError, branch, finite, lengths, smaller};
use crate::rpr::Rpr;
use crate::rrr::{Rrr, SolveRrr};
use crate::{Drive, LinkMotion, LinkageStatus, PointMotion, SlideMotion};
use nalgebra::Vector2;
use trirrr_core::number::Number;

/// Lengths in m, angles in rad, and the branches.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// Crank.
    pub z1: f64,
    /// From the crank's tip to P.
    pub z2: f64,
    /// From P to the rocker.
    pub z3: f64,
    /// Rocker.
    pub z4: f64,
    /// From the crank's centre to D.
    pub z5: f64,
    /// Arm at P.
    pub z6: f64,
    /// Arm at Q.
    pub z8: f64,
    /// From D to Q.
    pub z9: f64,
    /// Angle of the arm at P.
    pub chi: f64,
    /// Angle of the arm at Q.
    pub beta: f64,
    /// +1: the rocker's joint lies to the left of the way from the crank's tip to D.
    pub rocker_branch: f64,
    /// +1: the slide's direction is from Q towards P.
    pub slide_branch: f64,
}

/// A crank-rocker with a telescope between its coupler and the ground.
pub const SHIPPED: Dimensions = Dimensions {
    z1: 0.1,
    z2: 0.2,
    z3: 0.15,
    z4: 0.3,
    z5: 0.4,
    z6: 0.05,
    z8: 0.08,
    z9: 0.25,
    chi: 80.0 * (core::f64::consts::PI / 180.0),
    beta: 100.0 * (core::f64::consts::PI / 180.0),
    rocker_branch: 1.0,
    slide_branch: 1.0,
};

/// Coefficients of the linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoLoop<N: Number> {
    crank: Crank<N>,
    pivot: PointMotion<N>,
    rocker: Rrr<N>,
    point: Vector2<N>,
    end: PointMotion<N>,
    telescope: Rpr<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at the centre, x axis towards the tip.
    pub crank: LinkMotion<N>,
    /// Origin at the crank's tip, x axis towards the rocker.
    pub coupler: LinkMotion<N>,
    /// Origin at D, x axis towards the coupler.
    pub rocker: LinkMotion<N>,
    /// The link with the arm z6; origin at P, x axis along the slide from Q towards P.
    pub upper: LinkMotion<N>,
    /// The link with the arm z8; origin at Q, x axis likewise.
    pub lower: LinkMotion<N>,
    /// z7.
    pub slide: SlideMotion<N>,
    /// The smaller distance of the two dyads from their singularities, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> TwoLoop<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        let z = dimensions;
        lengths([("z1", z.z1), ("z2", z.z2), ("z3", z.z3), ("z4", z.z4)])?;
        lengths([("z5", z.z5)])?;
        finite([("z6", z.z6), ("z8", z.z8), ("z9", z.z9)])?;
        finite([("chi", z.chi), ("beta", z.beta)])?;
        branch("rocker_branch", z.rocker_branch)?;
        branch("slide_branch", z.slide_branch)?;
        let on_ground = |x: f64| PointMotion::fixed(Vector2::new(N::from_f64(x), N::ZERO));
        Ok(Self {
            crank: Crank::new(Vector2::new(0.0, 0.0), z.z1),
            pivot: on_ground(z.z5),
            rocker: Rrr::new(z.z2 + z.z3, z.z4, z.rocker_branch),
            point: Vector2::new(N::from_f64(z.z2), N::ZERO),
            end: on_ground(z.z5 + z.z9),
            // The dyad's own slide runs from Q to P, against z7: phi2 = phi7 - pi = phi6 + chi,
            // and its arms' angles are pi - chi and beta.
            telescope: Rpr::new(
                z.z6,
                core::f64::consts::PI - z.chi,
                z.z8,
                z.beta,
                z.slide_branch,
            ),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let rocker = self.rocker.solve(&self.crank.tip(&crank), &self.pivot)?;
        let point = rocker.first.point(self.point);
        let telescope = self.telescope.solve(&point, &self.end)?;
        Ok(Motion {
            crank,
            coupler: rocker.first,
            rocker: towards_joint(&rocker, &self.pivot),
            upper: telescope.first,
            lower: telescope.second,
            slide: telescope.slide,
            singularity_distance: smaller(
                rocker.singularity_distance,
                telescope.singularity_distance,
            ),
        })
    }
}
