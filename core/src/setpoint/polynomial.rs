//! Polynomials in time, given by what they are at both ends, so that moves chain without stopping.

use super::move_time::MoveTime;
use super::{Pose, Setpoint};
use crate::number::Number;
use crate::source::ToSource;
use crate::to_source;
use nalgebra::Vector3;

/// A polynomial of every coordinate over s = t / T, from one end of a move into it.
pub trait Polynomial<N: Number> {
    /// Pose, dq/ds and d^2 q/ds^2 at `s`.
    fn at(&self, s: N) -> (Pose<N>, Vector3<N>, Vector3<N>);

    /// d^3 q/ds^3 at `s`.
    fn third_at(&self, s: N) -> Vector3<N>;
}

/// A move along polynomials in time. It is kept from both ends, and evaluated from the nearer one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TwoSided<N: Number, P> {
    forward: P,
    backward: P,
    ticks: u32,
    count: N::Count,
    /// 1 / T.
    per_duration: N::Factor,
}

/// The Hermite cubic: pose and velocity given at both ends, on every coordinate
/// q = q0 + c1 s + c2 s^2 + c3 s^3 with s = t / T, h = q1 - q0 and
///
/// ```text
/// c1 = T v0,   c2 = 3 h - T (2 v0 + v1),   c3 = T (v0 + v1) - 2 h
/// ```
pub type Hermite<N> = TwoSided<N, Cubic<N>>;

/// The quintic: pose, velocity and acceleration given at both ends. On every coordinate, with s = t / T, h = q1 - q0,
/// the products of s and 1 - s in A = s (1 - s), z = 1 - 2 s, and
///
/// ```text
/// m = 2 h - T (v0 + v1),   n = T (v1 - v0),   f = T^2 (a0 + a1) / 4,   k = T^2 (a0 - a1) / 4 - 3 m / 2
/// q = q0 + T v0 s + m s^2 (3 - 2 s) / 2 + n s^3 (2 - s) / 2 + A^2 (f + k z)
/// ```
///
/// Each of these functions of s is at most 1 in size, and small are m, n, f and k where the velocity changes little:
/// so are their roundings. Coefficients of powers of s would be tens of times as large, and cancel.
pub type Quintic<N> = TwoSided<N, Fifth<N>>;

/// A cubic from one end: time runs from that end into the move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cubic<N: Number> {
    origin: Pose<N>,
    c1: Vector3<N>,
    c2: Vector3<N>,
    c3: Vector3<N>,
}

/// A polynomial of the fifth degree from one end, likewise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fifth<N: Number> {
    origin: Pose<N>,
    /// T v0.
    start: Vector3<N>,
    m: Vector3<N>,
    n: Vector3<N>,
    f: Vector3<N>,
    k: Vector3<N>,
}

to_source!([N: Number, P: ToSource] TwoSided [N, P] in trirrr_core::setpoint {
    forward: P,
    backward: P,
    ticks: u32,
    count: N::Count,
    per_duration: N::Factor,
});

to_source!([N: Number] Cubic [N] in trirrr_core::setpoint {
    origin: Pose<N>,
    c1: Vector3<N>,
    c2: Vector3<N>,
    c3: Vector3<N>,
});

to_source!([N: Number] Fifth [N] in trirrr_core::setpoint {
    origin: Pose<N>,
    start: Vector3<N>,
    m: Vector3<N>,
    n: Vector3<N>,
    f: Vector3<N>,
    k: Vector3<N>,
});

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
}

impl<N: Number> Polynomial<N> for Cubic<N> {
    #[inline(always)]
    fn at(&self, s: N) -> (Pose<N>, Vector3<N>, Vector3<N>) {
        let three_c3_s = self.c3 * (s + s + s);
        let half = self.c2 + three_c3_s;
        (
            self.origin
                .displaced((self.c1 + (self.c2 + self.c3 * s) * s) * s),
            self.c1 + (self.c2 + self.c2 + three_c3_s) * s,
            half + half,
        )
    }

    fn third_at(&self, _: N) -> Vector3<N> {
        let twice = self.c3 + self.c3;
        twice + twice + twice
    }
}

impl<N: Number> Fifth<N> {
    /// As [`Cubic::new`]; `e0`, `e1`: a quarter of the square of the duration times acceleration at both ends.
    fn new(
        origin: Pose<N>,
        h: Vector3<N>,
        [t_v0, t_v1]: [Vector3<N>; 2],
        [e0, e1]: [Vector3<N>; 2],
    ) -> Self {
        let m = (h - t_v0) + (h - t_v1);
        Self {
            origin,
            start: t_v0,
            m,
            n: t_v1 - t_v0,
            f: e0 + e1,
            k: (e0 - e1) - (m + m * N::HALF),
        }
    }
}

