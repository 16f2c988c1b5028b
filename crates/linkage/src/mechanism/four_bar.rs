//! The four-bar linkage: crank A-B, coupler B-C, rocker D-C. A is the origin, D lies on the x axis.
//!
//! With theta2 and theta3 the directions of the coupler and the rocker, the Jacobian of the loop
//! is [[-l2 s2, l3 s3], [l2 c2, -l3 c3]]: singular at theta2 = theta3 and theta2 = theta3 + pi,
//! where coupler and rocker lie in one line and the crank cannot go on. At a dead point crank and
//! coupler lie in one line: the rocker turns back there, and could not drive the crank.

use super::{Crank, DimensionError, branch, lengths};
use crate::rrr::{self, Rrr, SolveRrr};
use crate::{Drive, LinkMotion, LinkageStatus, PointMotion};
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, Number};

/// Lengths in m and the branch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dimensions {
    /// A-D.
    pub ground: f64,
    /// A-B.
    pub crank: f64,
    /// B-C.
    pub coupler: f64,
    /// D-C.
    pub rocker: f64,
    /// +1: C lies to the left of B -> D.
    pub branch: f64,
}

/// A crank-rocker.
pub const SHIPPED: Dimensions = Dimensions {
    ground: 0.4,
    crank: 0.1,
    coupler: 0.35,
    rocker: 0.25,
    branch: 1.0,
};

/// Grashof's classes: which links can turn fully relative to the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grashof {
    /// The crank is the shortest link and turns fully; the rocker swings.
    CrankRocker,
    /// The rocker is the shortest and turns fully; the crank swings.
    RockerCrank,
    /// The ground is the shortest: crank and rocker turn fully.
    DoubleCrank,
    /// The coupler is the shortest: it turns fully, crank and rocker swing.
    DoubleRocker,
    /// Shortest and longest together are as long as the other two: all links can lie in one line.
    ChangePoint,
    /// Shortest and longest together are longer than the other two: all swing.
    TripleRocker,
}

/// Coefficients of a four-bar linkage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar<N: Number> {
    crank: Crank<N>,
    pivot: PointMotion<N>,
    dyad: Rrr<N>,
}

/// Motion of the links.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// Origin at A, x axis towards B.
    pub crank: LinkMotion<N>,
    /// Origin at B, x axis towards C.
    pub coupler: LinkMotion<N>,
    /// Origin at D, x axis towards C.
    pub rocker: LinkMotion<N>,
    /// The joint C.
    pub joint: PointMotion<N>,
    /// Distance from the singularity, 0 to 1: the sine of the transmission angle.
    pub singularity_distance: N,
}

impl Dimensions {
    /// Checks them.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn check(&self) -> Result<(), DimensionError> {
        lengths([
            ("ground", self.ground),
            ("crank", self.crank),
            ("coupler", self.coupler),
            ("rocker", self.rocker),
        ])?;
        branch("branch", self.branch)
    }

    /// Grashof's class.
    pub fn grashof(&self) -> Grashof {
        let lengths = [self.ground, self.crank, self.coupler, self.rocker];
        let shortest = lengths.iter().copied().fold(f64::INFINITY, f64::min);
        let longest = lengths.iter().copied().fold(0.0, f64::max);
        let others = lengths.iter().sum::<f64>() - shortest - longest;
        // A sum of four rounded lengths cannot tell a difference below its own rounding.
        let rounding = 4.0 * f64::EPSILON * (longest + others);
        let excess = (shortest + longest) - others;
        if excess.abs() <= rounding {
            Grashof::ChangePoint
        } else if excess > 0.0 {
            Grashof::TripleRocker
        } else if shortest == self.crank {
            Grashof::CrankRocker
        } else if shortest == self.rocker {
            Grashof::RockerCrank
        } else if shortest == self.ground {
            Grashof::DoubleCrank
        } else {
            Grashof::DoubleRocker
        }
    }

    /// True when the crank passes every angle without coming to a singular position.
    pub fn turns_fully(&self) -> bool {
        matches!(self.grashof(), Grashof::CrankRocker | Grashof::DoubleCrank)
    }

    /// Crank angles in [0, pi], rad, at which crank and coupler lie in one line: first stretched,
    /// then folded; the linkage mirrored at the ground gives the same angles with the other sign.
    /// `None` where the linkage has no such position.
    pub fn dead_points(&self) -> [Option<f64>; 2] {
        let reach = |from_a: f64| {
            // Folded with the coupler the longer, C lies opposite to the crank's direction.
            let angle = angle_between(self.ground, from_a.abs(), self.rocker)?;
            let turned = core::f64::consts::PI - angle;
            Some(if from_a < 0.0 { turned } else { angle })
        };
        [
            reach(self.crank + self.coupler),
            reach(self.crank - self.coupler),
        ]
    }

    /// Crank angles in [0, pi], rad, of the singular positions: first stretched, theta2 = theta3
    /// + pi, then folded, theta2 = theta3. `None` where the crank passes freely.
    pub fn singular_positions(&self) -> [Option<f64>; 2] {
        let closing = |b_to_d: f64| angle_between(self.ground, self.crank, b_to_d.abs());
        [
            closing(self.coupler + self.rocker),
            closing(self.coupler - self.rocker),
        ]
    }
}

