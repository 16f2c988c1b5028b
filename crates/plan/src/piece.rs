//! Pieces of a path: geometry without time.

use core::ops::{Add, Mul};
use nalgebra::{Vector2, Vector3};
use trirrr_core::number::{Number, perpendicular};
use trirrr_core::setpoint::Pose;
use trirrr_service::admission::{Enclose, TaylorModel};

/// A smooth piece of a path, a function of the parameter p from 0 at its start to 1 at its end: a curve of the
/// platform's reference point D in the fixed frame, and a cubic of the platform's angle alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece<N: Number> {
    /// Curve of D.
    pub curve: PlaneCurve<N>,
    /// alpha at p = 0.
    pub angle: N::Angle,
    /// Coefficients c1, c2, c3 of alpha = angle + c1 p + c2 p^2 + c3 p^3.
    pub turning: [N; 3],
}

/// The curve of D along a [`Piece`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PlaneCurve<N: Number> {
    /// A straight line.
    Line {
        /// D at p = 0.
        start: Vector2<N>,
        /// Displacement to p = 1.
        displacement: Vector2<N>,
    },
    /// A circular arc.
    Arc {
        /// Centre of the circle.
        centre: Vector2<N>,
        /// From the centre to D at p = 0.
        radius: Vector2<N>,
        /// Angle about the centre from p = 0 to p = 1, counter-clockwise positive.
        turn: N,
    },
    /// A cubic: start + c1 p + c2 p^2 + c3 p^3.
    Cubic {
        /// D at p = 0.
        start: Vector2<N>,
        /// Coefficients c1, c2, c3 of (x, y).
        coefficients: [Vector2<N>; 3],
    },
}

/// A point of a [`Piece`] with its derivatives by p.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathPoint<N: Number> {
    /// Pose.
    pub pose: Pose<N>,
    /// First derivative of (x, y, alpha) by p.
    pub first: Vector3<N>,
    /// Second derivative of (x, y, alpha) by p.
    pub second: Vector3<N>,
}

/// c1 p + c2 p^2 + c3 p^3 and its first two derivatives; `zero` is 0.
fn cubic<N: Number, V: Copy + Add<Output = V> + Mul<N, Output = V> + PartialEq>(
    [c1, c2, c3]: [V; 3],
    p: N,
    zero: V,
) -> [V; 3] {
    // Mostly alpha is linear in p.
    if c3 == zero && c2 == zero {
        return [c1 * p, c1, zero];
    }
    let half_second = c2 + c3 * (p + p + p);
    [
        (c1 + (c2 + c3 * p) * p) * p,
        c1 + (c2 + half_second) * p,
        half_second + half_second,
    ]
}

impl<N: Number> PlaneCurve<N> {
    /// D at `p`, with its first two derivatives.
    fn at(&self, p: N) -> [Vector2<N>; 3] {
        match self {
            Self::Line {
                start,
                displacement,
            } => [
                *start + *displacement * p,
                *displacement,
                Vector2::from([N::ZERO; 2]),
            ],
            Self::Arc {
                centre,
                radius,
                turn,
            } => {
                let (sin, cos) = N::sin_cos(N::angle(*turn * p));
                let arm = Vector2::new(
                    N::ab_minus_cd(radius.x, cos, radius.y, sin),
                    N::ab_plus_cd(radius.y, cos, radius.x, sin),
                );
                let second = -(arm * (*turn * *turn));
                [*centre + arm, perpendicular(arm) * *turn, second]
            }
            Self::Cubic {
                start,
                coefficients,
            } => {
                let [way, first, second] = cubic(*coefficients, p, Vector2::from([N::ZERO; 2]));
                [*start + way, first, second]
            }
        }
    }
}

impl<N: Number> Piece<N> {
    /// The point at `p`.
    pub fn at(&self, p: N) -> PathPoint<N> {
        let [position, first, second] = self.curve.at(p);
        let [turned, rate, bend] = cubic(self.turning, p, N::ZERO);
        PathPoint {
            pose: Pose {
                position,
                angle: self.angle + N::angle(turned),
            },
            first: Vector3::new(first.x, first.y, rate),
            second: Vector3::new(second.x, second.y, bend),
        }
    }
}

/// Roundings of a place, in parts of a metre or a radian, that a tangent exceeds if its direction is known.
const ROUNDINGS: u32 = 16;

/// Sine of the angle between two tangents above which the path has a corner, beside some roundings of its numbers.
const CORNER: f64 = 1e-9;

/// Turn by rounding above which nobody knows how much of a turn that is, rad.
const UNKNOWN: f64 = 0.1;

/// Place where the motion goes on from a piece to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PieceJoint<N> {
    /// x = (dp/dt)^2 at the start of the piece after over that at the end of the piece before.
    pub(crate) scale: N,
    /// Size of the change of the direction that may be one of the path: rounding turns a short piece.
    pub(crate) turn: N,
}

