//! The tool of a move: power in proportion to the true speed along the path.

use trirrr_core::number::Number;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::Move;

/// A tool that is on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tool<N: Number> {
    /// Speed from which on it gives all it can; beyond the number type where it never does.
    full: N,
    /// Power per speed.
    power_per_speed: N::Factor,
}

impl<N: Number> Tool<N> {
    /// Returns true if the power and the speed of a move make sense: a power from 0 to 1, a speed for it.
    pub(super) fn is_one(power: N, speed: N) -> bool {
        power == N::ZERO || (power > N::ZERO && power <= N::ONE && speed > N::ZERO)
    }

    /// The tool of an offered move; none if it is off.
    pub(super) fn of(offered: &Move<N>) -> Option<Self> {
        let (power, speed) = (offered.tool_power, offered.tool_speed);
        (power > N::ZERO).then(|| Self {
            full: speed.scaled(power.reciprocal()),
            power_per_speed: N::factor_over(speed.reciprocal(), power.reciprocal()),
        })
    }

    /// Power at the speed of `setpoint`, 0 to 1.
    #[inline]
    pub(super) fn power(&self, setpoint: &Setpoint<N>) -> N {
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
