//! Switches where there are none: in an emulator, and in images that count instructions.

use trirrr_core::number::Number;
use trirrr_core::setpoint::shorter_way;
use trirrr_core::tick::Motor;
use trirrr_service::HomingCoefficients;

/// How far the motors stand from where they are counted from when the machine is switched on, rad:
/// neither alike nor in one direction, and small enough for whatever way a scene leaves.
const OFFSETS_RAD: [f64; 3] = [0.05, -0.03, 0.02];

/// The switches of a machine whose motors go exactly where they are commanded, but stand elsewhere
/// than they are counted from: each is closed while its motor is at its reference or beyond. All in
/// the machine's own numbers, so that a board and a host agree on every tick.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RuledSwitches<'a, N: Number> {
    homing: &'a HomingCoefficients<N>,
    /// From where each motor is counted to where it is.
    offsets: [N::Angle; 3],
}

impl<'a, N: Number> RuledSwitches<'a, N> {
    /// Those of a machine that has just been switched on.
    pub fn new(homing: &'a HomingCoefficients<N>) -> Self {
        Self {
            homing,
            offsets: OFFSETS_RAD.map(N::angle_from_f64),
        }
    }

    /// Which are closed with the motors where `motors` were commanded.
    // A function of its own, so that its symbol shows it in an image that should not have it.
    #[inline(never)]
    pub fn closed(&self, motors: &[Motor<N>; 3]) -> [bool; 3] {
        let mut closed = [false; 3];
        let axes = self.homing.axes.iter().zip(&self.offsets);
        for ((closed, motor), (axis, offset)) in closed.iter_mut().zip(motors).zip(axes) {
            let beyond = shorter_way::<N>(motor.angle + *offset - axis.contact);
            *closed = match axis.search > N::ZERO {
                true => beyond >= N::ZERO,
                false => beyond <= N::ZERO,
            };
        }
        closed
    }

    /// The motors are counted anew, from `by` further on, without a motion.
    pub fn shift(&mut self, by: [N::Angle; 3]) {
        for (offset, by) in self.offsets.iter_mut().zip(by) {
            *offset = *offset - by;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_service::{Contact, HomingMotor, HomingParameters, HomingTimes};

    fn coefficients() -> HomingCoefficients<f64> {
        let motor = |angle_rad, positive| HomingMotor {
            angle_rad,
            positive,
            search_rate_rad_s: 0.5,
            latch_rate_rad_s: 0.05,
            acceleration_rad_s2: 2.0,
            back_off_rad: 0.1,
            travel_max_rad: 1.0,
            stage: 0,
        };
        let parameters = HomingParameters {
            contact: Contact::Switch,
            // The last beyond half a turn from where it is counted.
            motors: [motor(0.4, true), motor(-0.4, false), motor(-3.1, true)],
            debounce_ticks: 3,
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
