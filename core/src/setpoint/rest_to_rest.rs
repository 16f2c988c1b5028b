//! The rest-to-rest cubic, thesis (5.1) to (5.10).

use super::move_time::MoveTime;
use super::{Pose, Setpoint};
use crate::number::Number;
use crate::to_source;
use nalgebra::Vector3;

/// A move that starts and ends at rest: q = q0 + h s^2 (3 - 2 s) with s = t / T, on every
/// coordinate. Velocity 6 h s (1 - s) / T, acceleration 6 h (1 - 2 s) / T^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestToRest<N: Number> {
    from: Pose<N>,
    to: Pose<N>,
    ticks: u32,
    count: N::Count,
    /// h.
    displacement: Vector3<N>,
    /// 6 h / T.
    velocity: Vector3<N>,
    /// 6 h / T^2.
    acceleration: Vector3<N>,
}

to_source!([N: Number] RestToRest [N] in trirrr_core::setpoint {
    from: Pose<N>,
    to: Pose<N>,
    ticks: u32,
    count: N::Count,
    displacement: Vector3<N>,
    velocity: Vector3<N>,
    acceleration: Vector3<N>,
});

impl<N: Number> RestToRest<N> {
    /// The move `from` -> `to` in `ticks` ticks of `period` seconds each, both positive.
    pub fn new(from: Pose<N>, to: Pose<N>, ticks: u32, period: N::Factor) -> Self {
        let displacement = from.displacement(&to);
        let per_duration = N::factor_over(N::quotient(1, ticks), period);
        let six_per_duration = N::quotient(6, 1) * per_duration;
        Self {
            from,
            to,
            ticks,
            count: N::count(ticks),
            displacement,
            velocity: displacement.map(|h| h.scaled(six_per_duration)),
            acceleration: displacement.map(|h| h.scaled_twice(six_per_duration, per_duration)),
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

    /// The setpoint at the fraction `s` of the duration, 0 to 1; for times between ticks. The admission
    /// runs this one; one body for both halves keeps its code small.
    pub fn at_fraction(&self, s: N) -> Setpoint<N> {
        let (from, s, is_late) = match MoveTime::of(s) {
            MoveTime::Start(s) => (&self.from, s, false),
            MoveTime::End(s) => (&self.to, s, true),
        };
        let mut way = self.displacement * blend(s);
        let mut slope = N::ONE - (s + s);
        if is_late {
            (way, slope) = (-way, -slope);
        }
        Setpoint {
            pose: from.displaced(way),
            velocity: self.velocity * (s * (N::ONE - s)),
            acceleration: self.acceleration * slope,
        }
    }

    /// Third derivative of the pose, in ticks of `period`: -12 h / T^3.
    pub fn jerk(&self, period: N::Factor) -> Vector3<N> {
        let per_duration = N::factor_over(N::quotient(1, self.ticks), period);
        let twice = N::quotient(2, 1) * -per_duration;
        self.acceleration.map(|a| a.scaled(twice))
    }

    /// The setpoint `part` of a tick, less than 1, after `tick`, or at the whole tick; beyond the end, the end.
    #[inline(always)]
    pub fn between(&self, tick: u32, part: Option<N>) -> Setpoint<N> {
        self.on(MoveTime::between(tick, part, self.ticks, &self.count))
    }

    #[inline(always)]
    fn on(&self, time: MoveTime<N>) -> Setpoint<N> {
        match time {
            MoveTime::Start(s) => self.after_start(s),
            MoveTime::End(s) => self.before_end(s),
        }
    }

    #[inline(always)]
    fn after_start(&self, s: N) -> Setpoint<N> {
        Setpoint {
            pose: self.from.displaced(self.displacement * blend(s)),
            velocity: self.velocity * (s * (N::ONE - s)),
            acceleration: self.acceleration * (N::ONE - (s + s)),
        }
    }

    #[inline(always)]
    fn before_end(&self, s: N) -> Setpoint<N> {
        Setpoint {
            pose: self.to.displaced(-(self.displacement * blend(s))),
            velocity: self.velocity * (s * (N::ONE - s)),
            acceleration: self.acceleration * ((s + s) - N::ONE),
        }
    }
}

/// s^2 (3 - 2 s).
#[inline(always)]
fn blend<N: Number>(s: N) -> N {
    let three = N::ONE + N::ONE + N::ONE;
    s * s * (three - (s + s))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_ends_are_exact_and_at_rest() {
        let (from, to) = (
            Pose::<f32>::from_f64(0.1, -0.7, 3.3),
            Pose::from_f64(1.3, 0.9, -1e4),
        );
        for ticks in [1, 3, 100, u32::MAX] {
            let job = RestToRest::new(from, to, ticks, 0.01);
            assert_eq!(job.at(0).pose, from);
            assert_eq!(job.at(ticks).pose, to);
            assert_eq!(job.at(u32::MAX).pose, to);
            for end in [0, ticks] {
                assert_eq!(job.at(end).velocity, Vector3::new(0.0, 0.0, 0.0));
            }
        }
    }

    #[test]
    fn the_middle_has_the_speed_of_the_formula() {
        let job = RestToRest::new(
            Pose::<f64>::from_f64(0.0, 1.0, 0.0),
            Pose::from_f64(2.0, 1.0, -1.0),
            10,
            0.1,
        );
        let middle = job.at(5);
        // 6 h s (1 - s) / T with T = 1 s and s = 1/2.
        assert!((middle.velocity - Vector3::new(3.0, 0.0, -1.5)).abs().max() < 1e-15);
        assert_eq!(middle.acceleration, Vector3::new(0.0, 0.0, 0.0));
        assert_eq!(middle, job.at_fraction(0.5));
        // 6 h / T^2 at the start, its opposite at the end.
        assert!(
            (job.at(0).acceleration - Vector3::new(12.0, 0.0, -6.0))
                .abs()
                .max()
                < 1e-13
        );
        assert_eq!(job.at(0).acceleration, -job.at(10).acceleration);
    }
}
