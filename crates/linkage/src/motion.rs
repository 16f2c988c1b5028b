//! Motions: of a point, of a link, of a slider along its guide, of a dyad; drives and cranks.
//!
//! Points of one link are tied by Rivals' theorem. With r the vector from A to B, both fixed in a
//! link of angular velocity w and angular acceleration e, and E the turn by +90 degrees:
//!
//! ```text
//! v_B = v_A + w E r
//! a_B = a_A + e E r - w^2 r
//! ```

use crate::status::LinkageStatus;
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, Number, perpendicular};

/// Motion of a point in the fixed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointMotion<N> {
    /// Position in the fixed frame, m.
    pub position: Vector2<N>,
    /// Velocity, m/s.
    pub velocity: Vector2<N>,
    /// Acceleration, m/s^2.
    pub acceleration: Vector2<N>,
}

/// Motion of a link: of a frame fixed in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkMotion<N> {
    /// The frame's origin, a point of the link.
    pub origin: PointMotion<N>,
    /// The frame's x axis, a unit vector.
    pub direction: Vector2<N>,
    /// Angular velocity, positive counter-clockwise, rad/s.
    pub rate: N,
    /// Angular acceleration, positive counter-clockwise, rad/s^2.
    pub acceleration: N,
}

/// Motion of a guide: the line through the origin along the direction of a link's frame.
pub type GuideMotion<N> = LinkMotion<N>;

/// Motion along a guide.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SlideMotion<N> {
    /// Distance along the guide, with sign, m.
    pub length: N,
    /// Its rate, m/s.
    pub rate: N,
    /// Its second derivative, m/s^2.
    pub acceleration: N,
}

/// Motion of a dyad: of its two links, of its slides, and its distance from the singularity. Every
/// value that a dyad's `solve` returns is finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DyadMotion<N, const SLIDES: usize> {
    /// The link at the first end.
    pub first: LinkMotion<N>,
    /// The link at the second end.
    pub second: LinkMotion<N>,
    /// The slides, from the first end to the second.
    pub slides: [SlideMotion<N>; SLIDES],
    /// Scale-free distance from the singularity, 0 to 1.
    pub singularity_distance: N,
}

/// A driven angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive<N: Number> {
    /// Counter-clockwise from the fixed x axis.
    pub angle: N::Angle,
    /// rad/s.
    pub rate: N,
    /// rad/s^2.
    pub acceleration: N,
}

/// A driven link about a fixed centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Crank<N> {
    /// Its fixed joint.
    pub centre: Vector2<N>,
    /// From the centre to the tip, m.
    pub length: N,
}

/// The unit vector at `angle`, rad.
pub(super) fn unit(angle: f64) -> Vector2<f64> {
    let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle);
    Vector2::new(cos, sin)
}

/// a - b, component by component.
#[inline(always)]
pub(super) fn difference<N: Number>(a: Vector2<N>, b: Vector2<N>) -> Vector2<N> {
    Vector2::new(a.x - b.x, a.y - b.y)
}

/// `v` by the turn whose cosine and sine are the components of `turn`.
#[inline(always)]
pub(super) fn turned<N: Number>(v: Vector2<N>, turn: Vector2<N>) -> Vector2<N> {
    Vector2::new(
        N::ab_minus_cd(turn.x, v.x, turn.y, v.y),
        N::ab_plus_cd(turn.y, v.x, turn.x, v.y),
    )
}

/// e E r - w^2 r: the acceleration of the end of `r`, fixed in a link, relative to its start.
#[inline(always)]
pub(super) fn relative_acceleration<N: Number>(
    r: Vector2<N>,
    rate: N,
    acceleration: N,
) -> Vector2<N> {
    let square = rate * rate;
    Vector2::new(
        -N::ab_plus_cd(acceleration, r.y, square, r.x),
        N::ab_minus_cd(acceleration, r.x, square, r.y),
    )
}

impl<N: Number> PointMotion<N> {
    /// A point that stands still.
    #[inline]
    pub fn fixed(position: Vector2<N>) -> Self {
        let zero = Vector2::new(N::ZERO, N::ZERO);
        Self {
            position,
            velocity: zero,
            acceleration: zero,
        }
    }

    /// Position, velocity and acceleration of this point relative to `other`'s.
    #[inline]
    pub fn relative_to(&self, other: &Self) -> Self {
        Self {
            position: difference(self.position, other.position),
            velocity: difference(self.velocity, other.velocity),
            acceleration: difference(self.acceleration, other.acceleration),
        }
    }

