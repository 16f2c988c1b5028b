//! Profiles of which a motion is made. In each phase the acceleration goes linearly. Time is in ticks.

use nalgebra::Vector3;
use trirrr_core::number::Number;

/// A phase: acceleration at its start and at its end, and its length.
type Phase<B> = (B, B, u32);

/// Displacement, velocity and acceleration `tick` ticks after the start of `phases`, with `velocity` there.
fn after<B: Number>(velocity: B, phases: &[Phase<B>], tick: u32) -> [B; 3] {
    let mut state = [B::ZERO, velocity, B::ZERO];
    let mut left = tick;
    for &(start, end, ticks) in phases.iter().filter(|phase| phase.2 > 0) {
        let t = B::ratio(left.min(ticks), 1);
        let gain = (end - start) * B::ratio(left.min(ticks), ticks);
        let [way, velocity, acceleration] = &mut state;
        *way += (*velocity + (start + gain * B::ratio(1, 3)) * (B::HALF * t)) * t;
        *velocity += (start + B::HALF * gain) * t;
        *acceleration = start + gain;
        if left <= ticks {
            break;
        }
        left -= ticks;
    }
    state
}

/// From a velocity and an acceleration to rest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Brake<B: Number> {
    /// Per tick.
    pub(super) velocity: Vector3<B>,
    /// Per tick and tick.
    pub(super) acceleration: Vector3<B>,
    pub(super) rest: Rest,
}

/// Time in which a motion comes to rest.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rest {
    pub(super) ticks: u32,
    /// The acceleration changes in one such part of the time, at its start and at its end; 0 where the motion is one
    /// polynomial.
    pub(super) parts: u32,
}

impl Rest {
    /// At rest already.
    pub(super) const NONE: Self = Self { ticks: 0, parts: 2 };
}

impl<B: Number> Brake<B> {
    /// Fewest ticks: one to change the acceleration, one to end it.
    pub(super) const SHORTEST: u32 = 2;

    fn ramp(&self) -> u32 {
        let Rest { ticks, parts } = self.rest;
        ticks.checked_div(parts).map_or(ticks, |part| part.max(1))
    }

    /// Ends of the phases.
    pub(super) fn knots(&self) -> [u32; 3] {
        let Rest { ticks, .. } = self.rest;
        let ramp = self.ramp();
        [ramp, ticks.saturating_sub(ramp).max(ramp), ticks]
    }

    /// Displacement, velocity and acceleration at `tick`; behind the end, at rest.
    pub(super) fn at(&self, tick: u32) -> [Vector3<B>; 3] {
        if self.rest == Rest::NONE {
            return [Vector3::from([B::ZERO; 3]); 3];
        }
        if self.rest.parts == 0 {
            return self.polynomial_at(tick.min(self.rest.ticks));
        }
        let ramp = self.ramp();
        let steady = self.rest.ticks - 2 * ramp;
        // A unit of velocity is taken away, and that which a unit of acceleration adds on its way to `steady`.
        let slow = -B::ratio(1, steady + ramp);
        let bend = slow * B::ratio(ramp, 2);
        let at = tick.min(self.rest.ticks);
        let phases = |start, hold| {
            [
                (start, hold, ramp),
                (hold, hold, steady),
                (hold, B::ZERO, ramp),
            ]
        };
        let of_velocity = after(B::ONE, &phases(B::ZERO, slow), at);
        let of_acceleration = after(B::ZERO, &phases(B::ONE, bend), at);
        let mut state = [0, 1, 2].map(|order: usize| {
            self.velocity * of_velocity[order] + self.acceleration * of_acceleration[order]
        });
        if tick >= self.rest.ticks {
            // Without rounding.
            (state[1], state[2]) = (Vector3::from([B::ZERO; 3]), Vector3::from([B::ZERO; 3]));
        }
        state
    }