/// The angle between the sides `a` and `b` of the triangle whose third side is `c`.
fn angle_between(a: f64, b: f64, c: f64) -> Option<f64> {
    // Heron's product of the four factors, and twice the scalar product of the two sides.
    let (distinct, over) = ((c - (a - b)) * (c + (a - b)), ((a + b) - c) * ((a + b) + c));
    let four_areas_sq = distinct * over;
    let two_dots = a * a + b * b - c * c;
    (distinct >= 0.0 && over >= 0.0 && a > 0.0 && b > 0.0)
        .then(|| <f64 as Arithmetic>::atan2(<f64 as Arithmetic>::sqrt(four_areas_sq), two_dots))
}

impl<N: Number> FourBar<N> {
    /// Builds the coefficients.
    ///
    /// # Errors
    /// [`DimensionError`].
    pub fn new(dimensions: &Dimensions) -> Result<Self, DimensionError> {
        dimensions.check()?;
        Ok(Self {
            crank: Crank::new(Vector2::new(0.0, 0.0), dimensions.crank),
            pivot: PointMotion::fixed(Vector2::new(N::from_f64(dimensions.ground), N::ZERO)),
            dyad: Rrr::new(dimensions.coupler, dimensions.rocker, dimensions.branch),
        })
    }

    /// The links for the crank driven by `drive`.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn at(&self, drive: &Drive<N>) -> Result<Motion<N>, LinkageStatus> {
        let crank = self.crank.at(drive);
        let dyad = self.dyad.solve(&self.crank.tip(&crank), &self.pivot)?;
        Ok(Motion {
            crank,
            coupler: dyad.first,
            rocker: towards_joint(&dyad, &self.pivot),
            joint: dyad.joint,
            singularity_distance: dyad.singularity_distance,
        })
    }
}

/// The second link of `dyad` seen from its outer joint `end`, with its x axis towards the inner
/// joint.
pub(super) fn towards_joint<N: Number>(
    dyad: &rrr::Motion<N>,
    end: &PointMotion<N>,
) -> LinkMotion<N> {
    LinkMotion {
        origin: *end,
        direction: -dyad.second.direction,
        ..dyad.second
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    fn with(ground: f64, crank: f64, coupler: f64, rocker: f64) -> Dimensions {
        Dimensions {
            ground,
            crank,
            coupler,
            rocker,
            branch: 1.0,
        }
    }

    fn turn(dimensions: &Dimensions, angle: f64) -> Result<Motion<f64>, LinkageStatus> {
        FourBar::new(dimensions).unwrap().at(&Drive {
            angle,
            rate: 1.0,
            acceleration: 0.0,
        })
    }

    #[test]
    fn grashof_classes() {
        assert_eq!(SHIPPED.grashof(), Grashof::CrankRocker);
        assert_eq!(with(0.4, 0.25, 0.35, 0.1).grashof(), Grashof::RockerCrank);
        assert_eq!(with(0.1, 0.4, 0.35, 0.25).grashof(), Grashof::DoubleCrank);
        assert_eq!(with(0.4, 0.35, 0.1, 0.25).grashof(), Grashof::DoubleRocker);
        assert_eq!(with(0.3, 0.1, 0.3, 0.1).grashof(), Grashof::ChangePoint);
        assert_eq!(with(0.4, 0.2, 0.25, 0.3).grashof(), Grashof::TripleRocker);
    }

    #[test]
    fn turns_fully_as_its_class_says() {
        for dimensions in [
            SHIPPED,
            with(0.1, 0.4, 0.35, 0.25),
            with(0.4, 0.25, 0.35, 0.1),
            with(0.4, 0.35, 0.1, 0.25),
            with(0.4, 0.2, 0.25, 0.3),
        ] {
            let all = (0..720).all(|k| turn(&dimensions, f64::from(k) * PI / 360.0).is_ok());
            assert_eq!(all, dimensions.turns_fully(), "{dimensions:?}");
            let free = dimensions.singular_positions() == [None, None];
            assert_eq!(free, dimensions.turns_fully(), "{dimensions:?}");
        }
    }

    #[test]
    fn the_rocker_turns_back_at_dead_points() {
        for point in SHIPPED.dead_points() {
            let angle = point.unwrap();
            let rate = |branch: f64| {
                let at = turn(&Dimensions { branch, ..SHIPPED }, angle).unwrap();
                at.rocker.rate.abs()
            };
            // On the branch with C above the ground, or else on the mirrored one.
            let least = rate(1.0).min(rate(-1.0));
            assert!(least < 1e-14, "{least} at {angle}");
        }
    }

    #[test]
    fn is_singular_where_it_says() {
        let dimensions = with(0.4, 0.25, 0.35, 0.1);
        for angle in dimensions.singular_positions().iter().flatten() {
            let reached = |at: f64| turn(&dimensions, at).map(|at| at.singularity_distance);
            let inside = [reached(angle - 1e-6), reached(angle + 1e-6)];
            assert!(
                inside.iter().filter(|distance| distance.is_err()).count() == 1,
                "{inside:?}"
            );
            let distance = inside.iter().flatten().next().unwrap();
            assert!((1e-4..2e-2).contains(distance), "{distance} at {angle}");
        }
        let count = dimensions.singular_positions().iter().flatten().count();
        assert_eq!(count, 2);
    }

    #[test]
    fn refuses_bad_dimensions() {
        let error = FourBar::<f32>::new(&with(0.4, 0.0, 0.35, 0.25)).unwrap_err();
        assert_eq!(error.name, "crank");
    }
}
