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
    GuideMotion, LinkMotion, PointMotion, SlideMotion, difference, relative_acceleration, turned,
};
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, Number, cross, dot, perpendicular};

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

/// z1 and z4, or their rates, or their accelerations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slides<N> {
    /// z1, along the first guide.
    pub first: N,
    /// z4, along the second guide.
    pub second: N,
}

/// Motion of the links for a motion of the guide and of B.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion<N> {
    /// The slider between the guides; origin at its reference point on the first guide, x axis
    /// along that guide, with which it turns.
    pub slider: LinkMotion<N>,
    /// The link about B; origin at B, x axis along phi4.
    pub link: LinkMotion<N>,
    /// z1.
    pub first_slide: SlideMotion<N>,
    /// z4.
    pub second_slide: SlideMotion<N>,
    /// Distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

impl<N: Number> Ppr<N> {
    /// The dyad with arms `z2` and `z3` and the angles `gamma`, `delta` and `beta` (rad).
    pub fn new(z2: f64, gamma: f64, delta: f64, z3: f64, beta: f64) -> Self {
        let unit = |angle: f64| {
            let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
            Vector2::new(cos, sin)
        };
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

    /// The configuration for `p`, the vector A -> B, and the guide's `direction`, a unit vector.
    #[inline]
    pub fn position(
        &self,
        p: Vector2<N>,
        direction: Vector2<N>,
    ) -> Result<Slides<N>, LinkageStatus> {
        if !(self.second.y.abs() > N::ZERO) {
            return Err(LinkageStatus::Singular);
        }
        let local = Vector2::new(dot(direction, p), cross(direction, p));
        Ok(self.resolve(difference(local, self.offset)))
    }

    /// Rates for the vector `p` = A -> B, its velocity `v`, and the guide's direction and angular
    /// velocity.
    #[inline]
    pub fn rates(
        &self,
        p: Vector2<N>,
        v: Vector2<N>,
        direction: Vector2<N>,
        guide_rate: N,
    ) -> Slides<N> {
        let seen = difference(v, perpendicular(p) * guide_rate);
        self.resolve(Vector2::new(dot(direction, seen), cross(direction, seen)))
    }

    /// Accelerations for the vector `p` = A -> B with its velocity and its acceleration, and the
    /// guide's motion.
    #[inline]
    pub fn accelerations(&self, p: &PointMotion<N>, guide: &GuideMotion<N>) -> Slides<N> {
        let seen_velocity = difference(p.velocity, perpendicular(p.position) * guide.rate);
        let carried = relative_acceleration(p.position, guide.rate, guide.acceleration)
            + perpendicular(seen_velocity) * (guide.rate + guide.rate);
        let seen = difference(p.acceleration, carried);
        let direction = guide.direction;
        self.resolve(Vector2::new(dot(direction, seen), cross(direction, seen)))
    }

    /// The parts of `local` = (first, 0) + second w.
    #[inline(always)]
    fn resolve(&self, local: Vector2<N>) -> Slides<N> {
        let second = local.y * self.inverse;
        Slides {
            first: local.x - self.second.x * second,
            second,
        }
    }

    /// abs(sin(phi4 - phi1)): 0 for parallel guides, 1 for guides at right angles.
    #[inline]
    pub fn singularity_distance(&self) -> N {
        self.second.y.abs()
    }

    /// All of it for the motions of the guide and of B.
    ///
    /// # Errors
    /// [`LinkageStatus`]; what is returned is finite.
    pub fn solve(
        &self,
        guide: &GuideMotion<N>,
        b: &PointMotion<N>,
    ) -> Result<Motion<N>, LinkageStatus> {
        let p = b.relative_to(&guide.origin);
        let at = self.position(p.position, guide.direction)?;
        let rates = self.rates(p.position, p.velocity, guide.direction, guide.rate);
        let acc = self.accelerations(&p, guide);
        let slide = |length, rate, acceleration| SlideMotion {
            length,
            rate,
            acceleration,
        };
        let first_slide = slide(at.first, rates.first, acc.first);
        let motion = Motion {
            slider: LinkMotion {
                origin: guide.sliding(&first_slide, N::ZERO),
                ..*guide
            },
            link: LinkMotion {
                origin: *b,
                direction: turned(-self.second, guide.direction),
                ..*guide
            },
            first_slide,
            second_slide: slide(at.second, rates.second, acc.second),
            singularity_distance: self.singularity_distance(),
        };
        let finite = motion.slider.is_finite()
            && motion.link.is_finite()
            && motion.first_slide.is_finite()
            && motion.second_slide.is_finite()
            && motion.singularity_distance.is_finite();
        finite.then_some(motion).ok_or(LinkageStatus::OutOfRange)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{FRAC_PI_2, PI};

    fn unit(angle: f64) -> Vector2<f64> {
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
        Vector2::new(cos, sin)
    }

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
        let left = a + unit(phi1) * at.first_slide.length + unit(phi2) * z2;
        let right = b + unit(phi4) * at.second_slide.length + unit(phi3) * z3;
        assert!((left - right).abs().max() < 4e-16, "{left:?} {right:?}");
        assert!((at.link.direction - unit(phi4)).abs().max() < 4e-16);
        let sine = <f64 as Arithmetic>::sin_cos(phi4 - phi1).0.abs();
        assert!((at.singularity_distance - sine).abs() < 2e-16);
    }

    #[test]
    fn carries_its_joint_as_asked() {
        let dyad = Ppr::<f64>::new(0.3, 1.1, 0.9, 0.2, 0.6);
        let moving = |x: f64| PointMotion {
            position: Vector2::new(x, 0.3 - x),
            velocity: Vector2::new(0.5, -x),
            acceleration: Vector2::new(x, 2.0),
        };
        let guide = LinkMotion {
            origin: moving(0.2),
            direction: unit(0.3),
            rate: 1.5,
            acceleration: -0.4,
        };
        let b = moving(1.0);
        let at = dyad.solve(&guide, &b).unwrap();
        // From the slider's reference point on, B slides backwards along the second guide.
        let start = at.slider.vector(dyad.offset);
        let second = LinkMotion {
            origin: at
                .slider
                .origin
                .carried(start, guide.rate, guide.acceleration),
            ..at.link
        };
        let back = SlideMotion {
            length: -at.second_slide.length,
            rate: -at.second_slide.rate,
            acceleration: -at.second_slide.acceleration,
        };
        let joint = second.sliding(&back, 0.0);
        assert!((joint.position - b.position).abs().max() < 1e-15);
        // The slider's own sliding is part of its origin's motion, not of the guide's turning.
        assert!((joint.velocity - b.velocity).abs().max() < 1e-14);
        assert!((joint.acceleration - b.acceleration).abs().max() < 1e-13);
    }

    #[test]
    fn guides_at_right_angles_and_parallel() {
        let square = Ppr::<f32>::new(0.0, FRAC_PI_2, 0.0, 0.0, 0.0);
        assert_eq!(square.singularity_distance(), 1.0);
        let guide = GuideMotion::fixed(Vector2::new(0.0, 0.0), Vector2::new(1.0, 0.0));
        let b = PointMotion::fixed(Vector2::new(0.3f32, 0.4));
        let at = square.solve(&guide, &b).unwrap();
        assert!((at.first_slide.length - 0.3).abs() < 1e-7);
        assert!((at.second_slide.length - 0.4).abs() < 1e-7);
        let parallel = Ppr::<f32>::from_offsets(Vector2::new(1.0, 0.0), Vector2::new(0.0, 0.0));
        assert_eq!(parallel.singularity_distance(), 0.0);
        assert_eq!(parallel.solve(&guide, &b), Err(LinkageStatus::Singular));
    }
}
