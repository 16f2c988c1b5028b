//! Setpoints: commanded pose, velocity and acceleration of the platform at a tick.
//!
//! Time is a whole number of ticks, an argument and never a clock. All kinds of move are evaluated
//! from the nearer end. The first and the last tick of a move then give its two poses exactly, and
//! a chain of moves neither drifts nor jumps.

mod joint;
mod move_time;
mod polynomial;
mod rest_to_rest;
mod segment;
mod serial;

pub use joint::{JointMove, JointSetpoint, shorter_way, wrapped};
pub use polynomial::{Cubic, Fifth, Hermite, Polynomial, Quintic, TwoSided};
pub use rest_to_rest::RestToRest;
pub use segment::{Cubics, Curve, CurveKind, Ends, NoQuintic, Quintics, Segment};

use crate::number::Number;
use crate::to_source;
use nalgebra::{Vector2, Vector3};

/// Position of the platform's reference point D and orientation of the platform.
#[derive(Clone, Copy, Debug)]
pub struct Pose<N: Number> {
    /// D in the fixed frame.
    pub position: Vector2<N>,
    /// alpha, counter-clockwise from the fixed x axis, not wrapped.
    pub angle: N::Angle,
}

to_source!(pub [N: Number] Pose [N] in trirrr_core::setpoint { position, angle });

/// Pose, velocity and acceleration at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Setpoint<N: Number> {
    /// Pose of the platform.
    pub pose: Pose<N>,
    /// (vx, vy, alphadot).
    pub velocity: Vector3<N>,
    /// (ax, ay, alphaddot).
    pub acceleration: Vector3<N>,
}

// Compared as three numbers: nalgebra compares vectors by iterators, which is more code.
impl<N: Number> PartialEq for Pose<N> {
    fn eq(&self, other: &Self) -> bool {
        self.position.x == other.position.x
            && self.position.y == other.position.y
            && self.angle == other.angle
    }
}

impl<N: Number> Pose<N> {
    /// The pose nearest to (`x`, `y`) in m and `alpha` in rad.
    pub fn from_f64(x: f64, y: f64, alpha: f64) -> Self {
        Self {
            position: Vector2::new(N::from_f64(x), N::from_f64(y)),
            angle: N::angle_from_f64(alpha),
        }
    }

    /// `self` moved by (dx, dy, dalpha).
    #[inline]
    pub fn displaced(&self, by: Vector3<N>) -> Self {
        Self {
            position: self.position + by.xy(),
            angle: self.angle + N::angle(by.z),
        }
    }

    /// The displacement from `self` to `to`, (dx, dy, dalpha).
    #[inline(always)]
    pub fn displacement(&self, to: &Self) -> Vector3<N> {
        let position = to.position - self.position;
        Vector3::new(position.x, position.y, N::radians(to.angle - self.angle))
    }
}
