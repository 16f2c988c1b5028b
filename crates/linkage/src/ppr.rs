//! The PPR dyad: a slider on a known guide carries a second guide, on which a link slides that
//! turns about the known joint B. Nothing in it turns relative to the first guide.
//!
//! The first guide passes through A along u = e^(i phi1). All other directions stand at fixed
//! angles to it: phi2 = phi1 - pi + gamma, phi4 = phi2 + delta, phi3 = phi4 + beta - pi.
//!
//! ```text
//! A + z1 e^(i phi1) + z2 e^(i phi2) = B + z4 e^(i phi4) + z3 e^(i phi3)
//! ```
//!
//! In the frame of the guide, with p = B - A and the constants k = -z2 e^(i gamma) - z3
//! e^(i (gamma + delta + beta)) and w = e^(i (gamma + delta)) (the second guide's direction
//! reversed), this is linear with a constant matrix:
//!
//! ```text
//! p = z1 + k + z4 w,   z4 = (p - k)_y / w_y,   z1 = (p - k)_x - w_x z4
//! ```
//!
//! Rates and accelerations follow from those of p in the frame of the guide. There is one
//! solution; the dyad is singular or not once for all, by its construction: the scale-free
//! distance is abs(sin(phi4 - phi1)) = abs(w_y).

use super::LinkageStatus;
use super::motion::{
    DyadMotion, GuideMotion, LinkMotion, PointMotion, SlideMotion, difference,
    relative_acceleration, turned, unit,
};
use nalgebra::Vector2;
use trirrr_core::number::{Number, cross, dot, perpendicular};

/// Coefficients of a PPR dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ppr<N> {
    /// w, in the frame of the guide.
    second: Vector2<N>,
    /// 1 / w_y, or 0 for parallel guides.
    inverse: N,
    /// k, in the frame of the guide.
    offset: Vector2<N>,
}

impl<N: Number> Ppr<N> {
    /// The dyad with arms `z2` and `z3` and the angles `gamma`, `delta` and `beta` (rad).
    pub fn new(z2: f64, gamma: f64, delta: f64, z3: f64, beta: f64) -> Self {
        let offset = -(unit(gamma) * z2) - unit(gamma + delta + beta) * z3;
        Self::from_offsets(-unit(gamma + delta), offset)
    }

    /// The dyad whose second guide points in the `direction` of phi4, and in which B lies at
    /// `offset` from the slider's reference point when z4 is zero; both in the frame of the guide,
    /// the direction a unit vector.
    pub fn from_offsets(direction: Vector2<f64>, offset: Vector2<f64>) -> Self {
        let second = (-direction).map(N::from_f64);
        let singular = second.y == N::ZERO;
        Self {
            second,
            inverse: N::from_f64(if singular { 0.0 } else { -1.0 / direction.y }),
            offset: offset.map(N::from_f64),
        }
    }

    /// z1 and z4 for `p`, the vector A -> B, and the guide's `direction`, a unit vector.
    #[inline]
    pub fn position(&self, p: Vector2<N>, direction: Vector2<N>) -> Result<[N; 2], LinkageStatus> {
        if !(self.second.y.abs() > N::ZERO) {
            return Err(LinkageStatus::Singular);
        }
        Ok(self.resolve(difference(seen_along(direction, p), self.offset)))
    }

    /// The parts of `local` = (first, 0) + second w.
    #[inline(always)]
    fn resolve(&self, local: Vector2<N>) -> [N; 2] {
        let second = local.y * self.inverse;
        [local.x - self.second.x * second, second]
    }

    /// abs(sin(phi4 - phi1)): 0 for parallel guides, 1 for guides at right angles.
    #[inline]
    pub fn singularity_distance(&self) -> N {
        self.second.y.abs()
    }

