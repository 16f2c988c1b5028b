//! Inner loop of one joint: proportional and derivative, with or without the torque of the tick fed forward.
//!
//! The loop runs faster than the ticks: [`Reference::after`] extrapolates the setpoint of a tick.

use trirrr_core::number::Number;
use trirrr_core::tick::Motor;

/// Setpoint of a joint at one instant.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reference<N: Number> {
    /// theta_1, modulo a turn.
    pub angle: N::Angle,
    /// Rate of theta_1.
    pub rate: N,
    /// Acceleration of theta_1.
    pub acceleration: N,
    /// Torque of the motor on the joint for this motion.
    pub torque: N,
}

impl<N: Number> From<&Motor<N>> for Reference<N> {
    fn from(motor: &Motor<N>) -> Self {
        Self {
            angle: motor.angle,
            rate: motor.rate,
            acceleration: motor.acceleration,
            torque: motor.torque,
        }
    }
}

impl<N: Number> Reference<N> {
    /// Reference that stands at `angle`, without torque.
    pub fn standing(angle: N::Angle) -> Self {
        Self {
            angle,
            rate: N::ZERO,
            acceleration: N::ZERO,
            torque: N::ZERO,
        }
    }

    /// Reference `elapsed` seconds later, at constant acceleration and torque.
    #[inline(always)]
    pub fn after(&self, elapsed: N) -> Self {
        let gained = self.acceleration * elapsed;
        let turned = (self.rate + N::HALF * gained) * elapsed;
        Self {
            angle: self.angle + N::angle(turned),
            rate: self.rate + gained,
            acceleration: self.acceleration,
            torque: self.torque,
        }
    }
}

/// Controller tau = kp (theta_ref - theta) + kd (rate_ref - rate) \[+ tau_ref\].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop<N> {
    kp: N,
    kd: N,
    feed_forward: bool,
    pi: N,
}

impl<N: Number> Loop<N> {
    /// Controller with `kp` in N m/rad and `kd` in N m s/rad at the joint.
    pub fn build(kp: f64, kd: f64, feed_forward: bool) -> Self {
        Self {
            kp: N::from_f64(kp),
            kd: N::from_f64(kd),
            feed_forward,
            pi: N::from_f64(core::f64::consts::PI),
        }
    }

    /// Angle from the joint at `angle` to the reference, the short way round, rad. Both angles have to be
    /// within a turn of each other.
    #[inline(always)]
    pub fn error(&self, reference: &Reference<N>, angle: N::Angle) -> N {
        let error = N::radians(reference.angle - angle);
        if error > self.pi {
            error - self.pi - self.pi
        } else if error < -self.pi {
            error + self.pi + self.pi
        } else {
            error
        }
    }

    /// Torque for a joint measured at `angle` with `rate`.
    #[inline(always)]
    pub fn torque(&self, reference: &Reference<N>, angle: N::Angle, rate: N) -> N {
        let error = self.error(reference, angle);
        let torque = N::ab_plus_cd(self.kp, error, self.kd, reference.rate - rate);
        if self.feed_forward {
            torque + reference.torque
        } else {
            torque
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reference(angle: f64) -> Reference<f64> {
        Reference {
            angle,
            rate: 0.5,
            acceleration: 2.0,
            torque: 0.25,
        }
    }

    #[test]
    fn the_torque_pulls_towards_the_reference() {
        let plain = Loop::<f64>::build(100.0, 4.0, false);
        let fed = Loop::<f64>::build(100.0, 4.0, true);
        // 100 * 0.1 + 4 * (0.5 - 0.25)
        let torque = plain.torque(&reference(1.1), 1.0, 0.25);
        assert!((torque - 11.0).abs() < 1e-12);
        assert!((fed.torque(&reference(1.1), 1.0, 0.25) - 11.25).abs() < 1e-12);
    }

    #[test]
    fn the_way_is_the_short_one_across_half_a_turn() {
        let inner = Loop::<f64>::build(1.0, 0.0, false);
        assert!(
            (inner.error(&reference(3.1), -3.1) - (6.2 - core::f64::consts::TAU)).abs() < 1e-15
        );
        assert!(
            (inner.error(&reference(-3.1), 3.1) + (6.2 - core::f64::consts::TAU)).abs() < 1e-15
        );
    }

    #[test]
    fn between_ticks_the_reference_moves_on() {
        let later = reference(1.0).after(0.1);
        assert!((later.angle - (1.0 + 0.05 + 0.01)).abs() < 1e-15);
        assert!((later.rate - 0.7).abs() < 1e-15);
        assert_eq!((later.acceleration, later.torque), (2.0, 0.25));
    }
}
