//! The tool of a move: power in proportion to the true speed along the path, or the same at every speed.

use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_core::to_source;
use trirrr_protocol::message::Move;

/// A tool that is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tool<N: Number> {
    /// Speed from which on it gives all it can; beyond the number type where it never does. 0 where its power is constant.
    full: N,
    /// Power per speed; the power itself where that is constant.
    power_per_speed: N::Factor,
}

to_source!([N: Number] Tool [N] in trirrr_service { full: N, power_per_speed: N::Factor });

impl<N: Number> Tool<N> {
    /// Returns true if the power and the speed of a move make sense: a power from 0 to 1, and a speed for it, or 0.
    pub(super) fn is_one(power: N, speed: N) -> bool {
        power == N::ZERO || (power > N::ZERO && power <= N::ONE && speed >= N::ZERO)
    }

    /// The tool of an offered move; none if it is off.
    pub(super) fn of(offered: &Move<N>) -> Option<Self> {
        let (power, speed) = (offered.tool_power, offered.tool_speed);
        let unit = if speed > N::ZERO { speed } else { N::ONE };
        (power > N::ZERO).then(|| Self {
            full: speed.scaled(power.reciprocal()),
            power_per_speed: N::factor_over(unit.reciprocal(), power.reciprocal()),
        })
    }

    /// Power at the speed of `setpoint`, 0 to 1.
    #[inline]
    pub(super) fn power(&self, setpoint: &Setpoint<N>) -> N {
        if self.full == N::ZERO {
            return N::ONE.scaled(self.power_per_speed);
        }
        let (x, y) = (setpoint.velocity.x, setpoint.velocity.y);
        let speed = N::ab_plus_cd(x, x, y, y).sqrt();
        if speed >= self.full {
            return N::ONE;
        }
        let power = speed.scaled(self.power_per_speed);
        if power <= N::ONE {
            power
        } else if power > N::ONE {
            N::ONE
        } else {
            // Not a number: the speed is 0, or so near that it has no inverse.
            N::ZERO
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ServiceNumber;
    use nalgebra::Vector3;
    use trirrr_core::number::Fixed;
    use trirrr_core::setpoint::Pose;

    /// Powers at three speeds, 0 the first.
    fn powers<N: ServiceNumber>(power: f64, speed: f64) -> [f64; 3] {
        let zero = Vector3::from([N::ZERO; 3]);
        let pose = Pose::from_f64(0.25, 0.25, 0.0);
        let offered = Move {
            tool_power: N::from_f64(power),
            tool_speed: N::from_f64(speed),
            ..Move::rest_to_rest(0, pose, pose, 1)
        };
        let tool = Tool::of(&offered).expect("a tool that is on");
        [0.0, 0.05, 0.4].map(|vx| {
            let setpoint = Setpoint {
                pose,
                velocity: Vector3::new(N::from_f64(vx), N::ZERO, N::ZERO),
                acceleration: zero,
            };
            tool.power(&setpoint).to_f64()
        })
    }

    fn near(found: [f64; 3], expected: [f64; 3], error: f64) {
        for (found, expected) in found.into_iter().zip(expected) {
            assert!((found - expected).abs() <= error, "{found} {expected}");
        }
    }

    #[test]
    fn power_follows_the_speed_or_is_constant() {
        fn check<N: ServiceNumber>(error: f64) {
            near(powers::<N>(0.5, 0.1), [0.0, 0.25, 1.0], error);
            near(powers::<N>(0.75, 0.0), [0.75; 3], error);
            near(powers::<N>(1.0, 0.0), [1.0; 3], error);
        }
        check::<f64>(1e-15);
        check::<f32>(1e-6);
        check::<Fixed>(1e-6);
    }
}
