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
//! s1 = d x u4 / (u1 x u4),   s4 = d x u1 / (u1 x u4)
//! ```
//!
//! Velocities and accelerations satisfy the same two equations with, in d's place, what the
//! guides' own motion leaves to the slides. There is one solution, and none where the guides are
//! parallel: the scale-free distance is abs(u1 x u4) = abs(sin(phi4 - phi1)).

use super::LinkageStatus;
use super::motion::{
    GuideMotion, LinkMotion, PointMotion, SlideMotion, difference, relative_acceleration,
};
use crate::number::{Number, cross, perpendicular};
use nalgebra::Vector2;

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
    /// 1 / (u1 x u4).
    inverse: N,
}

/// What the dyad does for a motion of the guides.
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

impl<N: Number> Prp<N> {
    /// The dyad with arms `z2` and `z3` at the angles `gamma` and `beta` (rad).
    pub fn new(z2: f64, gamma: f64, z3: f64, beta: f64) -> Self {
        let (sin_gamma, cos_gamma) = <f64 as Number>::sin_cos(gamma);
        let (sin_beta, cos_beta) = <f64 as Number>::sin_cos(beta);
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
        let inverse = N::ONE.div(determinant);
        let between = d + difference(across[1], across[0]);
        let along = [cross(between, u4) * inverse, cross(between, u1) * inverse];
        Ok(Position {
            lengths: [along[0] - self.first.x, along[1] - self.second.x],
            joint: [u1 * along[0] + across[0], u4 * along[1] + across[1]],
            directions,
            determinant,
            inverse,
        })
    }

    /// Rates of z1 and z4 for `v`, the velocity of B relative to A, and the guides' turning.
    #[inline]
    pub fn rates(&self, at: &Position<N>, v: Vector2<N>, turns: &[Turn<N>; 2]) -> [N; 2] {
        let carried = |i: usize| perpendicular(at.joint[i]) * turns[i].rate;
        self.resolve(at, v + difference(carried(1), carried(0)))
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
        self.resolve(at, a + difference(carried(1), carried(0)))
    }

    /// The parts of `v` = first u1 - second u4.
    #[inline(always)]
    fn resolve(&self, at: &Position<N>, v: Vector2<N>) -> [N; 2] {
        let [u1, u4] = at.directions;
        [cross(v, u4) * at.inverse, cross(v, u1) * at.inverse]
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
            && motion.second_slide.is_finite();
        finite.then_some(motion).ok_or(LinkageStatus::OutOfRange)
    }
}
