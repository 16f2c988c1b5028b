//! The PRP dyad: two sliders on two guides, joined at C. The guides are known.
//!
//! The first guide passes through A along u1 = e^(i phi1), the second through B along
//! u4 = e^(i phi4). An arm leads from each slider to C: z2 at the angle phi2 = phi1 - pi + gamma,
//! z3 at phi3 = phi4 + pi - beta.
//!
//! ```text
//! A + z1 e^(i phi1) + z2 e^(i phi2) = C = B + z4 e^(i phi4) + z3 e^(i phi3)
//! ```
//!
//! The arms stand still in the frames of their guides, so the system is linear in z1 and z4. With
//! s1 = z1 - z2 cos gamma, o1 = -z2 sin gamma, s4 = z4 - z3 cos beta, o4 = z3 sin beta:
//!
//! ```text
//! d = B - A + o4 E u4 - o1 E u1 = s1 u1 - s4 u4
//! s4 = d x u1 / (u1 x u4),   s1 = d . u1 + s4 u1 . u4
//! ```
//!
//! The second form of s1, instead of d x u4 / (u1 x u4), closes the loop to rounding even between
//! guides that are nearly parallel.
//!
//! Velocities and accelerations satisfy the same two equations with, in d's place, what the
//! guides' own motion leaves to the slides. There is one solution, and none where the guides are
//! parallel: the scale-free distance is abs(u1 x u4) = abs(sin(phi4 - phi1)).

use super::LinkageStatus;
use super::motion::{
    DyadMotion, GuideMotion, SlideMotion, difference, relative_acceleration, unit,
};
use nalgebra::Vector2;
use trirrr_core::number::{Number, cross, dot, perpendicular};

/// Coefficients of a PRP dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prp<N> {
    /// From the first slider's reference point to C, along and across the first guide.
    first: Vector2<N>,
    /// From the second slider's reference point to C, along and across the second guide.
    second: Vector2<N>,
}

/// Configuration of a PRP dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrpPosition<N> {
    /// z1 and z4: from A and from B along their guides to the sliders' reference points.
    pub lengths: [N; 2],
    /// A -> C and B -> C.
    pub joint: [Vector2<N>; 2],
    /// u1 and u4 as they were given.
    pub directions: [Vector2<N>; 2],
    /// u1 x u4: zero at the singularity.
    pub determinant: N,
    /// u1 . u4.
    cosine: N,
    /// 1 / (u1 x u4).
    inverse: N,
}

impl<N: Number> PrpPosition<N> {
    /// The parts of `v` = first u1 - second u4.
    #[inline(always)]
    fn resolve(&self, v: Vector2<N>) -> [N; 2] {
        let u1 = self.directions[0];
        let second = cross(v, u1) * self.inverse;
        [dot(v, u1) + second * self.cosine, second]
    }
}

impl<N: Number> Prp<N> {
    /// The dyad with arms `z2` and `z3` at the angles `gamma` and `beta` (rad).
    pub fn new(z2: f64, gamma: f64, z3: f64, beta: f64) -> Self {
        let (first, second) = (unit(gamma) * z2, unit(beta) * z3);
        Self::from_offsets(-first, Vector2::new(-second.x, second.y))
    }

    /// The dyad whose joint C lies at `first` from the first slider's reference point, along and
    /// to the left of the first guide, and at `second` from the second's.
    pub fn from_offsets(first: Vector2<f64>, second: Vector2<f64>) -> Self {
        Self {
            first: first.map(N::from_f64),
            second: second.map(N::from_f64),
        }
    }

    /// The configuration for `d`, the vector A -> B, and the `directions` of the guides, unit
    /// vectors.
    #[inline]
    pub fn position(
        &self,
        d: Vector2<N>,
        directions: [Vector2<N>; 2],
    ) -> Result<PrpPosition<N>, LinkageStatus> {
        let [u1, u4] = directions;
        let determinant = cross(u1, u4);
        if !(determinant.abs() > N::ZERO) {
            return Err(LinkageStatus::Singular);
        }
        let across = [
            perpendicular(u1) * self.first.y,
            perpendicular(u4) * self.second.y,
        ];
        let cosine = dot(u1, u4);
        // The offsets enter in the frame of the first guide, whole: E u1 x u1 = -1, E u4 x u1 =
        // -cosine, E u4 . u1 = -determinant. That, and a division where the rates have a
        // multiplication, keeps the loop's gap small.
        let (o1, o4) = (self.first.y, self.second.y);
        let second = ((cross(d, u1) + o1) - o4 * cosine).div(determinant);
        let first = dot(d, u1) + N::ab_minus_cd(second, cosine, o4, determinant);
        let along = [first, second];
        Ok(PrpPosition {
            lengths: [along[0] - self.first.x, along[1] - self.second.x],
            joint: [u1 * along[0] + across[0], u4 * along[1] + across[1]],
            directions,
            determinant,
            cosine,
            inverse: N::ONE.div(determinant),
        })
    }

