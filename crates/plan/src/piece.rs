//! Pieces of a path: geometry without time.

use nalgebra::{Vector2, Vector3};
use trirrr_core::number::{Number, perpendicular};
use trirrr_core::setpoint::Pose;

/// A smooth piece of a path, a function of the parameter p from 0 at its start to 1 at its end.
///
/// Positions are those of the platform's reference point D in the fixed frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Piece<N: Number> {
    /// Straight in all three coordinates.
    Line {
        /// Pose at p = 0.
        start: Pose<N>,
        /// Displacement to p = 1: (dx, dy, dalpha).
        displacement: Vector3<N>,
    },
    /// A circular arc of D, with the platform's angle linear in p.
    Arc {
        /// Centre of the circle.
        centre: Vector2<N>,
        /// From the centre to D at p = 0.
        radius: Vector2<N>,
        /// Angle about the centre from p = 0 to p = 1, counter-clockwise positive.
        turn: N,
        /// alpha at p = 0.
        angle: N::Angle,
        /// Change of alpha to p = 1.
        rotation: N,
    },
    /// A cubic in each coordinate: start + c1 p + c2 p^2 + c3 p^3.
    Cubic {
        /// Pose at p = 0.
        start: Pose<N>,
        /// Coefficients c1, c2, c3 of (x, y, alpha).
        coefficients: [Vector3<N>; 3],
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

impl<N: Number> Piece<N> {
    /// The point at `p`.
    pub fn at(&self, p: N) -> PathPoint<N> {
        match self {
            Self::Line {
                start,
                displacement,
            } => PathPoint {
                pose: start.displaced(*displacement * p),
                first: *displacement,
                second: Vector3::from([N::ZERO; 3]),
            },
            Self::Arc {
                centre,
                radius,
                turn,
                angle,
                rotation,
            } => {
                let (sin, cos) = N::sin_cos(N::angle(*turn * p));
                let arm = Vector2::new(
                    N::ab_minus_cd(radius.x, cos, radius.y, sin),
                    N::ab_plus_cd(radius.y, cos, radius.x, sin),
                );
                let first = perpendicular(arm) * *turn;
                let second = -(arm * (*turn * *turn));
                PathPoint {
                    pose: Pose {
                        position: *centre + arm,
                        angle: *angle + N::angle(*rotation * p),
                    },
                    first: Vector3::new(first.x, first.y, *rotation),
                    second: Vector3::new(second.x, second.y, N::ZERO),
                }
            }
            Self::Cubic {
                start,
                coefficients: [c1, c2, c3],
            } => {
                let three_c3_p = *c3 * (p + p + p);
                let half_second = *c2 + three_c3_p;
                PathPoint {
                    pose: start.displaced((*c1 + (*c2 + *c3 * p) * p) * p),
                    first: *c1 + (*c2 + half_second) * p,
                    second: half_second + half_second,
                }
            }
        }
    }
}

#[cfg(feature = "std")]
impl Piece<f64> {
    /// The straight piece from `from` to `to`.
    pub fn line(from: Pose<f64>, to: Pose<f64>) -> Self {
        Self::Line {
            start: from,
            displacement: from.displacement(&to),
        }
    }

    /// The arc from `from` about `centre` by `turn_rad`, with alpha at its end `end_angle`.
    pub fn arc(from: Pose<f64>, centre: Vector2<f64>, turn_rad: f64, end_angle: f64) -> Self {
        Self::Arc {
            centre,
            radius: from.position - centre,
            turn: turn_rad,
            angle: from.angle,
            rotation: end_angle - from.angle,
        }
    }

    /// The cubic Bezier piece with the four control poses `poses`.
    pub fn bezier(poses: [Pose<f64>; 4]) -> Self {
        let [d1, d2, d3] = [1, 2, 3].map(|i: usize| poses[i - 1].displacement(&poses[i]));
        Self::Cubic {
            start: poses[0],
            coefficients: [d1 * 3.0, (d2 - d1) * 3.0, (d3 - d2) - (d2 - d1)],
        }
    }

    /// The same piece in the number type `N`.
    pub fn over<N: Number>(&self) -> Piece<N> {
        let vector = |v: &Vector3<f64>| v.map(N::from_f64);
        let pose = |p: &Pose<f64>| Pose::from_f64(p.position.x, p.position.y, p.angle);
        match self {
            Self::Line {
                start,
                displacement,
            } => Piece::Line {
                start: pose(start),
                displacement: vector(displacement),
            },
            Self::Arc {
                centre,
                radius,
                turn,
                angle,
                rotation,
            } => Piece::Arc {
                centre: centre.map(N::from_f64),
                radius: radius.map(N::from_f64),
                turn: N::from_f64(*turn),
                angle: N::angle_from_f64(*angle),
                rotation: N::from_f64(*rotation),
            },
            Self::Cubic {
                start,
                coefficients,
            } => Piece::Cubic {
                start: pose(start),
                coefficients: coefficients.each_ref().map(vector),
            },
        }
    }

    /// The part of the piece from p = `from` to `to`, as a piece of its own.
    pub fn part(&self, from: f64, to: f64) -> Self {
        let PathPoint {
            pose,
            first,
            second,
        } = self.at(from);
        let span = to - from;
        match self {
            Self::Line { .. } => Self::Line {
                start: pose,
                displacement: first * span,
            },
            Self::Arc {
                centre,
                turn,
                rotation,
                ..
            } => Self::Arc {
                centre: *centre,
                radius: pose.position - centre,
                turn: turn * span,
                angle: pose.angle,
                rotation: rotation * span,
            },
            Self::Cubic {
                coefficients: [_, _, c3],
                ..
            } => Self::Cubic {
                start: pose,
                coefficients: [
                    first * span,
                    second * (0.5 * span * span),
                    c3 * (span * span * span),
                ],
            },
        }
    }

    /// Length of D's way, by chords.
    pub fn length_m(&self) -> f64 {
        self.size(|v| v.x.hypot(v.y))
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