    /// Solves position, velocity and acceleration for the motions of the guide and of B.
    ///
    /// The first link is the slider between the guides: its origin is its reference point on the
    /// first guide, its x axis lies along that guide. The second has its origin at B and its x axis
    /// along phi4. The slides are z1 and z4.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn solve(
        &self,
        guide: &GuideMotion<N>,
        b: &PointMotion<N>,
    ) -> Result<DyadMotion<N, 2>, LinkageStatus> {
        let p = b.relative_to(&guide.origin);
        let u = guide.direction;
        let lengths = self.position(p.position, u)?;
        let velocity = difference(p.velocity, perpendicular(p.position) * guide.rate);
        let carried = relative_acceleration(p.position, guide.rate, guide.acceleration)
            + perpendicular(velocity) * (guide.rate + guide.rate);
        let acceleration = difference(p.acceleration, carried);
        let [rates, accelerations] =
            [velocity, acceleration].map(|v| self.resolve(seen_along(u, v)));
        let slides = SlideMotion::pair(lengths, rates, accelerations);
        DyadMotion {
            first: guide.with_origin(guide.sliding(&slides[0], N::ZERO)),
            second: LinkMotion {
                direction: turned(-self.second, u),
                ..guide.with_origin(*b)
            },
            slides,
            singularity_distance: self.singularity_distance(),
        }
        .finite()
    }
}

/// The components of `v` along and across `direction`, a unit vector.
#[inline(always)]
fn seen_along<N: Number>(direction: Vector2<N>, v: Vector2<N>) -> Vector2<N> {
    Vector2::new(dot(direction, v), cross(direction, v))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{assert_alike, moving};
    use core::f64::consts::{FRAC_PI_2, PI};
    use trirrr_core::number::Arithmetic;

    #[test]
    fn closes_as_its_definition_says() {
        let (z2, gamma, delta, z3, beta) = (0.3, 1.1, 0.9, 0.2, 0.6);
        let dyad = Ppr::<f64>::new(z2, gamma, delta, z3, beta);
        let (a, b) = (Vector2::new(0.1, -0.2), Vector2::new(0.9, 0.3));
        let phi1 = 0.4;
        let guide = GuideMotion::fixed(a, unit(phi1));
        let at = dyad.solve(&guide, &PointMotion::fixed(b)).unwrap();
        let phi2 = phi1 - PI + gamma;
        let phi4 = phi2 + delta;
        let phi3 = phi4 + beta - PI;
        let left = a + unit(phi1) * at.slides[0].length + unit(phi2) * z2;
        let right = b + unit(phi4) * at.slides[1].length + unit(phi3) * z3;
        assert!((left - right).abs().max() < 4e-16, "{left:?} {right:?}");
        assert!((at.second.direction - unit(phi4)).abs().max() < 4e-16);
        let sine = <f64 as Arithmetic>::sin_cos(phi4 - phi1).0.abs();
        assert!((at.singularity_distance - sine).abs() < 2e-16);
    }

    #[test]
    fn carries_its_joint_as_asked() {
        let dyad = Ppr::<f64>::new(0.3, 1.1, 0.9, 0.2, 0.6);
        let guide = LinkMotion {
            origin: moving(0.2),
            direction: unit(0.3),
            rate: 1.5,
            acceleration: -0.4,
        };
        let b = moving(1.0);
        let at = dyad.solve(&guide, &b).unwrap();
        // From the slider's reference point on, B slides backwards along the second guide.
        let start = at.first.vector(dyad.offset);
        let start = at
            .first
            .origin
            .carried(start, guide.rate, guide.acceleration);
        let [_, slide] = at.slides;
        let back = SlideMotion {
            length: -slide.length,
            rate: -slide.rate,
            acceleration: -slide.acceleration,
        };
        // The slider's own sliding is part of its origin's motion, not of the guide's turning.
        assert_alike(&at.second.with_origin(start).sliding(&back, 0.0), &b, 1e-15);
    }

    #[test]
    fn guides_at_right_angles_and_parallel() {
        let square = Ppr::<f32>::new(0.0, FRAC_PI_2, 0.0, 0.0, 0.0);
        assert_eq!(square.singularity_distance(), 1.0);
        let guide = GuideMotion::fixed(Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0));
        let b = PointMotion::fixed(Vector2::new(0.3f32, 0.4));
        let at = square.solve(&guide, &b).unwrap();
        assert!((at.slides[0].length - 0.3).abs() < 1e-7);
        assert!((at.slides[1].length - 0.4).abs() < 1e-7);
        let parallel = Ppr::<f32>::from_offsets(Vector2::new(1.0, 0.0), Vector2::new(0.0, 0.0));
        assert_eq!(parallel.singularity_distance(), 0.0);
        assert_eq!(parallel.solve(&guide, &b), Err(LinkageStatus::Singular));
    }
}
