//! Amplifiers that control the current of a motor, simulated.
//!
//! The winding is a direct-current equivalent behind a gear of ratio N, with joint torque tau and
//! joint rate w, both positive counter-clockwise:
//!
//! ```text
//! tau = N Kt i             L di/dt = u - R i - N Ke w
//! ```
//! At each sample the amplifier sets the voltage that the current wanted takes in the steady state, u = R i + N Ke w, as far as
//! the supply goes. The current follows within L / R.

use trirrr_scene::{Bldc, Drive, DriveKind};

/// Limit of a drive.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DriveLimit {
    /// The torque needs more than the largest current.
    Current,
    /// Current and back-EMF need more than the supply.
    Voltage,
}

/// Amplifier of a motor, seen at its joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct PowerStage {
    resistance_ohm: f64,
    /// N Kt, N m/A.
    torque_constant: f64,
    /// N Ke, V s/rad.
    back_emf: f64,
    supply_v: f64,
    current_limit_a: f64,
}

impl PowerStage {
    /// Amplifier of `drive`, if it is one.
    pub(crate) fn of(drive: &Drive) -> Option<Self> {
        let DriveKind::Bldc(bldc) = drive.kind else {
            return None;
        };
        let Bldc {
            resistance_ohm,
            torque_constant_nm_a,
            back_emf_constant_v_s_rad,
            supply_v,
            current_limit_a,
            ..
        } = bldc;
        Some(Self {
            resistance_ohm,
            torque_constant: drive.gear_ratio * torque_constant_nm_a,
            back_emf: drive.gear_ratio * back_emf_constant_v_s_rad,
            supply_v,
            current_limit_a,
        })
    }

    /// Torque of the largest current, N m.
    pub(crate) fn torque_max_nm(&self) -> f64 {
        self.torque_constant * self.current_limit_a
    }

    /// Voltage in V for `torque` at a joint that turns at `rate`; true if the supply limits it.
    pub(crate) fn voltage(&self, torque: f64, rate: f64) -> (f64, bool) {
        let current = torque / self.torque_constant;
        let wanted = self.resistance_ohm * current + self.back_emf * rate;
        let voltage = wanted.clamp(-self.supply_v, self.supply_v);
        (voltage, voltage != wanted)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_voltage_is_that_of_the_steady_state() {
        let stage = PowerStage {
            resistance_ohm: 0.5,
            torque_constant: 0.5,
            back_emf: 0.5,
            supply_v: 24.0,
            current_limit_a: 20.0,
        };
        // 3 N m take 6 A; u = 0.5 * 6 + 0.5 * 4 = 5 V.
        assert_eq!(stage.voltage(3.0, 4.0), (5.0, false));
        // 50 rad/s at the joint take 25 V.
        assert_eq!(stage.voltage(0.0, 50.0), (24.0, true));
        assert_eq!(stage.torque_max_nm(), 10.0);
    }
}
