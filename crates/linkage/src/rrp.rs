//! The RRP dyad (PRR read backwards): a link that turns about A, joined at D to a slider on a
//! guide. A and the guide are known.
//!
//! The guide passes through B in the direction u = e^(i phi2). The slider carries D at the end of
//! an offset z3 that stands at the fixed angle gamma to the guide; the link z4 leads from D to A:
//!
//! ```text
//! D = B + z2 e^(i phi2) + z3 e^(i (phi2 + gamma)),   A = D + z4 e^(i phi4)
//! ```
//!
//! In the frame of the guide, with p = A - B, s = z2 + z3 cos gamma and o = z3 sin gamma:
//!
//! ```text
//! h = u x p - o                      A to the left of D's path
//! q = sqrt((z4 - h) (z4 + h))
//! s = u . p + sigma q,   z2 = s - z3 cos gamma
//! r = A - D = -sigma q u + h E u = z4 e^(i phi4)
//! ```
//!
//! The branch sigma is +1 when D lies ahead of A's foot on its path, seen along the guide. Let v
//! and a be A's velocity and acceleration relative to the point of the guide's body that D passes
//! over (for a, less the Coriolis part 2 s' w E u, w the guide's angular velocity):
//!
//! ```text
//! v = s' u + w4 E r                      s'  = v . r / (u . r)    w4 = u x v / (u . r)
//! a + w4^2 r = s'' u + e4 E r            the same two quotients
//! ```
//!
//! u . r = -sigma q: singular where the link stands across the guide. The scale-free distance is
//! q / z4. Without offset, z3 = 0, D slides on the guide itself; nothing else changes.

use super::LinkageStatus;
use super::motion::{
    DyadMotion, GuideMotion, LinkMotion, PointMotion, SlideMotion, difference,
    relative_acceleration, turned, unit,
};
use nalgebra::Vector2;
use trirrr_core::number::{Number, cross, dot, perpendicular};

/// Coefficients of an RRP dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rrp<N> {
    /// z4
    length: N,
    /// 1 / z4
    inverse_length: N,
    /// z3 cos gamma
    along: N,
    /// o = z3 sin gamma
    across: N,
    /// sigma
    branch: N,
}

/// Configuration of an RRP dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RrpPosition<N> {
    /// u: the guide's direction as it was given.
    pub direction: Vector2<N>,
    /// z2: from B along the guide to the foot of the offset.
    pub length: N,
    /// B -> D.
    pub slider: Vector2<N>,
    /// D -> A, of length z4.
    pub r: Vector2<N>,
    /// u . r = -sigma q: zero at the singularity, at most z4 in size.
    pub along_guide: N,
    /// 1 / (u . r).
    inverse: N,
}

impl<N: Number> Rrp<N> {
    /// The dyad with the link `z4`, positive, the offset `z3` at the angle `gamma` (rad) to the
    /// guide, and the sign `branch`.
    pub fn new(z4: f64, z3: f64, gamma: f64, branch: f64) -> Self {
        let offset = unit(gamma) * z3;
        Self::from_offsets(z4, offset.x, offset.y, branch)
    }

    /// The dyad whose joint D lies by `along` ahead of the slider's reference point and by
    /// `across` to the left of the guide.
    pub fn from_offsets(z4: f64, along: f64, across: f64, branch: f64) -> Self {
        Self {
            length: N::from_f64(z4),
            inverse_length: N::from_f64(1.0 / z4),
            along: N::from_f64(along),
            across: N::from_f64(across),
            branch: N::from_f64(branch),
        }
    }

    /// The configuration for `p`, the vector B -> A, and the guide's `direction`, a unit vector.
    #[inline]
    pub fn position(
        &self,
        p: Vector2<N>,
        direction: Vector2<N>,
    ) -> Result<RrpPosition<N>, LinkageStatus> {
        let height = cross(direction, p) - self.across;
        let q_sq = (self.length - height) * (self.length + height);
        if !(q_sq > N::ZERO) {
            return Err(if q_sq == N::ZERO {
                LinkageStatus::Singular
            } else {
                LinkageStatus::Unreachable
            });
        }
        let ahead = self.branch * q_sq.sqrt();
        let r = turned(Vector2::new(-ahead, height), direction);
        Ok(RrpPosition {
            direction,
            length: (dot(direction, p) - self.along) + ahead,
            slider: difference(p, r),
            r,
            along_guide: -ahead,
            inverse: N::ONE.div(-ahead),
        })
    }

    /// The sliding and the turning part of `v` = slide u + turn E r.
    #[inline(always)]
    fn resolve(&self, at: &RrpPosition<N>, v: Vector2<N>) -> (N, N) {
        (
            dot(v, at.r) * at.inverse,
            cross(at.direction, v) * at.inverse,
        )
    }

    /// q / z4: 0 where the link stands across the guide, 1 where it lies along it.
    #[inline]
    pub fn singularity_distance(&self, at: &RrpPosition<N>) -> N {
        at.along_guide.abs() * self.inverse_length
    }