/// Scale of x = (dp/dt)^2 from the end of `before` to the start of `after`; none at a corner.
#[cfg(feature = "std")]
pub(crate) fn joint<N: Number>(before: &Piece<N>, after: &Piece<N>) -> Option<N> {
    PieceJoint::of(before, after).map(|joint| joint.scale)
}

impl<N: Number> PieceJoint<N> {
    /// The place between `before` and `after`; none at a corner.
    pub(crate) fn of(before: &Piece<N>, after: &Piece<N>) -> Option<Self> {
        let (a, b) = (before.at(N::ONE).first, after.at(N::ZERO).first);
        let (length_a, length_b) = (length(a), length(b));
        let scale = length_a.div(length_b);
        let turned = a * N::ONE.div(length_a) - b * N::ONE.div(length_b);
        // Places are rounded by a part of a metre, at most: a short piece turns by as much.
        let shorter = if length_a < length_b {
            length_a
        } else {
            length_b
        };
        let rounding = N::UNIT_ROUNDOFF.div(shorter);
        let corner = N::from_f64(CORNER) + rounding * N::from_f64(16.0);
        let turn = length(turned);
        // Within half a metre of the base the places of two pieces round the turn by one and a half. Where rounding may turn by much,
        // all of the turn may be one of the path.
        let rounded = rounding + rounding;
        let of_path = match (rounded < N::from_f64(UNKNOWN), turn > rounded) {
            (false, _) => turn,
            (true, true) => turn - rounded,
            (true, false) => N::ZERO,
        };
        (turn <= corner).then_some(Self {
            scale: scale * scale,
            turn: of_path,
        })
    }
}

/// Length of a tangent, with a metre counting as much as a radian.
pub(crate) fn length<N: Number>(v: Vector3<N>) -> N {
    (N::ab_plus_cd(v.x, v.x, v.y, v.y) + v.z * v.z).sqrt()
}

impl<B: Number> Piece<B> {
    /// A length in the plane, and an angle, that no two poses of the piece are farther apart than.
    pub(crate) fn extents(&self) -> [B; 2] {
        let plane = |v: Vector2<B>| B::ab_plus_cd(v.x, v.x, v.y, v.y).sqrt();
        let way = match self.curve {
            PlaneCurve::Line { displacement, .. } => plane(displacement),
            PlaneCurve::Arc { radius, turn, .. } => plane(radius) * turn.abs(),
            PlaneCurve::Cubic {
                coefficients: [c1, c2, c3],
                ..
            } => plane(c1) + plane(c2) + plane(c3),
        };
        let [c1, c2, c3] = self.turning;
        [way, c1.abs() + c2.abs() + c3.abs()]
    }

    /// Returns true if the piece has a direction at its ends and in the middle: the rounding of its poses is small beside its tangents.
    pub(crate) fn has_direction(&self) -> bool {
        let least = B::UNIT_ROUNDOFF * B::ratio(ROUNDINGS, 1);
        let mut places = [B::ZERO, B::HALF, B::ONE].into_iter();
        places.all(|p| length(self.at(p).first) > least)
    }

    /// Returns true if the piece leads anywhere: a length far below the rounding of any place is none.
    pub(crate) fn has_length(&self) -> bool {
        let [plane, turning] = self.extents();
        plane + turning > B::UNIT_ROUNDOFF * B::UNIT_ROUNDOFF
    }

    /// The straight piece from `from` to `to`.
    pub fn line(from: Pose<B>, to: Pose<B>) -> Self {
        let way = from.displacement(&to);
        Self {
            curve: PlaneCurve::Line {
                start: from.position,
                displacement: way.xy(),
            },
            angle: from.angle,
            turning: [way.z, B::ZERO, B::ZERO],
        }
    }

    /// The arc from `from` about `centre` by `turn_rad`, with alpha linear in p, at its end `end_angle`.
    pub fn arc(from: Pose<B>, centre: Vector2<B>, turn_rad: B, end_angle: B::Angle) -> Self {
        Self {
            curve: PlaneCurve::Arc {
                centre,
                radius: from.position - centre,
                turn: turn_rad,
            },
            angle: from.angle,
            turning: [B::radians(end_angle - from.angle), B::ZERO, B::ZERO],
        }
    }

    /// The piece start + c1 p + c2 p^2 + c3 p^3 with these `coefficients` of (x, y, alpha).
    pub fn cubic(start: Pose<B>, coefficients: [Vector3<B>; 3]) -> Self {
        Self {
            curve: PlaneCurve::Cubic {
                start: start.position,
                coefficients: coefficients.map(|each| each.xy()),
            },
            angle: start.angle,
            turning: coefficients.map(|each| each.z),
        }
    }

    /// The cubic Bezier piece with the four control poses `poses`.
    pub fn bezier(poses: [Pose<B>; 4]) -> Self {
        let [start, first, second, end] = poses;
        let d1 = start.displacement(&first);
        let d2 = first.displacement(&second);
        let d3 = second.displacement(&end);
        let three = B::ONE + B::ONE + B::ONE;
        Self::cubic(
            start,
            [d1 * three, (d2 - d1) * three, (d3 - d2) - (d2 - d1)],
        )
    }

