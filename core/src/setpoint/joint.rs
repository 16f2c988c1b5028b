//! Moves in joint space: for machines whose pose is not known yet, as before homing.

use super::move_time::MoveTime;
use crate::number::Number;
use crate::to_source;

/// A move of the three motor angles from rest to rest, in the same time. Each motor follows the cubic
/// of [`RestToRest`](super::RestToRest), the shorter way round.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointMove<N: Number> {
    from: [N::Angle; 3],
    to: [N::Angle; 3],
    ticks: u32,
    count: N::Count,
    /// h, at most half a turn.
    displacement: [N; 3],
    /// 6 / T.
    velocity: N::Factor,
    /// 6 / T^2.
    acceleration: N::Factor,
}

/// Angle, rate and acceleration of the three motors at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointSetpoint<N: Number> {
    /// Angles, in (-pi, pi] but for rounding.
    pub angles: [N::Angle; 3],
    /// Rates.
    pub rates: [N; 3],
    /// Accelerations.
    pub accelerations: [N; 3],
}

to_source!([N: Number] JointMove [N] in trirrr_core::setpoint {
    from: [N::Angle; 3],
    to: [N::Angle; 3],
    ticks: u32,
    count: N::Count,
    displacement: [N; 3],
    velocity: N::Factor,
    acceleration: N::Factor,
});

impl<N: Number> JointMove<N> {
    /// The move `from` -> `to` in `ticks` ticks of `period` each, both positive. The angles lie in
    /// (-pi, pi].
    pub fn new(from: [N::Angle; 3], to: [N::Angle; 3], ticks: u32, period: N::Factor) -> Self {
        let per_duration = N::factor_over(N::quotient(1, ticks), period);
        let velocity = N::quotient(6, 1) * per_duration;
        let way = |motor: usize| shorter_way::<N>(to[motor] - from[motor]);
        Self {
            from,
            to,
            ticks,
            count: N::count(ticks),
            displacement: [way(0), way(1), way(2)],
            velocity,
            acceleration: velocity * per_duration,
        }
    }

    /// Length of the move in ticks.
    pub fn ticks(&self) -> u32 {
        self.ticks
    }

    /// Angles at the end of the move.
    pub fn to(&self) -> [N::Angle; 3] {
        self.to
    }

    /// The largest rate of each motor, 3 h / (2 T), and the largest acceleration, 6 h / T^2.
    pub fn peaks(&self) -> ([N; 3], [N; 3]) {
        let quarter = N::HALF * N::HALF;
        let rate = |way: N| (way * quarter).scaled(self.velocity).abs();
        let acceleration = |way: N| way.scaled(self.acceleration).abs();
        (
            self.displacement.map(rate),
            self.displacement.map(acceleration),
        )
    }

    /// The setpoint `part` of a tick, less than 1, after `tick`, or at the whole tick; beyond the end, the end.
    pub fn between(&self, tick: u32, part: Option<N>) -> JointSetpoint<N> {
        // From the nearer end, so that both ends are exact.
        let (s, base, towards, slope) = match MoveTime::between(tick, part, self.ticks, &self.count)
        {
            MoveTime::Start(s) => (s, &self.from, N::ONE, N::ONE - (s + s)),
            MoveTime::End(s) => (s, &self.to, -N::ONE, (s + s) - N::ONE),
        };
        let blend = s * s * ((N::ONE - s) + (N::ONE - s) + N::ONE) * towards;
        let bow = s * (N::ONE - s);
        let [h1, h2, h3] = self.displacement;
        let [b1, b2, b3] = *base;
        let angle = |base: N::Angle, way: N| wrapped::<N>(base + N::angle(way * blend));
        JointSetpoint {
            angles: [angle(b1, h1), angle(b2, h2), angle(b3, h3)],
            rates: self
                .displacement
                .map(|way| (way * bow).scaled(self.velocity)),
            accelerations: self
                .displacement
                .map(|way| (way * slope).scaled(self.acceleration)),
        }
    }
}