    /// Solves position, velocity and acceleration for the motions of A and of the guide.
    ///
    /// Both links have their origin at D. The x axis of the first points towards A, that of the
    /// second, the slider, along the guide, with which the slider turns. The slide is z2.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn solve(
        &self,
        a: &PointMotion<N>,
        guide: &GuideMotion<N>,
    ) -> Result<DyadMotion<N, 1>, LinkageStatus> {
        let p = a.relative_to(&guide.origin);
        let at = self.position(p.position, guide.direction)?;
        let carried = perpendicular(at.slider) * guide.rate;
        let (slide_rate, rate) = self.resolve(&at, difference(p.velocity, carried));
        let carried = relative_acceleration(at.slider, guide.rate, guide.acceleration)
            + perpendicular(at.direction) * (guide.rate * (slide_rate + slide_rate));
        let toward = at.r * (rate * rate);
        let (slide_acceleration, acceleration) =
            self.resolve(&at, difference(p.acceleration, carried) + toward);
        // D from A, as the link carries it: both ways give the same motion, this one without the
        // guide's distance from A.
        let joint = a.carried(-at.r, rate, acceleration);
        DyadMotion {
            first: LinkMotion {
                origin: joint,
                direction: at.r * self.inverse_length,
                rate,
                acceleration,
            },
            second: guide.with_origin(joint),
            slides: [SlideMotion {
                length: at.length,
                rate: slide_rate,
                acceleration: slide_acceleration,
            }],
            singularity_distance: self.singularity_distance(&at),
        }
        .finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{assert_alike, moving};

    #[test]
    fn closes_as_its_definition_says_on_both_branches() {
        let (z4, z3, gamma, phi2) = (0.5, 0.2, 1.9, 0.3);
        let (a, b) = (Vector2::new(0.4, 0.7), Vector2::new(-0.2, 0.1));
        let mut lengths = [0.0; 2];
        for (length, branch) in lengths.iter_mut().zip([1.0, -1.0]) {
            let dyad = Rrp::<f64>::new(z4, z3, gamma, branch);
            let at = dyad.position(a - b, unit(phi2)).unwrap();
            let d = b + unit(phi2) * at.length + unit(phi2 + gamma) * z3;
            assert!((d + at.r - a).abs().max() < 4e-16);
            assert!((dot(at.r, at.r) - z4 * z4).abs() < 4e-16);
            assert!((at.slider + b - d).abs().max() < 4e-16);
            *length = at.length;
        }
        assert!(lengths[0] > lengths[1]);
    }

    #[test]
    fn slider_and_link_meet_in_the_joint() {
        let (along, across) = (0.05, -0.1);
        let dyad = Rrp::<f64>::from_offsets(0.8, along, across, -1.0);
        let guide = LinkMotion {
            origin: moving(-0.1),
            direction: unit(0.8),
            rate: 1.4,
            acceleration: -2.2,
        };
        let at = dyad.solve(&moving(0.4), &guide).unwrap();
        let slide = SlideMotion {
            length: at.slides[0].length + along,
            ..at.slides[0]
        };
        assert_alike(&guide.sliding(&slide, across), &at.first.origin, 4e-16);
        let a = at.first.point(Vector2::new(0.8, 0.0));
        assert_alike(&a, &moving(0.4), 4e-16);
    }

    /// Without offset: a link of 5, its joint 3 above the guide.
    #[test]
    fn without_offset_the_joint_slides_on_the_guide() {
        for (branch, x) in [(1.0, 5.0f32), (-1.0, -3.0)] {
            let dyad = Rrp::<f32>::new(5.0, 0.0, 1.0, branch);
            let level = Vector2::new(1.0, 0.0);
            let at = dyad.position(Vector2::new(1.0, 3.0), level).unwrap();
            assert_eq!(at.length, x);
            assert_eq!(at.slider, Vector2::new(x, 0.0));
            assert!((dyad.singularity_distance(&at) - 0.8).abs() < 1e-7);
        }
    }

    #[test]
    fn says_what_is_out_of_reach() {
        let dyad = Rrp::<f32>::from_offsets(5.0, 0.0, 1.0, 1.0);
        let reach = |y: f32| {
            let level = Vector2::new(1.0, 0.0);
            dyad.position(Vector2::new(7.0, y), level)
                .map(|at| at.length)
        };
        assert_eq!(reach(6.0), Err(LinkageStatus::Singular));
        assert_eq!(reach(-4.0), Err(LinkageStatus::Singular));
        assert_eq!(reach(6.1), Err(LinkageStatus::Unreachable));
        assert_eq!(reach(f32::NAN), Err(LinkageStatus::Unreachable));
        assert_eq!(reach(1.0), Ok(12.0));
        // The joint at rest on the guide's own point.
        let through = Rrp::<f32>::from_offsets(5.0, 0.0, 0.0, 1.0);
        let on_guide = through.position(Vector2::new(0.0, 0.0), Vector2::new(0.0, 1.0));
        assert_eq!(on_guide.map(|at| at.length), Ok(5.0));
    }
}
