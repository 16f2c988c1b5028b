//! The cubic with given velocities at both ends, so that moves chain without stopping.

use super::{Pose, Setpoint};
use crate::number::Number;
use nalgebra::Vector3;

/// The Hermite cubic: pose and velocity given at both ends, on every coordinate
/// q = q0 + c1 s + c2 s^2 + c3 s^3 with s = t / T, h = q1 - q0 and
///
/// ```text
/// c1 = T v0,   c2 = 3 h - T (2 v0 + v1),   c3 = T (v0 + v1) - 2 h
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hermite<N: Number> {
    forward: Cubic<N>,
    backward: Cubic<N>,
    ticks: u32,
    /// 1 / T.
    per_duration: N,
}

/// The cubic as seen from one end: time runs from that end into the move.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Cubic<N: Number> {
    origin: Pose<N>,
    c1: Vector3<N>,
    c2: Vector3<N>,
    c3: Vector3<N>,
}

impl<N: Number> Cubic<N> {
    /// `h`: displacement to the other end; `t_v0`, `t_v1`: duration times velocity at the origin
    /// and at the other end, both positive along `h`.
    fn new(origin: Pose<N>, h: Vector3<N>, t_v0: Vector3<N>, t_v1: Vector3<N>) -> Self {
        Self {
            origin,
            c1: t_v0,
            c2: (h - t_v0) + (h - t_v0) + (h - t_v1),
            c3: (t_v0 - h) + (t_v1 - h),
        }
    }

    #[inline(always)]
    fn pose(&self, s: N) -> Pose<N> {
        self.origin
            .displaced((self.c1 + (self.c2 + self.c3 * s) * s) * s)
    }

    /// dq/ds.
    #[inline(always)]
    fn first_derivative(&self, s: N) -> Vector3<N> {
        let three_c3_s = self.c3 * (s + s + s);
        self.c1 + (self.c2 + self.c2 + three_c3_s) * s
    }

    /// d^2 q/ds^2.
    #[inline(always)]
    fn second_derivative(&self, s: N) -> Vector3<N> {
        let half = self.c2 + self.c3 * (s + s + s);
        half + half
    }
}

impl<N: Number> Hermite<N> {
    /// The move from `from` with `from_velocity` to `to` with `to_velocity` in `ticks` ticks of
    /// `period` seconds each, both positive. Velocities are (vx, vy, alphadot).
    pub fn new(
        from: Pose<N>,
        from_velocity: Vector3<N>,
        to: Pose<N>,
        to_velocity: Vector3<N>,
        ticks: u32,
        period: N,
    ) -> Self {
        let h = from.displacement(&to);
        let duration = N::ratio(ticks, 1) * period;
        let (t_v0, t_v1) = (from_velocity * duration, to_velocity * duration);
        Self {
            forward: Cubic::new(from, h, t_v0, t_v1),
            backward: Cubic::new(to, -h, -t_v1, -t_v0),
            ticks,
            per_duration: N::ratio(1, ticks).div(period),
        }
    }

    /// Length of the move in ticks.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// The setpoint at `tick`, counted from the start of the move; beyond the end, the end.
    #[inline(always)]
    pub fn at(&self, tick: u32) -> Setpoint<N> {
        let left = self.ticks.saturating_sub(tick);
        // Seen from the end, time runs backwards: velocity changes sign, acceleration does not.
        let (cubic, s, per_duration) = if tick <= left {
            (&self.forward, N::ratio(tick, self.ticks), self.per_duration)
        } else {
            (&self.backward, N::ratio(left, self.ticks), -self.per_duration)
        };
        Setpoint {
            pose: cubic.pose(s),
            velocity: cubic.first_derivative(s) * per_duration,
            acceleration: cubic.second_derivative(s) * (per_duration * per_duration),
        }
    }
}
