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
    GuideMotion, LinkMotion, PointMotion, SlideMotion, difference, relative_acceleration,
};
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, Number, cross, dot, perpendicular};

/// Coefficients of a PRP dyad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prp<N> {
    /// From the first slider's reference point to C, along and across the first guide.
    first: Vector2<N>,
    /// From the second slider's reference point to C, along and across the second guide.
    second: Vector2<N>,
}

/// A dyad's configuration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Position<N> {
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

/// Motion of the links for a motion of the guides.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// C.
    pub joint: PointMotion<N>,
    /// The slider on the first guide; origin at C, x axis along the guide, with which it turns.
    pub first: LinkMotion<N>,
    /// The slider on the second guide, likewise.
    pub second: LinkMotion<N>,
    /// z1.
    pub first_slide: SlideMotion<N>,
    /// z4.
    pub second_slide: SlideMotion<N>,
    /// Distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

/// Angular velocity and acceleration of a guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<N> {
    /// rad/s.
    pub rate: N,
    /// rad/s^2.
    pub acceleration: N,
}

impl<N: Number> Position<N> {
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
        let (sin_gamma, cos_gamma) = <f64 as Arithmetic>::sin_cos(gamma);
        let (sin_beta, cos_beta) = <f64 as Arithmetic>::sin_cos(beta);
        Self::from_offsets(
            Vector2::new(-(z2 * cos_gamma), -(z2 * sin_gamma)),
            Vector2::new(-(z3 * cos_beta), z3 * sin_beta),
        )
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
    ) -> Result<Position<N>, LinkageStatus> {
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
        Ok(Position {
            lengths: [along[0] - self.first.x, along[1] - self.second.x],
            joint: [u1 * along[0] + across[0], u4 * along[1] + across[1]],
            directions,
            determinant,
            cosine,
            inverse: N::ONE.div(determinant),
        })
    }

    /// Rates of z1 and z4 for `v`, the velocity of B relative to A, and the guides' turning.
    #[inline]
    pub fn rates(&self, at: &Position<N>, v: Vector2<N>, turns: &[Turn<N>; 2]) -> [N; 2] {
        let carried = |i: usize| perpendicular(at.joint[i]) * turns[i].rate;
        at.resolve(v + difference(carried(1), carried(0)))
    }

    /// Accelerations of z1 and z4 for `a`, the acceleration of B relative to A.
    #[inline]
    pub fn accelerations(
        &self,
        at: &Position<N>,
        rates: &[N; 2],
        a: Vector2<N>,
        turns: &[Turn<N>; 2],
    ) -> [N; 2] {
        let carried = |i: usize| {
            let coriolis = turns[i].rate * (rates[i] + rates[i]);
            relative_acceleration(at.joint[i], turns[i].rate, turns[i].acceleration)
                + perpendicular(at.directions[i]) * coriolis
        };
        at.resolve(a + difference(carried(1), carried(0)))
    }

    /// abs(u1 x u4): 0 where the guides are parallel, 1 where they are at right angles.
    #[inline]
    pub fn singularity_distance(&self, at: &Position<N>) -> N {
        at.determinant.abs()
    }

    /// All of it for the motions of the two guides.
    ///
    /// # Errors
    /// [`LinkageStatus`]; what is returned is finite.
    pub fn solve(
        &self,
        first: &GuideMotion<N>,
        second: &GuideMotion<N>,
    ) -> Result<Motion<N>, LinkageStatus> {
        let d = second.origin.relative_to(&first.origin);
        let turn = |guide: &GuideMotion<N>| Turn {
            rate: guide.rate,
            acceleration: guide.acceleration,
        };
        let turns = [turn(first), turn(second)];
        let at = self.position(d.position, [first.direction, second.direction])?;
        let rates = self.rates(&at, d.velocity, &turns);
        let acc = self.accelerations(&at, &rates, d.acceleration, &turns);
        let slide = |i: usize| SlideMotion {
            length: at.lengths[i],
            rate: rates[i],
            acceleration: acc[i],
        };
        let from_reference = LinkMotion {
            origin: first.point(Vector2::new(self.first.x, N::ZERO)),
            ..*first
        };
        let joint = from_reference.sliding(&slide(0), self.first.y);
        let on = |guide: &GuideMotion<N>| LinkMotion {
            origin: joint,
            ..*guide
        };
        let motion = Motion {
            joint,
            first: on(first),
            second: on(second),
            first_slide: slide(0),
            second_slide: slide(1),
            singularity_distance: self.singularity_distance(&at),
        };
        let finite = motion.first.is_finite()
            && motion.second.is_finite()
            && motion.first_slide.is_finite()
            && motion.second_slide.is_finite()
            && motion.singularity_distance.is_finite();
        finite.then_some(motion).ok_or(LinkageStatus::OutOfRange)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::PI;

    fn unit(angle: f64) -> Vector2<f64> {
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
        Vector2::new(cos, sin)
    }

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
        let left = a.position + unit(phi1) * at.first_slide.length + unit(phi2) * z2;
        let right = b.position + unit(phi4) * at.second_slide.length + unit(phi3) * z3;
        assert!((left - right).abs().max() < 4e-16, "{left:?} {right:?}");
        assert!((left - at.joint.position).abs().max() < 4e-16);
        let sine = <f64 as Arithmetic>::sin_cos(phi4 - phi1).0;
        assert!((at.singularity_distance - sine).abs() < 2e-16);
    }

    #[test]
    fn moves_alike_seen_from_either_guide() {
        let offset = Vector2::new(-0.1, 0.25);
        let dyad = Prp::<f64>::from_offsets(Vector2::new(0.05, 0.2), offset);
        let moving = |x: f64| PointMotion {
            position: Vector2::new(x, 0.3 - x),
            velocity: Vector2::new(0.5, -x),
            acceleration: Vector2::new(x, 2.0),
        };
        let (first, second) = (guide(moving(0.2), 0.3, 1.5), guide(moving(1.0), 1.9, -0.8));
        let at = dyad.solve(&first, &second).unwrap();
        let slide = SlideMotion {
            length: at.second_slide.length + offset.x,
            ..at.second_slide
        };
        let joint = second.sliding(&slide, offset.y);
        assert!((joint.position - at.joint.position).abs().max() < 1e-15);
        assert!((joint.velocity - at.joint.velocity).abs().max() < 1e-14);
        assert!((joint.acceleration - at.joint.acceleration).abs().max() < 1e-13);
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
