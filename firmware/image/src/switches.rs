//! Simulated homing switches, for emulators and for images that count instructions.

use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_service::coefficients::HomingCoefficients;

/// True minus counted angle of each motor at the start, rad: different, of both signs, and within the travel of
/// any scene.
const OFFSETS_RAD: [f64; 3] = [0.05, -0.03, 0.02];

/// Switches of a machine whose motors follow every command, but start at other angles than counted. Each
/// switch is closed while its motor is at its reference or beyond. The arithmetic is the machine's, so that a
/// board and a host agree on every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuledSwitches<'a, N: Number> {
    homing: &'a HomingCoefficients<N>,
    /// True minus counted angle of each motor.
    offsets: [N::Angle; 3],
}

impl<'a, N: Number> RuledSwitches<'a, N> {
    /// Switches of a machine that has just been switched on.
    pub fn new(homing: &'a HomingCoefficients<N>) -> Self {
        Self {
            homing,
            offsets: OFFSETS_RAD.map(N::angle_from_f64),
        }
    }

    /// Returns `true` for each closed switch, with the motors at the commanded angles `motors`.
    // A function of its own: its symbol shows an image that must not hold it.
    #[inline(never)]
    pub fn closed(&self, motors: &[Motor<N>; 3]) -> [bool; 3] {
        [0, 1, 2].map(|i| {
            let angle = motors[i].angle + self.offsets[i];
            self.homing.is_at_reference(i, angle)
        })
    }

    /// Follows a new zero of the joint angles: all are greater `by` so much, without a motion.
    pub fn shift(&mut self, by: [N::Angle; 3]) {
        for (offset, by) in self.offsets.iter_mut().zip(by) {
            *offset = *offset - by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_service::features::{Contact, HomingMotor, HomingParameters, HomingTimes};

    fn coefficients() -> HomingCoefficients<f64> {
        let motor = |angle_rad, positive| HomingMotor {
            angle_rad,
            positive,
            search_rate_rad_s: 0.5,
            latch_rate_rad_s: 0.05,
            acceleration_rad_s2: 2.0,
            back_off_rad: 0.1,
            travel_max_rad: 1.0,
            stall_torque_nm: 0.0,
            stage: 0,
        };
        let parameters = HomingParameters {
            contact: Contact::Switch,
            // The last beyond half a turn from where it is counted.
            motors: [motor(0.4, true), motor(-0.4, false), motor(-3.1, true)],
            debounce_ticks: 3,
            stall_is_fault: false,
            start: [0.0; 3],
            times: HomingTimes::default(),
        };
        HomingCoefficients::build(&parameters, 0.001)
    }

    fn motors(angles: [f64; 3]) -> [Motor<f64>; 3] {
        angles.map(|angle| Motor {
            angle,
            rate: 0.0,
            acceleration: 0.0,
            torque: 0.0,
        })
    }

    #[test]
    fn each_closes_where_its_motor_truly_is_at_its_reference() {
        let homing = coefficients();
        let mut switches = RuledSwitches::new(&homing);
        for (angles, closed) in [
            ([0.34, -0.36, 3.1], [false, false, false]),
            ([0.36, -0.36, 3.1], [true, false, false]),
            ([0.34, -0.38, 3.1], [false, true, false]),
            // Round the half turn: 0.01 beyond -3.1.
            ([0.34, -0.36, -3.11], [false, false, true]),
        ] {
            assert_eq!(switches.closed(&motors(angles)), closed, "{angles:?}");
        }
        // Counted from where they are, they close where the scene says.
        switches.shift(OFFSETS_RAD);
        let (before, beyond) = ([0.399, -0.399, -3.101], [0.401, -0.401, -3.099]);
        assert_eq!(switches.closed(&motors(before)), [false; 3]);
        assert_eq!(switches.closed(&motors(beyond)), [true; 3]);
    }
}
