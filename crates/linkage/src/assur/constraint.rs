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

use super::description::{Drive, JointKind, Linkage, PointRef, Prismatic};
use super::groups::Group;
use super::state::State;
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
    states: &[State],
    t: f64,
) -> Vec<Equation> {
    let at = Frame { linkage, states };
    let mut equations = Vec::with_capacity(3 * group.links.len());
    for &joint in &group.joints {
        match &linkage.joints[joint].kind {
            JointKind::Revolute(pins) => {
                // Everything is tied to one pin: of a link that is known, if there is any.
                let own = |pin: &&PointRef| group.links.contains(&pin.link);
                let known = |pin: &&PointRef| !own(pin) && at.is_known(pin.link);
                let tied_to = pins.iter().find(known).or(pins.iter().find(own));
                for pin in pins.iter().filter(own) {
                    if let Some(&to) = tied_to.filter(|&to| to != pin) {
                        equations.extend(at.pin(*pin, to));
                    }
                }
            }
            JointKind::Prismatic(slide) => equations.extend(at.guide(slide)),
        }
    }
    for &drive in &group.drives {
        let drive = &linkage.drives[drive];
        equations.push(match &linkage.joints[drive.joint].kind {
            JointKind::Prismatic(slide) => at.slide(slide, drive, t),
            JointKind::Revolute(_) => at.turn(drive, t),
        });
    }
    equations
}

/// `angle` less whole turns, to within half a turn of zero.
pub(super) fn wrapped(angle: f64) -> f64 {
    use std::f64::consts::TAU;
    angle - TAU * (angle / TAU).round()
}

struct Frame<'a> {
    linkage: &'a Linkage,
    states: &'a [State],
}

/// The geometry of a prismatic joint at one state.
struct Guide {
    u: Vector2<f64>,
    n: Vector2<f64>,
    /// From the link's origin to the guide's point, and to the slider's.
    to_guide: Vector2<f64>,
    to_slider: Vector2<f64>,
    /// From the guide's point to the slider's: position, velocity, and of its acceleration what
    /// is not by the links' accelerations.
    between: Vector2<f64>,
    velocity: Vector2<f64>,
    squares: Vector2<f64>,
}

impl Frame<'_> {
    /// Known links have a state from this round; the others' is from the last. Only for choosing
    /// which pin of several is the reference.
    fn is_known(&self, link: usize) -> bool {
        self.states[link].known
    }

    fn arm(&self, point: PointRef) -> Vector2<f64> {
        let [x, y] = self.linkage.local(point);
        self.states[point.link].motion.vector(Vector2::new(x, y))
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

    fn geometry(&self, slide: &Prismatic) -> Guide {
        let guide = &self.states[slide.guide.link].motion;
        let slider = &self.states[slide.slider.link].motion;
        let u = guide.vector(crate::motion::unit(slide.direction));
        let (to_guide, to_slider) = (self.arm(slide.guide), self.arm(slide.slider));
        let speed = |motion: &super::state::Motion, arm| {
            motion.origin.velocity + perpendicular(arm) * motion.rate
        };
        Guide {
            u,
            n: perpendicular(u),
            to_guide,
            to_slider,
            between: slider.origin.position + to_slider - guide.origin.position - to_guide,
            velocity: speed(slider, to_slider) - speed(guide, to_guide),
            squares: to_guide * (guide.rate * guide.rate) - to_slider * (slider.rate * slider.rate),
        }
    }

    fn guide(&self, slide: &Prismatic) -> [Equation; 2] {
        let (link, other) = (slide.guide.link, slide.slider.link);
        let at = self.geometry(slide);
        let rate = self.states[link].motion.rate;
        let across = dot(at.n, at.between);
        [
            self.angle(link, other, slide.angle, [0.0; 2]),
            Equation {
                residual: across - slide.offset,
                angular: false,
                by: [
                    (
                        other,
                        [at.n.x, at.n.y, dot(at.n, perpendicular(at.to_slider))],
                    ),
                    (
                        link,
                        [
                            -at.n.x,
                            -at.n.y,
                            -dot(at.n, perpendicular(at.to_guide)) - dot(at.u, at.between),
                        ],
                    ),
                ],
                squares: dot(at.n, at.squares)
                    - 2.0 * rate * dot(at.u, at.velocity)
                    - rate * rate * across,
                drive: [0.0; 2],
            },
        ]
    }

    fn slide(&self, slide: &Prismatic, drive: &Drive, t: f64) -> Equation {
        let (link, other) = (slide.guide.link, slide.slider.link);
        let at = self.geometry(slide);
        let rate = self.states[link].motion.rate;
        let [length, speed, acceleration] = drive.at(t);
        let along = dot(at.u, at.between);
        Equation {
            residual: along - length,
            angular: false,
            by: [
                (
                    other,
                    [at.u.x, at.u.y, dot(at.u, perpendicular(at.to_slider))],
                ),
                (
                    link,
                    [
                        -at.u.x,
                        -at.u.y,
                        dot(at.n, at.between) - dot(at.u, perpendicular(at.to_guide)),
                    ],
                ),
            ],
            squares: dot(at.u, at.squares) + 2.0 * rate * dot(at.n, at.velocity)
                - rate * rate * along,
            drive: [speed, acceleration],
        }
    }

    fn turn(&self, drive: &Drive, t: f64) -> Equation {
        let [angle, rate, acceleration] = drive.at(t);
        self.angle(drive.base, drive.link, angle, [rate, acceleration])
    }

    /// angle of `other` - angle of `base` = `angle`.
    fn angle(&self, base: usize, other: usize, angle: f64, drive: [f64; 2]) -> Equation {
        Equation {
            residual: wrapped(self.states[other].angle - self.states[base].angle - angle),
            angular: true,
            by: [(other, [0.0, 0.0, 1.0]), (base, [0.0, 0.0, -1.0])],
            squares: 0.0,
            drive,
        }
    }
}
