//! The cubic with given velocities at both ends, so that moves chain without stopping.

use super::move_time::MoveTime;
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
    count: N::Count,
    /// 1 / T.
    per_duration: N::Factor,
}

/// The cubic from one end: time runs from that end into the move.
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

    #[inline(always)]
    fn setpoint(&self, s: N, per_duration: N::Factor) -> Setpoint<N> {
        let per_duration_sq = per_duration * per_duration;
        Setpoint {
            pose: self.pose(s),
            velocity: self.first_derivative(s).map(|q| q.scaled(per_duration)),
            acceleration: self.second_derivative(s).map(|q| q.scaled(per_duration_sq)),
        }
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
        period: N::Factor,
    ) -> Self {
        let h = from.displacement(&to);
        let duration = N::quotient(ticks, 1) * period;
        let scaled = |velocity: Vector3<N>| velocity.map(|v| v.scaled(duration));
        let (t_v0, t_v1) = (scaled(from_velocity), scaled(to_velocity));
        Self {
            forward: Cubic::new(from, h, t_v0, t_v1),
            backward: Cubic::new(to, -h, -t_v1, -t_v0),
            ticks,
            count: N::count(ticks),
            per_duration: N::factor_over(N::quotient(1, ticks), period),
        }
    }

    /// Length of the move in ticks.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// The setpoint at `tick`, counted from the start of the move; beyond the end, the end.
    #[inline(always)]
    pub fn at(&self, tick: u32) -> Setpoint<N> {
        self.on(MoveTime::at(tick, self.ticks, &self.count))
    }

    /// The setpoint `part` of a tick, less than 1, after `tick`, or at the whole tick; beyond the end, the end.
    #[inline(always)]
    pub fn between(&self, tick: u32, part: Option<N>) -> Setpoint<N> {
        self.on(MoveTime::between(tick, part, self.ticks, &self.count))
    }

    /// The setpoint at the fraction `s` of the duration, 0 to 1; for times between ticks.
    pub fn at_fraction(&self, s: N) -> Setpoint<N> {
        self.on(MoveTime::of(s))
    }

    /// Seen from the end, time runs backwards: velocity changes sign, acceleration does not.
    #[inline(always)]
    fn on(&self, time: MoveTime<N>) -> Setpoint<N> {
        let (cubic, s, per_duration) = match time {
            MoveTime::Start(s) => (&self.forward, s, self.per_duration),
            MoveTime::End(s) => (&self.backward, s, -self.per_duration),
        };
        cubic.setpoint(s, per_duration)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn job() -> Hermite<f64> {
        Hermite::new(
            Pose::from_f64(0.0, 0.5, 0.1),
            Vector3::new(0.2, -0.4, 0.0),
            Pose::from_f64(0.3, 0.1, -0.6),
            Vector3::new(-0.1, 0.3, 0.7),
            40,
            0.05,
        )
    }

    #[test]
    fn ends_have_the_given_poses_and_velocities() {
        let job = job();
        assert_eq!(job.at(0).pose, Pose::from_f64(0.0, 0.5, 0.1));
        assert_eq!(job.at(40).pose, Pose::from_f64(0.3, 0.1, -0.6));
        assert_eq!(job.at(41), job.at(40));
        let (start, end) = (job.at(0).velocity, job.at(40).velocity);
        assert!((start - Vector3::new(0.2, -0.4, 0.0)).abs().max() < 1e-16);
        assert!((end - Vector3::new(-0.1, 0.3, 0.7)).abs().max() < 2e-16);
    }

    /// The two halves are evaluated from different ends: they are one and the same cubic, so
    /// third differences are equal all along.
    #[test]
    fn is_one_cubic_from_end_to_end() {
        let job = job();
        let x = |k: u32| job.at(k).pose.position.x;
        let third = |k: u32| x(k + 3) - 3.0 * x(k + 2) + 3.0 * x(k + 1) - x(k);
        let first = third(0);
        assert!(first.abs() > 1e-6);
        for k in 1..=37 {
            assert!((third(k) - first).abs() < 1e-15, "{k}");
        }
    }

    #[test]
    fn without_end_velocities_it_is_rest_to_rest() {
        let (from, to) = (
            Pose::<f64>::from_f64(0.21, 0.22, 0.16),
            Pose::from_f64(0.28, 0.28, 0.21),
        );
        let rest = Vector3::new(0.0, 0.0, 0.0);
        let hermite = Hermite::new(from, rest, to, rest, 100, 0.01);
        let cubic = super::super::RestToRest::new(from, to, 100, 0.01);
        for tick in 0..=100 {
            let (a, b) = (hermite.at(tick), cubic.at(tick));
            assert!((a.pose.position - b.pose.position).abs().max() < 1e-16);
            assert!((a.velocity - b.velocity).abs().max() < 1e-15);
            assert!((a.acceleration - b.acceleration).abs().max() < 1e-15);
        }
    }
}
