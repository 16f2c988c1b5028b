//! Inner loop of one joint: proportional, derivative and integral, with or without the torque of the tick fed forward.
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

/// Parameters of a [`Loop`], at the joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopParameters {
    /// Torque per error of the angle, N m/rad.
    pub kp_nm_rad: f64,
    /// Torque per error of the rate, N m s/rad.
    pub kd_nm_s_rad: f64,
    /// Torque per integral of the error of the angle, N m/(rad s); 0 for none.
    pub ki_nm_rad_s: f64,
    /// True if the torque of the tick is added.
    pub feed_forward: bool,
    /// Largest torque of either sign, N m.
    pub torque_max_nm: f64,
    /// Time from one sample to the next, s.
    pub period_s: f64,
}

/// Torque that a [`Loop`] asks for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopTorque<N> {
    /// Torque on the joint, N m, within the limit.
    pub torque: N,
    /// The limit acts: the loop wanted more.
    pub limited: bool,
}

/// Controller tau = kp e + kd (rate_ref - rate) + ki (integral of e) \[+ tau_ref\], with e = theta_ref - theta, limited.
///
/// While the limit acts, the integral takes nothing that would drive the torque farther beyond it, and by itself it never
/// grows beyond the limit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop<N> {
    kp: N,
    kd: N,
    /// ki times the period.
    ki: N,
    feed_forward: bool,
    most: N,
    pi: N,
    integral: N,
}

impl<N: Number> Loop<N> {
    /// Builds the controller, its integral at 0.
    #[inline(always)]
    pub fn build(p: &LoopParameters) -> Self {
        Self {
            kp: N::from_f64(p.kp_nm_rad),
            kd: N::from_f64(p.kd_nm_s_rad),
            ki: N::from_f64(p.ki_nm_rad_s * p.period_s),
            feed_forward: p.feed_forward,
            most: N::from_f64(p.torque_max_nm),
            pi: N::from_f64(core::f64::consts::PI),
            integral: N::ZERO,
        }
    }

    /// Sets the integral to 0.
    pub fn reset(&mut self) {
        self.integral = N::ZERO;
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

    /// Torque for a joint measured at `angle` with `rate`. An error that is not a number gives no torque.
    #[inline(always)]
    pub fn torque(&mut self, reference: &Reference<N>, angle: N::Angle, rate: N) -> LoopTorque<N> {
        let error = self.error(reference, angle);
        let mut direct = N::ab_plus_cd(self.kp, error, self.kd, reference.rate - rate);
        if self.feed_forward {
            direct += reference.torque;
        }
        let gained = self.ki * error;
        let wanted = direct + self.integral + gained;
        let (torque, limited) = limit(wanted, self.most);
        let winds_up = limited && (gained > N::ZERO) == (wanted > N::ZERO);
        if !winds_up {
            self.integral = limit(self.integral + gained, self.most).0;
        }
        LoopTorque { torque, limited }
    }
}

/// Limits `x` to `most` of either sign; `true` if `x` was outside. Not a number becomes 0.
#[inline(always)]
fn limit<N: Number>(x: N, most: N) -> (N, bool) {
    // Two comparisons for a value within, the usual case.
    if x >= -most {
        if x <= most { (x, false) } else { (most, true) }
    } else if x < -most {
        (-most, true)
    } else {
        (N::ZERO, true)
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

    const PLAIN: LoopParameters = LoopParameters {
        kp_nm_rad: 100.0,
        kd_nm_s_rad: 4.0,
        ki_nm_rad_s: 0.0,
        feed_forward: false,
        torque_max_nm: 50.0,
        period_s: 1e-3,
    };

    #[test]
    fn the_torque_pulls_towards_the_reference() {
        let mut plain = Loop::<f64>::build(&PLAIN);
        let mut fed = Loop::<f64>::build(&LoopParameters {
            feed_forward: true,
            ..PLAIN
        });
        // 100 * 0.1 + 4 * (0.5 - 0.25)
        let found = plain.torque(&reference(1.1), 1.0, 0.25);
        assert!((found.torque - 11.0).abs() < 1e-12 && !found.limited);
        assert!((fed.torque(&reference(1.1), 1.0, 0.25).torque - 11.25).abs() < 1e-12);
    }

    #[test]
    fn the_way_is_the_short_one_across_half_a_turn() {
        let inner = Loop::<f64>::build(&PLAIN);
        assert!(
            (inner.error(&reference(3.1), -3.1) - (6.2 - core::f64::consts::TAU)).abs() < 1e-15
        );
        assert!(
            (inner.error(&reference(-3.1), 3.1) + (6.2 - core::f64::consts::TAU)).abs() < 1e-15
        );
    }

    #[test]
    fn the_integral_takes_what_is_left_and_does_not_wind_up() {
        let parameters = LoopParameters {
            ki_nm_rad_s: 1000.0,
            torque_max_nm: 20.0,
            ..PLAIN
        };
        let mut inner = Loop::<f64>::build(&parameters);
        let standing = |angle| Reference::standing(angle);
        // An error of 10 mrad for 100 samples: 1 N m at once, and 1 N m more.
        let mut last = 0.0;
        for _ in 0..100 {
            last = inner.torque(&standing(0.01), 0.0, 0.0).torque;
        }
        assert!((last - 2.0).abs() < 1e-9, "{last}");
        // Far beyond the limit for a second, then at the reference: the integral is what it was.
        for _ in 0..1000 {
            let found = inner.torque(&standing(1.0), 0.0, 0.0);
            assert!(found.limited && found.torque == 20.0);
        }
        let found = inner.torque(&standing(0.0), 0.0, 0.0);
        assert!(
            (found.torque - 1.0).abs() < 1e-9 && !found.limited,
            "{found:?}"
        );
        // An error that is too small for the limit alone: the integral stops there.
        for _ in 0..100_000 {
            inner.torque(&standing(0.01), 0.0, 0.0);
        }
        assert!(inner.torque(&standing(0.0), 0.0, 0.0).torque <= 20.0);
        inner.reset();
        assert_eq!(inner.torque(&standing(0.0), 0.0, 0.0).torque, 0.0);
        let lost = inner.torque(&standing(f64::NAN), 0.0, 0.0);
        assert!(lost.torque == 0.0 && lost.limited);
        assert!(inner.torque(&standing(0.01), 0.0, 0.0).torque.is_finite());
    }

    #[test]
    fn between_ticks_the_reference_moves_on() {
        let later = reference(1.0).after(0.1);
        assert!((later.angle - (1.0 + 0.05 + 0.01)).abs() < 1e-15);
        assert!((later.rate - 0.7).abs() < 1e-15);
        assert_eq!((later.acceleration, later.torque), (2.0, 0.25));
    }
}