    /// abs(u1 x u4): 0 where the guides are parallel, 1 where they are at right angles.
    #[inline]
    pub fn singularity_distance(&self, at: &PrpPosition<N>) -> N {
        at.determinant.abs()
    }

    /// Solves position, velocity and acceleration for the motions of the two guides.
    ///
    /// The links are the two sliders, each with its origin at C and its x axis along its guide, with
    /// which it turns. The slides are z1 and z4.
    ///
    /// # Errors
    /// [`LinkageStatus`].
    pub fn solve(
        &self,
        first: &GuideMotion<N>,
        second: &GuideMotion<N>,
    ) -> Result<DyadMotion<N, 2>, LinkageStatus> {
        let d = second.origin.relative_to(&first.origin);
        let guides = [first, second];
        let at = self.position(d.position, guides.map(|guide| guide.direction))?;
        let [carried1, carried4] = [0, 1].map(|i| perpendicular(at.joint[i]) * guides[i].rate);
        let rates = at.resolve(d.velocity + difference(carried4, carried1));
        let [carried1, carried4] = [0, 1].map(|i| {
            let coriolis = guides[i].rate * (rates[i] + rates[i]);
            relative_acceleration(at.joint[i], guides[i].rate, guides[i].acceleration)
                + perpendicular(at.directions[i]) * coriolis
        });
        let accelerations = at.resolve(d.acceleration + difference(carried4, carried1));
        let slides = SlideMotion::pair(at.lengths, rates, accelerations);
        let from_reference = first.with_origin(first.point(Vector2::new(self.first.x, N::ZERO)));
        let joint = from_reference.sliding(&slides[0], self.first.y);
        DyadMotion {
            first: first.with_origin(joint),
            second: second.with_origin(joint),
            slides,
            singularity_distance: self.singularity_distance(&at),
        }
        .finite()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::motion::tests::{assert_alike, moving};
    use crate::{LinkMotion, PointMotion};
    use core::f64::consts::PI;
    use trirrr_core::number::Arithmetic;

    fn guide(origin: PointMotion<f64>, angle: f64, rate: f64) -> GuideMotion<f64> {
        LinkMotion {
            origin,
            direction: unit(angle),
            rate,
            acceleration: 0.7 * rate,
        }
    }

    #[test]
    fn closes_as_its_definition_says() {
        let (z2, gamma, z3, beta) = (0.3, 1.1, 0.2, 0.6);
        let dyad = Prp::<f64>::new(z2, gamma, z3, beta);
        let a = PointMotion::fixed(Vector2::new(0.1, -0.2));
        let b = PointMotion::fixed(Vector2::new(0.9, 0.3));
        let (phi1, phi4) = (0.4, 2.0);
        let at = dyad
            .solve(&guide(a, phi1, 0.0), &guide(b, phi4, 0.0))
            .unwrap();
        let (phi2, phi3) = (phi1 - PI + gamma, phi4 + PI - beta);
        let left = a.position + unit(phi1) * at.slides[0].length + unit(phi2) * z2;
        let right = b.position + unit(phi4) * at.slides[1].length + unit(phi3) * z3;
        assert!((left - right).abs().max() < 4e-16, "{left:?} {right:?}");
        assert!((left - at.first.origin.position).abs().max() < 4e-16);
        let sine = <f64 as Arithmetic>::sin_cos(phi4 - phi1).0;
        assert!((at.singularity_distance - sine).abs() < 2e-16);
    }

    #[test]
    fn moves_alike_seen_from_either_guide() {
        let offset = Vector2::new(-0.1, 0.25);
        let dyad = Prp::<f64>::from_offsets(Vector2::new(0.05, 0.2), offset);
        let (first, second) = (guide(moving(0.2), 0.3, 1.5), guide(moving(1.0), 1.9, -0.8));
        let at = dyad.solve(&first, &second).unwrap();
        let slide = SlideMotion {
            length: at.slides[1].length + offset.x,
            ..at.slides[1]
        };
        assert_alike(&second.sliding(&slide, offset.y), &at.first.origin, 1e-15);
    }

    #[test]
    fn parallel_guides_are_singular() {
        let dyad = Prp::<f32>::new(0.0, 0.0, 0.0, 0.0);
        let level = Vector2::new(1.0, 0.0);
        let at = |second: Vector2<f32>| {
            let first = GuideMotion::fixed(Vector2::new(0.0, 0.0), level);
            let second = GuideMotion::fixed(Vector2::new(0.0, 1.0), second);
            dyad.solve(&first, &second)
                .map(|at| at.singularity_distance)
        };
        assert_eq!(at(level), Err(LinkageStatus::Singular));
        assert_eq!(at(-level), Err(LinkageStatus::Singular));
        assert_eq!(
            at(Vector2::new(f32::NAN, 0.0)),
            Err(LinkageStatus::Singular)
        );
        assert_eq!(at(Vector2::new(0.0, 1.0)), Ok(1.0));
    }
}