impl<N: Number> Polynomial<N> for Fifth<N> {
    /// The derivatives of A and z by s are z and -2, and z^2 = 1 - 4 A.
    #[inline(always)]
    fn at(&self, s: N) -> (Pose<N>, Vector3<N>, Vector3<N>) {
        let Self {
            origin,
            start,
            m,
            n,
            f,
            k,
        } = *self;
        let rest = N::ONE - s;
        let (a, z, s_sq) = (s * rest, rest - s, s * s);
        let (a2, a_sq, half_blend) = (a + a, a * a, s_sq * (N::HALF + rest));
        let (a3, z2, blend) = (a2 + a, z + z, half_blend + half_blend);
        let (a5, a6) = (a3 + a2, a3 + a3);
        let way = start * s
            + m * half_blend
            + n * (s_sq * s * (N::ONE - s * N::HALF))
            + f * a_sq
            + k * (a_sq * z);
        let first = start + m * a3 + n * blend + f * (a2 * z) + k * (a2 * (N::ONE - a5));
        let second = m * (z2 + z)
            + n * a6
            + f * ((N::ONE - a6) + (N::ONE - a6))
            + k * (z2 * (N::ONE - (a5 + a5)));
        (origin.displaced(way), first, second)
    }

    /// -6 m + 6 z (n - 2 f) + 24 k (5 A - 1).
    fn third_at(&self, s: N) -> Vector3<N> {
        let rest = N::ONE - s;
        let (a, z) = (s * rest, rest - s);
        let a5 = a + a + a + a + a;
        let twice_k = self.k + self.k;
        let third = (self.n - (self.f + self.f)) * z - self.m + (twice_k + twice_k) * (a5 - N::ONE);
        let twice = third + third;
        twice + twice + twice
    }
}

/// `v` times a factor, component by component: a closure for all three would be called at level `z`.
#[inline(always)]
fn scaled<N: Number>(v: Vector3<N>, by: N::Factor) -> Vector3<N> {
    Vector3::new(v.x.scaled(by), v.y.scaled(by), v.z.scaled(by))
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
        let (t_v0, t_v1) = (
            scaled(from_velocity, duration),
            scaled(to_velocity, duration),
        );
        Self::over(
            Cubic::new(from, h, t_v0, t_v1),
            Cubic::new(to, -h, -t_v1, -t_v0),
            ticks,
            period,
        )
    }
}

impl<N: Number> Quintic<N> {
    /// The move between the poses `poses` in `ticks` ticks of `period` seconds each, both positive, with velocities
    /// (vx, vy, alphadot) and accelerations at its ends.
    pub fn new(
        [from, to]: [Pose<N>; 2],
        velocities: [Vector3<N>; 2],
        accelerations: [Vector3<N>; 2],
        ticks: u32,
        period: N::Factor,
    ) -> Self {
        let h = from.displacement(&to);
        let duration = N::quotient(ticks, 1) * period;
        let [t_v0, t_v1] = velocities.map(|v| scaled(v, duration));
        let [e0, e1] = accelerations
            .map(|a| a.map(|a| a.scaled_twice(duration, duration) * (N::HALF * N::HALF)));
        Self::over(
            Fifth::new(from, h, [t_v0, t_v1], [e0, e1]),
            Fifth::new(to, -h, [-t_v1, -t_v0], [e1, e0]),
            ticks,
            period,
        )
    }
}

