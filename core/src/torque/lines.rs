//! The lines along the distal links: what the balance needs of a pose, whatever the loads are.

use crate::inverse::LegPosition;
use crate::number::Number;
use nalgebra::Vector2;

/// Arms and moments of the distal links about C_1, and their determinant.
///
/// det A, of the rows [r2x, r2y, c x r2], is the same about every point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DistalLines<N> {
    /// From C_1 to C_2.
    pub(super) arm2: Vector2<N>,
    /// From C_1 to C_3.
    pub(super) arm3: Vector2<N>,
    /// Moment of r2 of leg 2.
    pub(super) moment2: N,
    /// Moment of r2 of leg 3.
    pub(super) moment3: N,
    /// r2 of leg 1 x r2 of leg 2.
    pub(super) d1_x_d2: N,
    /// r2 of leg 3 x r2 of leg 1.
    pub(super) d3_x_d1: N,
    /// Determinant of the rows [r2x, r2y, c x r2].
    pub det_a: N,
}

impl<N: Number> DistalLines<N> {
    /// The lines of three legs.
    #[inline(always)]
    pub fn of(legs: [&LegPosition<N>; 3]) -> Self {
        Self::with_arms(legs, Self::arms(legs))
    }

    /// From C_1 to C_2 and to C_3.
    #[inline(always)]
    pub(super) fn arms([leg1, leg2, leg3]: [&LegPosition<N>; 3]) -> [Vector2<N>; 2] {
        let c1 = leg1.platform_joint;
        [
            N::arm_between(c1, leg2.platform_joint),
            N::arm_between(c1, leg3.platform_joint),
        ]
    }

    /// The lines of three legs with known [`arms`](Self::arms).
    #[inline(always)]
    pub(super) fn with_arms(legs: [&LegPosition<N>; 3], [arm2, arm3]: [Vector2<N>; 2]) -> Self {
        let [leg1, leg2, leg3] = legs;
        let (d1, d2, d3) = (leg1.links.r2, leg2.links.r2, leg3.links.r2);
        let (moment2, moment3) = (N::cross_links(arm2, d2), N::cross_links(arm3, d3));
        let (d1_x_d2, d3_x_d1) = (N::cross_links(d1, d2), N::cross_links(d3, d1));
        Self {
            arm2,
            arm3,
            moment2,
            moment3,
            d1_x_d2,
            d3_x_d1,
            det_a: N::ab_plus_cd(d1_x_d2, moment3, d3_x_d1, moment2),
        }
    }
}