    /// The motion of the end of `r`, which starts at this point and is fixed in a link that turns
    /// at `rate` with `acceleration`.
    #[inline]
    pub fn carried(&self, r: Vector2<N>, rate: N, acceleration: N) -> Self {
        let along = perpendicular(r);
        Self {
            position: self.position + r,
            velocity: self.velocity + along * rate,
            acceleration: self.acceleration + relative_acceleration(r, rate, acceleration),
        }
    }

    /// True when every component is finite.
    pub fn is_finite(&self) -> bool {
        let finite = |v: Vector2<N>| v.x.is_finite() && v.y.is_finite();
        finite(self.position) && finite(self.velocity) && finite(self.acceleration)
    }
}

impl<N: Number> LinkMotion<N> {
    /// A link, or a guide, that stands still.
    #[inline]
    pub fn fixed(origin: Vector2<N>, direction: Vector2<N>) -> Self {
        Self {
            origin: PointMotion::fixed(origin),
            direction,
            rate: N::ZERO,
            acceleration: N::ZERO,
        }
    }

    /// The point at `local` in the link's frame.
    #[inline]
    pub fn point(&self, local: Vector2<N>) -> PointMotion<N> {
        self.origin
            .carried(self.vector(local), self.rate, self.acceleration)
    }

    /// The frame fixed in the same link, or in one that turns alike, at another `origin`.
    #[inline]
    pub fn with_origin(&self, origin: PointMotion<N>) -> Self {
        Self { origin, ..*self }
    }

    /// A vector given in the link's frame, in the fixed frame.
    #[inline]
    pub fn vector(&self, local: Vector2<N>) -> Vector2<N> {
        turned(local, self.direction)
    }

    /// The frame fixed in the link at `local` with its x axis along `direction`, a unit vector in
    /// the link's frame: a guide cut into the link, for instance.
    #[inline]
    pub fn frame(&self, local: Vector2<N>, direction: Vector2<N>) -> Self {
        Self {
            origin: self.point(local),
            direction: self.vector(direction),
            ..*self
        }
    }

    /// The direction as an angle in (-pi, pi].
    #[inline]
    pub fn angle(&self) -> N::Angle {
        N::atan2(self.direction.y, self.direction.x)
    }

    /// The point that slides along this guide, at `across` to its left, `length` along from its
    /// origin.
    #[inline]
    pub fn sliding(&self, slide: &SlideMotion<N>, across: N) -> PointMotion<N> {
        let on_guide = self.point(Vector2::new(slide.length, across));
        let coriolis = self.rate * (slide.rate + slide.rate);
        PointMotion {
            position: on_guide.position,
            velocity: on_guide.velocity + self.direction * slide.rate,
            acceleration: on_guide.acceleration
                + self.direction * slide.acceleration
                + perpendicular(self.direction) * coriolis,
        }
    }

    /// True when every component is finite.
    pub fn is_finite(&self) -> bool {
        self.origin.is_finite()
            && self.direction.x.is_finite()
            && self.direction.y.is_finite()
            && self.rate.is_finite()
            && self.acceleration.is_finite()
    }
}

impl<N: Number> SlideMotion<N> {
    /// Two slides from their lengths, rates and accelerations.
    pub(super) fn pair(lengths: [N; 2], rates: [N; 2], accelerations: [N; 2]) -> [Self; 2] {
        [0, 1].map(|i| Self {
            length: lengths[i],
            rate: rates[i],
            acceleration: accelerations[i],
        })
    }

    /// True when every component is finite.
    pub fn is_finite(&self) -> bool {
        self.length.is_finite() && self.rate.is_finite() && self.acceleration.is_finite()
    }
}

impl<N: Number, const SLIDES: usize> DyadMotion<N, SLIDES> {
    /// Refuses a motion that is not finite.
    pub(super) fn finite(self) -> Result<Self, LinkageStatus> {
        let finite = self.first.is_finite()
            && self.second.is_finite()
            && self.slides.iter().all(SlideMotion::is_finite)
            && self.singularity_distance.is_finite();
        finite.then_some(self).ok_or(LinkageStatus::OutOfRange)
    }
}

impl<N: Number> Crank<N> {
    /// The crank of `length` about `centre`.
    pub fn new(centre: Vector2<f64>, length: f64) -> Self {
        Self {
            centre: centre.map(N::from_f64),
            length: N::from_f64(length),
        }
    }