    /// As [`at`](Self::at), along the polynomial of the fourth degree. With s = t / T its velocity is
    /// v (1 - s)^2 (1 + 2 s) + a T s (1 - s)^2.
    fn polynomial_at(&self, tick: u32) -> [Vector3<B>; 3] {
        let Rest { ticks, .. } = self.rest;
        let (t, s) = (B::ratio(tick, 1), B::ratio(tick, ticks));
        let left = B::ratio(ticks - tick, ticks);
        let (half, third, quarter) = (B::HALF, B::ratio(1, 3), B::ratio(1, 4));
        let (v, a, s_sq) = (self.velocity, self.acceleration, s * s);
        let of_a = B::HALF - (third + third) * s + quarter * s_sq;
        [
            v * (t * (B::ONE - s_sq * (B::ONE - half * s))) + a * (t * t * of_a),
            (v * (B::ONE + s + s) + a * t) * (left * left),
            v * (-B::ratio(6, ticks) * s * left) + a * (left * (B::ONE - s - s - s)),
        ]
    }
}

/// From rest to rest over a way of 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Transfer {
    pub(super) ticks: u32,
    /// Ticks in which it speeds up, and slows down.
    run: u32,
}

impl Transfer {
    /// Fewest ticks.
    pub(super) const SHORTEST: u32 = 16;

    /// `part`: 32nds of the time in which it speeds up, at most 16; 0 for one polynomial. `ticks`: [`SHORTEST`](Self::SHORTEST) or more.
    pub(super) fn new(ticks: u32, part: u32) -> Self {
        let run = u64::from(ticks) * u64::from(part) / 32;
        Self {
            ticks,
            run: if part == 0 { 0 } else { (run as u32).max(4) },
        }
    }

    fn ramp(&self) -> u32 {
        (self.run / 10).max(1)
    }

    /// Ends of the phases.
    pub(super) fn knots(&self) -> [u32; 6] {
        let Self { ticks, run } = *self;
        if run == 0 {
            return [ticks; 6];
        }
        let ramp = self.ramp();
        // Without a steady velocity the acceleration goes linearly from one sign to the other.
        let [up, down] = match 2 * run < ticks {
            true => [run, ticks - run],
            false => [run - ramp, run + ramp],
        };
        [ramp, run - ramp, up, down, ticks - run + ramp, ticks - ramp]
    }

    /// Way, velocity and acceleration at `tick`; behind the end, at rest.
    pub(super) fn at<B: Number>(&self, tick: u32) -> [B; 3] {
        let Self { ticks, run } = *self;
        if tick >= ticks {
            return [B::ONE, B::ZERO, B::ZERO];
        }
        if run == 0 {
            return self.polynomial_at(tick);
        }
        let ramp = self.ramp();
        let speed = B::ratio(1, ticks - run);
        let full = speed * B::ratio(1, run - ramp);
        let half = |a: B| {
            [
                (B::ZERO, a, ramp),
                (a, a, run - 2 * ramp),
                (a, B::ZERO, ramp),
            ]
        };
        let ([a, b, c], [d, e, f]) = (half(full), half(-full));
        let cruise = (B::ZERO, B::ZERO, ticks - 2 * run);
        after(B::ZERO, &[a, b, c, cruise, d, e, f], tick)
    }

    /// As [`at`](Self::at), along s^3 (10 - 15 s + 6 s^2) with s = t / T.
    fn polynomial_at<B: Number>(&self, tick: u32) -> [B; 3] {
        let (s, rest) = (
            B::ratio(tick, self.ticks),
            B::ratio(self.ticks - tick, self.ticks),
        );
        let (six, ten, thirty) = (B::ratio(6, 1), B::ratio(10, 1), B::ratio(30, self.ticks));
        let (s_sq, both) = (s * s, s * rest);
        [
            s_sq * s * (ten - B::ratio(15, 1) * s + six * s_sq),
            thirty * both * both,
            thirty * B::ratio(2, self.ticks) * both * (rest - s),
        ]
    }
}