/// Returns `way`, the difference of two angles in (-pi, pi], the shorter way round: rad, in (-pi, pi].
pub fn shorter_way<N: Number>(way: N::Angle) -> N {
    // Wrapped as an angle: twice a turn in radians is beyond fixed point.
    N::radians(wrapped::<N>(way))
}

/// Wraps `angle` into (-pi, pi]; it lies less than a turn outside.
pub fn wrapped<N: Number>(angle: N::Angle) -> N::Angle {
    let half = N::radians(N::half_turn());
    let radians = N::radians(angle);
    let turn = N::angle(half) + N::angle(half);
    if radians > half {
        angle - turn
    } else if radians < -half {
        angle + turn
    } else {
        angle
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::{Arithmetic, WideArithmetic};
    use core::f64::consts::PI;

    #[test]
    fn both_ends_are_exact_and_at_rest() {
        let (from, to) = ([3.1, -0.2, 1.0], [-3.1, 0.7, 1.0]);
        let joint = JointMove::<f64>::new(from, to, 9, 0.01);
        assert_eq!(joint.between(0, None).angles, from);
        assert_eq!(joint.between(9, None).angles, to);
        assert_eq!(joint.between(9, Some(0.5)), joint.between(9, None));
        for tick in [0, 9] {
            assert_eq!(joint.between(tick, None).rates, [0.0; 3]);
        }
    }

    #[test]
    fn takes_the_shorter_way_round() {
        let joint = JointMove::<f64>::new([3.1, -3.1, 0.0], [-3.1, 3.1, 3.0], 10, 0.1);
        let way = 2.0 * PI - 6.2;
        let (rates, accelerations) = joint.peaks();
        // 3 h / (2 T) and 6 h / T^2 with T = 1 s.
        for (motor, way) in [way, way, 3.0].into_iter().enumerate() {
            assert!((rates[motor] - 1.5 * way).abs() < 1e-14);
            assert!((accelerations[motor] - 6.0 * way).abs() < 1e-13);
        }
        for tick in 0..=10 {
            let [up, down, _] = joint.between(tick, None).angles;
            assert!(up.abs() >= 3.1 && up.abs() <= PI, "{tick} {up}");
            assert!(down.abs() >= 3.1 && down.abs() <= PI, "{tick} {down}");
        }
        assert!((joint.between(5, None).rates[0] - rates[0]).abs() < 1e-15);
    }

    /// The turn in between is more than the number type holds.
    #[test]
    fn takes_the_shorter_way_round_in_fixed_point() {
        use crate::number::Fixed;
        let angle = Fixed::angle_from_f64;
        let (from, to) = ([3.1, -3.1, 0.0], [-3.1, 3.1, 3.0]);
        let period = Fixed::factor_from_f64(0.1);
        let joint = JointMove::<Fixed>::new(from.map(angle), to.map(angle), 20, period);
        assert_eq!(joint.between(0, None).angles, from.map(angle));
        assert_eq!(joint.between(20, None).angles, to.map(angle));
        for tick in 0..=20 {
            let [up, down, _] = joint.between(tick, None).angles;
            for angle in [up, down] {
                let angle = Fixed::angle_to_f64(angle);
                assert!(
                    angle.abs() >= 3.1 - 1e-8 && angle.abs() <= PI + 1e-8,
                    "{tick} {angle}"
                );
            }
        }
    }

    /// Rates are the derivative of the angles, accelerations that of the rates.
    #[test]
    fn derivatives_fit() {
        let joint = JointMove::<f64>::new([0.0; 3], [1.0, -2.0, 0.5], 20, 0.05);
        let step = 1e-5;
        for tick in [3, 9, 10, 11, 16] {
            let (before, now, after) = (
                joint.between(tick, Some(0.5 - step)),
                joint.between(tick, Some(0.5)),
                joint.between(tick, Some(0.5 + step)),
            );
            let time = 2.0 * step * 0.05;
            for motor in 0..3 {
                let rate = (after.angles[motor] - before.angles[motor]) / time;
                let acceleration = (after.rates[motor] - before.rates[motor]) / time;
                assert!((rate - now.rates[motor]).abs() < 1e-8);
                assert!((acceleration - now.accelerations[motor]).abs() < 1e-7);
            }
        }
    }
}