    /// The crank as `drive` turns it; origin at the centre, x axis towards the tip.
    #[inline]
    pub fn at(&self, drive: &Drive<N>) -> LinkMotion<N> {
        drive.link(PointMotion::fixed(self.centre))
    }

    /// The tip of the crank that moves as `link`.
    #[inline]
    pub fn tip(&self, link: &LinkMotion<N>) -> PointMotion<N> {
        link.point(Vector2::new(self.length, N::ZERO))
    }
}

impl<N: Number> Drive<N> {
    /// The direction of the driven link at `origin`.
    #[inline]
    pub fn link(&self, origin: PointMotion<N>) -> LinkMotion<N> {
        let (sin, cos) = N::sin_cos(self.angle);
        LinkMotion {
            origin,
            direction: Vector2::new(cos, sin),
            rate: self.rate,
            acceleration: self.acceleration,
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// A point near (`x`, 0.3 - `x`) that accelerates.
    pub(crate) fn moving(x: f64) -> PointMotion<f64> {
        PointMotion {
            position: Vector2::new(x, 0.3 - x),
            velocity: Vector2::new(0.5, -x),
            acceleration: Vector2::new(x, 2.0),
        }
    }

    /// Asserts that two points move alike, to `rounding` in position, ten times as much in
    /// velocity and a hundred times in acceleration.
    pub(crate) fn assert_alike(a: &PointMotion<f64>, b: &PointMotion<f64>, rounding: f64) {
        let off = a.relative_to(b);
        assert!(off.position.abs().max() < rounding, "{off:?}");
        assert!(off.velocity.abs().max() < 10.0 * rounding, "{off:?}");
        assert!(off.acceleration.abs().max() < 100.0 * rounding, "{off:?}");
    }

    /// A link about the origin with its x axis along (0.6, 0.8), at 2 rad/s and 3 rad/s^2.
    fn link() -> LinkMotion<f64> {
        LinkMotion {
            rate: 2.0,
            acceleration: 3.0,
            ..LinkMotion::fixed(Vector2::new(0.0, 0.0), Vector2::new(0.6, 0.8))
        }
    }

    #[test]
    fn points_of_a_link_follow_rivals() {
        let end = link().point(Vector2::new(5.0, 0.0));
        assert_eq!(end.position, Vector2::new(3.0, 4.0));
        assert_eq!(end.velocity, Vector2::new(-8.0, 6.0));
        assert_eq!(end.acceleration, Vector2::new(-24.0, -7.0));
        // A frame fixed in the link carries the same points.
        let frame = link().frame(Vector2::new(5.0, 0.0), Vector2::new(0.0, 1.0));
        let back = frame.point(Vector2::new(0.0, 5.0));
        assert!((back.position.abs() + back.velocity.abs()).max() < 1e-15);
        assert!(back.acceleration.abs().max() < 1e-14);
    }

    #[test]
    fn sliding_adds_the_coriolis_acceleration() {
        let slide = SlideMotion {
            length: 5.0,
            rate: 10.0,
            acceleration: 1.0,
        };
        let at = link().sliding(&slide, 0.0);
        let carried = link().point(Vector2::new(5.0, 0.0));
        let along = Vector2::new(0.6, 0.8);
        let across = Vector2::new(-0.8, 0.6);
        assert_eq!(at.position, carried.position);
        let velocity = at.velocity - carried.velocity;
        assert!((velocity - along * 10.0).abs().max() < 1e-14);
        let acceleration = at.acceleration - carried.acceleration;
        assert!((acceleration - (along + across * 40.0)).abs().max() < 1e-14);
    }

    #[test]
    fn a_drive_turns_its_link() {
        let drive = Drive {
            angle: core::f32::consts::FRAC_PI_2,
            rate: 1.0,
            acceleration: 0.0,
        };
        let link = drive.link(PointMotion::fixed(Vector2::new(1.0, 0.0)));
        assert!((link.direction - Vector2::new(0.0, 1.0)).abs().max() < 1e-7);
        let angle: f32 = link.angle();
        assert!((angle - core::f32::consts::FRAC_PI_2).abs() < 1e-6);
        assert!(link.is_finite());
        let endless = LinkMotion {
            rate: f32::INFINITY,
            ..link
        };
        assert!(!endless.is_finite());
    }
}
