//! From torque to current, and from current to duty.
//!
//! The winding is a direct-current equivalent behind a gear of ratio N, with joint torque tau and
//! joint rate w, both positive counter-clockwise:
//!
//! ```text
//! tau = N Kt i             L di/dt = u - R i - N Ke w
//! ```
//! The command is the stationary one, u = R i + N Ke w: the inductance settles within L / R.

use trirrr_core::number::Number;

/// Brushless motor and its supply, SI units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BldcParameters {
    /// N: turns of the rotor per turn of the joint.
    pub gear_ratio: f64,
    /// R, ohm.
    pub resistance_ohm: f64,
    /// Kt, N m/A at the rotor.
    pub torque_constant_nm_a: f64,
    /// Ke, V s/rad at the rotor.
    pub back_emf_constant_v_s_rad: f64,
    /// Supply voltage, V.
    pub supply_v: f64,
    /// Largest current of either sign, A.
    pub current_limit_a: f64,
}

/// Coefficients of a motor. Current and voltage are fractions of the limit and of the supply, of order one in
/// any number type.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bldc<N> {
    /// 1 / (N Kt I_max)
    current_per_torque: N,
    /// R I_max / U
    duty_per_current: N,
    /// N Ke / U
    duty_per_rate: N,
}

/// Command for the power stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BldcCommand<N> {
    /// Current, as a fraction of the limit, -1 to 1.
    pub current: N,
    /// Voltage across the winding as a fraction of the supply, -1 to 1.
    pub duty: N,
    /// Limit that acts, if one does: the motor gives less than the torque asked for.
    pub limited: Option<DriveLimit>,
}

/// Limit of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveLimit {
    /// The torque needs more than the largest current.
    Current,
    /// Current and back-EMF need more than the supply.
    Voltage,
}

impl<N: Number> Bldc<N> {
    /// Builds the coefficients for torques in N m and rates in rad/s. All parameters have to be positive.
    pub fn build(p: &BldcParameters) -> Self {
        let per_ampere = p.gear_ratio * p.torque_constant_nm_a;
        Self {
            current_per_torque: N::from_f64(1.0 / (per_ampere * p.current_limit_a)),
            duty_per_current: N::from_f64(p.resistance_ohm * p.current_limit_a / p.supply_v),
            duty_per_rate: N::from_f64(p.gear_ratio * p.back_emf_constant_v_s_rad / p.supply_v),
        }
    }

    /// Coefficients by name: an image generator checks that they fit the number type.
    pub fn coefficients(&self) -> [(&'static str, N); 3] {
        [
            ("current over torque", self.current_per_torque),
            ("duty over current", self.duty_per_current),
            ("duty over rate", self.duty_per_rate),
        ]
    }

    /// Command for `torque` at a joint that turns at `rate`. Limits the current first, then the voltage.
    #[inline(always)]
    pub fn command(&self, torque: N, rate: N) -> BldcCommand<N> {
        let (current, over_current) = limit(torque * self.current_per_torque);
        let (duty, over_voltage) = limit(N::ab_plus_cd(
            current,
            self.duty_per_current,
            rate,
            self.duty_per_rate,
        ));
        let limited = match (over_current, over_voltage) {
            (_, true) => Some(DriveLimit::Voltage),
            (true, false) => Some(DriveLimit::Current),
            (false, false) => None,
        };
        BldcCommand {
            current,
            duty,
            limited,
        }
    }
}

/// Limits `x` to -1 to 1; `true` if `x` was outside. Not a number becomes 0: no torque.
#[inline(always)]
fn limit<N: Number>(x: N) -> (N, bool) {
    // Two comparisons for a value within, the usual case.
    if x >= -N::ONE {
        if x <= N::ONE {
            (x, false)
        } else {
            (N::ONE, true)
        }
    } else if x < -N::ONE {
        (-N::ONE, true)
    } else {
        (N::ZERO, true)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MOTOR: BldcParameters = BldcParameters {
        gear_ratio: 10.0,
        resistance_ohm: 0.5,
        torque_constant_nm_a: 0.05,
        back_emf_constant_v_s_rad: 0.05,
        supply_v: 24.0,
        current_limit_a: 20.0,
    };

    #[test]
    fn the_command_is_the_stationary_one() {
        let motor = Bldc::<f64>::build(&MOTOR);
        // 3 N m take 3 / (10 * 0.05) = 6 A; u = 0.5 * 6 + 10 * 0.05 * 4 = 5 V.
        let command = motor.command(3.0, 4.0);
        assert!((command.current * 20.0 - 6.0).abs() < 1e-14);
        assert!((command.duty * 24.0 - 5.0).abs() < 1e-14);
        assert_eq!(command.limited, None);
    }

    #[test]
    fn limits_hold_and_say_so() {
        let motor = Bldc::<f32>::build(&MOTOR);
        // 11 N m would take 22 A: 20 A at 10 V remain.
        let command = motor.command(-11.0, 0.0);
        assert_eq!(command.current, -1.0);
        assert_eq!(command.limited, Some(DriveLimit::Current));
        assert!((command.duty + 10.0 / 24.0).abs() < 1e-6);
        // 50 rad/s at the joint take 25 V.
        let command = motor.command(0.0, 50.0);
        assert_eq!(
            (command.duty, command.limited),
            (1.0, Some(DriveLimit::Voltage))
        );
        let command = motor.command(f32::NAN, 0.0);
        assert_eq!((command.current, command.duty), (0.0, 0.0));
        assert_eq!(command.limited, Some(DriveLimit::Current));
    }
}