    /// The same piece in another number type, exactly.
    pub(crate) fn convert<T: Number>(&self, number: impl Fn(B) -> T + Copy) -> Piece<T> {
        let vector = |v: Vector2<B>| v.map(number);
        Piece {
            curve: match self.curve {
                PlaneCurve::Line {
                    start,
                    displacement,
                } => PlaneCurve::Line {
                    start: vector(start),
                    displacement: vector(displacement),
                },
                PlaneCurve::Arc {
                    centre,
                    radius,
                    turn,
                } => PlaneCurve::Arc {
                    centre: vector(centre),
                    radius: vector(radius),
                    turn: number(turn),
                },
                PlaneCurve::Cubic {
                    start,
                    coefficients,
                } => PlaneCurve::Cubic {
                    start: vector(start),
                    coefficients: coefficients.map(vector),
                },
            },
            angle: T::angle(number(B::radians(self.angle))),
            turning: self.turning.map(number),
        }
    }

    /// The piece for [`Planner::measure`](crate::cell::Planner::measure).
    pub fn models<N: Enclose<Bound = B>>(&self) -> Piece<TaylorModel<N>> {
        self.convert(TaylorModel::point)
    }
}

#[cfg(feature = "std")]
impl Piece<f64> {
    /// The four control poses of a line or a cubic, as of [`bezier`](Self::bezier); of an arc those of the cubic with the same
    /// derivatives at its start.
    pub fn controls(&self) -> [Pose<f64>; 4] {
        let PathPoint {
            pose,
            first,
            second,
        } = self.at(0.0);
        let second_control = first * (2.0 / 3.0) + second / 6.0;
        [
            pose,
            pose.displaced(first / 3.0),
            pose.displaced(second_control),
            self.end(),
        ]
    }

    /// The same way of D as a line, if the piece is a cubic that is straight, does not turn back and keeps its alpha: drawings have
    /// many. Where its controls are at its ends, its tangents vanish there, and no bound of its time is near.
    pub fn straightened(self) -> Self {
        let PlaneCurve::Cubic {
            start,
            coefficients: [c1, c2, c3],
        } = self.curve
        else {
            return self;
        };
        let way = c1 + c2 + c3;
        let square = way.dot(&way);
        // Parts of the way: the rounding of the controls is no bend.
        let off = |leg: Vector2<f64>| (way.perp(&leg) / square).abs() > 1e-9;
        let legs = [c1 / 3.0, (c1 + c2) / 3.0, way - (c1 + c1 + c2) / 3.0];
        let is_bent = legs
            .iter()
            .any(|leg| off(*leg) || leg.dot(&way) < -1e-9 * square);
        match square > 0.0 && !is_bent && self.turning == [0.0; 3] {
            true => Self {
                curve: PlaneCurve::Line {
                    start,
                    displacement: way,
                },
                ..self
            },
            false => self,
        }
    }

    /// The same curve of D with another alpha.
    pub fn with_alpha(self, angle: f64, turning: [f64; 3]) -> Self {
        Self {
            angle,
            turning,
            ..self
        }
    }

    /// The same piece in the number type `N`.
    pub fn over<N: Number>(&self) -> Piece<N> {
        self.convert(N::from_f64)
    }

    /// The part of the piece from p = `from` to `to`, as a piece of its own.
    pub fn part(&self, from: f64, to: f64) -> Self {
        let PathPoint {
            pose,
            first,
            second,
        } = self.at(from);
        let span = to - from;
        let (square, third) = (0.5 * span * span, span * span * span);
        Self {
            curve: match self.curve {
                PlaneCurve::Line { .. } => PlaneCurve::Line {
                    start: pose.position,
                    displacement: first.xy() * span,
                },
                PlaneCurve::Arc { centre, turn, .. } => PlaneCurve::Arc {
                    centre,
                    radius: pose.position - centre,
                    turn: turn * span,
                },
                PlaneCurve::Cubic {
                    coefficients: [_, _, c3],
                    ..
                } => PlaneCurve::Cubic {
                    start: pose.position,
                    coefficients: [first.xy() * span, second.xy() * square, c3 * third],
                },
            },
            angle: pose.angle,
            turning: [first.z * span, second.z * square, self.turning[2] * third],
        }
    }

    /// Length of D's way, by chords.
    pub fn length_m(&self) -> f64 {
        self.size(|v| libm::hypot(v.x, v.y))
    }

    /// The integral of `length` of the first derivative, by the midpoint rule.
    pub(crate) fn size(&self, length: impl Fn(Vector3<f64>) -> f64) -> f64 {
        const CHORDS: u32 = 16;
        let speed = |i: u32| length(self.at((f64::from(i) + 0.5) / f64::from(CHORDS)).first);
        (0..CHORDS).map(speed).sum::<f64>() / f64::from(CHORDS)
    }

    /// Pose at p = 1.
    pub fn end(&self) -> Pose<f64> {
        self.at(1.0).pose
    }
}
