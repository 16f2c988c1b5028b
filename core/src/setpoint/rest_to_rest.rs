//! The rest-to-rest cubic, thesis (5.1) to (5.10).

use super::{Pose, Setpoint};
use crate::number::Number;
use nalgebra::Vector3;

/// A move that starts and ends at rest: q = q0 + h s^2 (3 - 2 s) with s = t / T, on every
/// coordinate. Velocity 6 h s (1 - s) / T, acceleration 6 h (1 - 2 s) / T^2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RestToRest<N: Number> {
    from: Pose<N>,
    to: Pose<N>,
    ticks: u32,
    /// h.
    displacement: Vector3<N>,
    /// 6 h / T.
    velocity: Vector3<N>,
    /// 6 h / T^2.
    acceleration: Vector3<N>,
}

impl<N: Number> RestToRest<N> {
    /// The move `from` -> `to` in `ticks` ticks of `period` seconds each, both positive.
    pub fn new(from: Pose<N>, to: Pose<N>, ticks: u32, period: N) -> Self {
        let displacement = from.displacement(&to);
        let per_duration = N::ratio(1, ticks).div(period);
        let velocity = displacement * (N::ratio(6, 1) * per_duration);
        Self {
            from,
            to,
            ticks,
            displacement,
            velocity,
            acceleration: velocity * per_duration,
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
        if tick <= left {
            self.after_start(N::ratio(tick, self.ticks))
        } else {
            self.before_end(N::ratio(left, self.ticks))
        }
    }

    /// The setpoint at the fraction `s` of the duration, 0 to 1; for times between ticks.
    pub fn at_fraction(&self, s: N) -> Setpoint<N> {
        if s <= N::HALF {
            self.after_start(s)
        } else {
            self.before_end(N::ONE - s)
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
    s * s * ((N::ONE - s) + (N::ONE - s) + N::ONE)
}
