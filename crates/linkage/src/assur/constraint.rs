//! The equations of joints and drives in the links' poses, with what their first and second
//! derivatives need.
//!
//! A pose is x, y of the link's origin and its angle. With R the turn by the angle, E the turn by
//! +90 degrees, p and q points in their links' frames:
//!
//! ```text
//! pin             r_a + R_a p - r_b - R_b q = 0
//! prismatic       angle_s - angle_g - constant = 0
//!                 n . (Q - P) - offset = 0        n = E u, u the guide's direction
//! driven pin      angle_l - angle_b - q(t) = 0
//! driven slide    u . (Q - P) - q(t) = 0
//! ```
//!
//! All of them are linear in the rates, and in the accelerations up to a term of squares of rates.

use super::description::{JointKind, Linkage, PointRef, Prismatic};
use super::groups::Group;
use super::state::LinkState;
use crate::motion::LinkMotion;
use nalgebra::Vector2;
use trirrr_core::number::{dot, perpendicular};

/// One scalar equation at one state.
#[derive(Clone, Copy, Debug)]
pub(super) struct Equation {
    /// Residual, zero where the equation holds: m, or rad where `angular`.
    pub(super) residual: f64,
    /// `true` for a residual that is an angle.
    pub(super) angular: bool,
    /// For two links, the derivatives by x, y and angle.
    pub(super) by: [(usize, [f64; 3]); 2],
    /// Part of the second derivative without the accelerations.
    pub(super) squares: f64,
    /// The drive's rate and acceleration; 0 for a joint.
    pub(super) drive: [f64; 2],
}

/// The equations that determine `group`, as many as it has unknowns, at the states of all links
/// and the time `t`.
pub(super) fn equations(
    linkage: &Linkage,
    group: &Group,
    states: &[LinkState],
    t: f64,
) -> Vec<Equation> {
    let at = Constraints { linkage, states };
    let mut equations = Vec::with_capacity(3 * group.links.len());
    for &joint in &group.joints {
        match &linkage.joints[joint].kind {
            JointKind::Revolute(pins) => {
                // Everything is tied to one pin: of a link that is known, if there is any.
                let own = |pin: &&PointRef| group.links.contains(&pin.link);
                let known = |pin: &&PointRef| !own(pin) && states[pin.link].known;
                let tied_to = pins.iter().find(known).or(pins.iter().find(own));
                for pin in pins.iter().filter(own) {
                    if let Some(&to) = tied_to.filter(|&to| to != pin) {
                        equations.extend(at.pin(*pin, to));
                    }
                }
            }
            JointKind::Prismatic(slide) => {
                let (guide, slider) = (slide.guide.link, slide.slider.link);
                let across = perpendicular(slide.along(states));
                equations.push(at.angle(guide, slider, [slide.angle, 0.0, 0.0]));
                equations.push(at.distance(slide, across, [slide.offset, 0.0, 0.0]));
            }
        }
    }
    for &drive in &group.drives {
        let drive = &linkage.drives[drive];
        equations.push(match &linkage.joints[drive.joint].kind {
            JointKind::Prismatic(slide) => at.distance(slide, slide.along(states), drive.at(t)),
            JointKind::Revolute(_) => at.angle(drive.base, drive.link, drive.at(t)),
        });
    }
    equations
}

/// `angle` less whole turns, to within half a turn of zero.
pub(super) fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::TAU;
    angle - TAU * (angle / TAU).round()
}

struct Constraints<'a> {
    linkage: &'a Linkage,
    states: &'a [LinkState],
}

impl Constraints<'_> {
    fn arm(&self, point: PointRef) -> Vector2<f64> {
        self.states[point.link]
            .motion
            .vector(self.linkage.local(point))
    }

    fn pin(&self, a: PointRef, b: PointRef) -> [Equation; 2] {
        let (sa, sb) = (&self.states[a.link].motion, &self.states[b.link].motion);
        let (to_a, to_b) = (self.arm(a), self.arm(b));
        let residual = sa.origin.position + to_a - sb.origin.position - to_b;
        let squares = to_b * (sb.rate * sb.rate) - to_a * (sa.rate * sa.rate);
        let (ea, eb) = (perpendicular(to_a), perpendicular(to_b));
        [0, 1].map(|axis| {
            let unit = if axis == 0 { [1.0, 0.0] } else { [0.0, 1.0] };
            Equation {
                residual: residual[axis],
                angular: false,
                by: [
                    (a.link, [unit[0], unit[1], ea[axis]]),
                    (b.link, [-unit[0], -unit[1], -eb[axis]]),
                ],
                squares: squares[axis],
                drive: [0.0; 2],
            }
        })
    }

    /// Distance of the slider's point from the guide's along `d`, a unit vector that is fixed in the
    /// guide's link, as `[value, rate, acceleration]` ask.
    fn distance(
        &self,
        slide: &Prismatic,
        d: Vector2<f64>,
        [value, rate, acceleration]: [f64; 3],
    ) -> Equation {
        let motion = |point: PointRef| &self.states[point.link].motion;
        let (guide, slider) = (motion(slide.guide), motion(slide.slider));
        let (to_guide, to_slider) = (self.arm(slide.guide), self.arm(slide.slider));
        let speed = |motion: &LinkMotion<f64>, arm| {
            motion.origin.velocity + perpendicular(arm) * motion.rate
        };
        // From the guide's point to the slider's: position, velocity, and of its acceleration what
        // is not by the links' accelerations.
        let between = slider.origin.position + to_slider - guide.origin.position - to_guide;
        let velocity = speed(slider, to_slider) - speed(guide, to_guide);
        let squares =
            to_guide * (guide.rate * guide.rate) - to_slider * (slider.rate * slider.rate);
        // The derivative of `d` by the guide's angle.
        let e = perpendicular(d);
        let (along, w) = (dot(d, between), guide.rate);
        let by_guide = dot(e, between) - dot(d, perpendicular(to_guide));
        Equation {
            residual: along - value,
            angular: false,
            by: [
                (
                    slide.slider.link,
                    [d.x, d.y, dot(d, perpendicular(to_slider))],
                ),
                (slide.guide.link, [-d.x, -d.y, by_guide]),
            ],
            squares: dot(d, squares) + 2.0 * w * dot(e, velocity) - w * w * along,
            drive: [rate, acceleration],
        }
    }

    /// Angle of `other` less that of `base`.
    fn angle(&self, base: usize, other: usize, [angle, rate, acceleration]: [f64; 3]) -> Equation {
        Equation {
            residual: wrapped(self.states[other].angle - self.states[base].angle - angle),
            angular: true,
            by: [(other, [0.0, 0.0, 1.0]), (base, [0.0, 0.0, -1.0])],
            squares: 0.0,
            drive: [rate, acceleration],
        }
    }
}