impl<N: Number, P: Polynomial<N>> TwoSided<N, P> {
    fn over(forward: P, backward: P, ticks: u32, period: N::Factor) -> Self {
        Self {
            forward,
            backward,
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

    /// Third derivative of the pose at the fraction `s` of the duration.
    pub fn jerk_at_fraction(&self, s: N) -> Vector3<N> {
        let (third, per_duration) = match MoveTime::of(s) {
            MoveTime::Start(s) => (self.forward.third_at(s), self.per_duration),
            MoveTime::End(s) => (self.backward.third_at(s), -self.per_duration),
        };
        let squared = per_duration * per_duration;
        third.map(|third| third.scaled_twice(squared, per_duration))
    }

    /// Seen from the end, time runs backwards: velocity changes sign, acceleration does not.
    #[inline(always)]
    fn on(&self, time: MoveTime<N>) -> Setpoint<N> {
        let (polynomial, s, per_duration) = match time {
            MoveTime::Start(s) => (&self.forward, s, self.per_duration),
            MoveTime::End(s) => (&self.backward, s, -self.per_duration),
        };
        let (pose, first, second) = polynomial.at(s);
        Setpoint {
            pose,
            velocity: scaled(first, per_duration),
            acceleration: scaled(second, per_duration * per_duration),
        }
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
        let jerk = cubic.jerk(0.01);
        assert!((jerk + (cubic.at(0).acceleration * 2.0)).abs().max() < 1e-14);
        for s in [0.25, 0.75] {
            assert!((hermite.jerk_at_fraction(s) - jerk).abs().max() < 1e-14);
        }
        for tick in 0..=100 {
            let (a, b) = (hermite.at(tick), cubic.at(tick));
            assert!((a.pose.position - b.pose.position).abs().max() < 1e-16);
            assert!((a.velocity - b.velocity).abs().max() < 1e-15);
            assert!((a.acceleration - b.acceleration).abs().max() < 1e-15);
        }
    }

    fn quintic(accelerations: [Vector3<f64>; 2]) -> Quintic<f64> {
        Quintic::new(
            [
                Pose::from_f64(0.0, 0.5, 0.1),
                Pose::from_f64(0.3, 0.1, -0.6),
            ],
            [Vector3::new(0.2, -0.4, 0.0), Vector3::new(-0.1, 0.3, 0.7)],
            accelerations,
            40,
            0.05,
        )
    }

    #[test]
    fn a_quintic_has_the_given_poses_velocities_and_accelerations() {
        let given = [Vector3::new(0.5, 0.0, -3.0), Vector3::new(-1.0, 2.0, 0.25)];
        let quintic = quintic(given);
        assert_eq!(quintic.at(0).pose, Pose::from_f64(0.0, 0.5, 0.1));
        assert_eq!(quintic.at(40).pose, Pose::from_f64(0.3, 0.1, -0.6));
        assert_eq!(quintic.at(41), quintic.at(40));
        for (tick, given) in [(0, given[0]), (40, given[1])] {
            let acceleration = quintic.at(tick).acceleration;
            assert!((acceleration - given).abs().max() < 1e-15, "{tick}");
        }
        let end = quintic.at(40).velocity;
        assert!((end - Vector3::new(-0.1, 0.3, 0.7)).abs().max() < 2e-16);
    }

    /// One polynomial of the fifth degree: sixth differences vanish, over the middle too. Velocities and
    /// accelerations are the derivatives.
    #[test]
    fn a_quintic_is_one_polynomial_with_its_derivatives() {
        let quintic = quintic([Vector3::new(0.5, 0.0, -3.0), Vector3::new(-1.0, 2.0, 0.25)]);
        let x = |k: u32| quintic.at(k).pose.position.x;
        for k in 0..=34 {
            let sixth = [1.0, -6.0, 15.0, -20.0, 15.0, -6.0, 1.0];
            let difference: f64 = (0..).zip(sixth).map(|(i, weight)| weight * x(k + i)).sum();
            assert!(difference.abs() < 1e-14, "{k} {difference}");
        }
        let step = 1e-4;
        for s in [0.1, 0.3, 0.5, 0.7, 0.9] {
            let [before, at, after] = [s - step, s, s + step].map(|s| quintic.at_fraction(s));
            let time = 2.0 * step * 2.0;
            let rate = before.pose.displacement(&after.pose) / time;
            assert!((rate - at.velocity).abs().max() < 1e-6, "{s}");
            let rate = (after.velocity - before.velocity) / time;
            assert!((rate - at.acceleration).abs().max() < 1e-6, "{s}");
            let rate = (after.acceleration - before.acceleration) / time;
            let jerk = quintic.jerk_at_fraction(s);
            assert!((rate - jerk).abs().max() < 1e-6, "{s} {rate} {jerk}");
        }
    }

    /// With the accelerations of the cubic at its ends, the quintic is the cubic.
    #[test]
    fn a_quintic_with_the_accelerations_of_a_cubic_is_that_cubic() {
        let cubic = job();
        let quintic = quintic([cubic.at(0).acceleration, cubic.at(40).acceleration]);
        for tick in 0..=40 {
            let (a, b) = (cubic.at(tick), quintic.at(tick));
            assert!((a.pose.position - b.pose.position).abs().max() < 1e-15);
            assert!((a.velocity - b.velocity).abs().max() < 1e-14);
            assert!((a.acceleration - b.acceleration).abs().max() < 1e-13);
        }
    }
}
