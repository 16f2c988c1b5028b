//! The four-bar linkage: crank A-B, coupler B-C, rocker D-C. A is the origin, D lies on the x axis.
//!
//! With theta2 and theta3 the directions of the coupler and the rocker, the Jacobian of the loop
//! is [[-l2 s2, l3 s3], [l2 c2, -l3 c3]]: singular at theta2 = theta3 and theta2 = theta3 + pi,
//! where coupler and rocker lie in one line and the crank cannot go on. At a dead point crank and
//! coupler lie in one line: the rocker turns back there, and could not drive the crank.

use trirrr_core::number::Arithmetic;

/// A four-bar linkage by its lengths, m, all positive.
///
/// A [`Crank`](crate::Crank) and an [`Rrr`](crate::rrr::Rrr) solve its motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FourBar {
    /// A-D.
    pub ground: f64,
    /// A-B.
    pub crank: f64,
    /// B-C.
    pub coupler: f64,
    /// D-C.
    pub rocker: f64,
}

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

impl FourBar {
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rrr::{Rrr, SolveRrr};
    use crate::{Crank, Drive, DyadMotion, LinkageStatus, PointMotion};
    use core::f64::consts::PI;
    use nalgebra::Vector2;

    const CRANK_ROCKER: FourBar = with(0.4, 0.1, 0.35, 0.25);

    const fn with(ground: f64, crank: f64, coupler: f64, rocker: f64) -> FourBar {
        FourBar {
            ground,
            crank,
            coupler,
            rocker,
        }
    }

    /// The dyad of coupler and rocker with the crank at `angle`, turning at 1 rad/s.
    fn turn(
        linkage: &FourBar,
        branch: f64,
        angle: f64,
    ) -> Result<DyadMotion<f64, 0>, LinkageStatus> {
        let crank = Crank::new(Vector2::new(0.0, 0.0), linkage.crank);
        let link = crank.at(&Drive {
            angle,
            rate: 1.0,
            acceleration: 0.0,
        });
        let pivot = PointMotion::fixed(Vector2::new(linkage.ground, 0.0));
        Rrr::new(linkage.coupler, linkage.rocker, branch).solve(&crank.tip(&link), &pivot)
    }

    #[test]
    fn grashof_classes() {
        assert_eq!(CRANK_ROCKER.grashof(), Grashof::CrankRocker);
        assert_eq!(with(0.4, 0.25, 0.35, 0.1).grashof(), Grashof::RockerCrank);
        assert_eq!(with(0.1, 0.4, 0.35, 0.25).grashof(), Grashof::DoubleCrank);
        assert_eq!(with(0.4, 0.35, 0.1, 0.25).grashof(), Grashof::DoubleRocker);
        assert_eq!(with(0.3, 0.1, 0.3, 0.1).grashof(), Grashof::ChangePoint);
        assert_eq!(with(0.4, 0.2, 0.25, 0.3).grashof(), Grashof::TripleRocker);
    }

    #[test]
    fn turns_fully_as_its_class_says() {
        for linkage in [
            CRANK_ROCKER,
            with(0.1, 0.4, 0.35, 0.25),
            with(0.4, 0.25, 0.35, 0.1),
            with(0.4, 0.35, 0.1, 0.25),
            with(0.4, 0.2, 0.25, 0.3),
        ] {
            let all = (0..720).all(|k| turn(&linkage, 1.0, f64::from(k) * PI / 360.0).is_ok());
            assert_eq!(all, linkage.turns_fully(), "{linkage:?}");
            let free = linkage.singular_positions() == [None, None];
            assert_eq!(free, linkage.turns_fully(), "{linkage:?}");
        }
    }

    #[test]
    fn the_rocker_turns_back_at_dead_points() {
        for point in CRANK_ROCKER.dead_points() {
            let angle = point.unwrap();
            let rate = |branch: f64| {
                let at = turn(&CRANK_ROCKER, branch, angle).unwrap();
                at.second.rate.abs()
            };
            // On the branch with C above the ground, or else on the mirrored one.
            let least = rate(1.0).min(rate(-1.0));
            assert!(least < 1e-14, "{least} at {angle}");
        }
    }

    #[test]
    fn is_singular_where_it_says() {
        let linkage = with(0.4, 0.25, 0.35, 0.1);
        for angle in linkage.singular_positions().iter().flatten() {
            let reached = |at: f64| turn(&linkage, 1.0, at).map(|at| at.singularity_distance);
            let inside = [reached(angle - 1e-6), reached(angle + 1e-6)];
            assert!(
                inside.iter().filter(|distance| distance.is_err()).count() == 1,
                "{inside:?}"
            );
            let distance = inside.iter().flatten().next().unwrap();
            assert!((1e-4..2e-2).contains(distance), "{distance} at {angle}");
        }
        let count = linkage.singular_positions().iter().flatten().count();
        assert_eq!(count, 2);
    }
}
