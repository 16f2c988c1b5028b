//! The motors of a machine without encoders, as they truly are: steps are taken and lost, switches
//! close, and nobody but these know where the motors are.

use core::f64::consts::{PI, TAU};
use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_protocol::message::DriveReading;
use trirrr_scene::{DriveKind, Homing, Scene};
use trirrr_service::features::Contact;

/// The joint angles that motors are commanded to, rad.
pub(super) fn angles<N: Number>(motors: &[Motor<N>; 3]) -> [f64; 3] {
    motors.each_ref().map(|motor| N::angle_to_f64(motor.angle))
}

/// Torque of a motor at its stop, over that which tells the stop.
const PRESS: f64 = 1.5;

/// Motors, and the switches or stops that they meet.
pub(super) struct Motors {
    homing: Homing,
    /// A step of each, rad at the joint.
    steps: [f64; 3],
    /// True joint angles, rad, not wrapped.
    angles: [f64; 3],
    /// Joint angles of the last command, rad.
    commanded: [f64; 3],
    /// Rest of the commands that is less than a step, rad.
    rest: [f64; 3],
    /// Pressed against a stop.
    stalls: [bool; 3],
    /// One unit of torque of the machine, N m.
    torque_nm: f64,
}

impl Motors {
    /// Of `scene`, `offset` rad from where the machine counts from, `commanded`. `torque_nm` is the machine's unit of torque.
    pub(super) fn new(
        scene: &Scene,
        homing: Homing,
        commanded: [f64; 3],
        offset: [f64; 3],
        torque_nm: f64,
    ) -> Self {
        let steps = match &scene.drives {
            Some(drives) => drives.map(|drive| match drive.kind {
                DriveKind::Stepper(stepper) => {
                    let turn = f64::from(stepper.steps_per_rev) * f64::from(stepper.microsteps);
                    TAU / (turn * drive.gear_ratio)
                }
                _ => 0.0,
            }),
            None => [0.0; 3],
        };
        Self {
            homing,
            steps,
            angles: [0, 1, 2].map(|i| commanded[i] + offset[i]),
            commanded,
            rest: [0.0; 3],
            stalls: [false; 3],
            torque_nm,
        }
    }

    /// Offsets that a machine may have, of its own for each `key`: before the references, by up to
    /// half of the way there and back.
    pub(super) fn some_offset(homing: &Homing, key: u32, commanded: [f64; 3]) -> [f64; 3] {
        [0, 1, 2].map(|i| {
            let motor = &homing.motors[i];
            let sign = motor.sign();
            let way = (sign * (motor.angle_rad - commanded[i])).rem_euclid(TAU);
            let most = 0.5 * way.min(motor.travel_max_rad - way);
            let bits = key.wrapping_mul(2 * i as u32 + 0x9e37_79b1).rotate_left(13);
            most * (f64::from(bits) / f64::from(u32::MAX) * 2.0 - 1.0)
        })
    }

    /// Inputs of homing: true in a switch, or while a motor stalls.
    pub(super) fn inputs(&self) -> [bool; 3] {
        [0, 1, 2].map(|i| match self.homing.contact {
            Contact::Switch => self.past(i) >= 0.0,
            Contact::Stall => self.stalls[i],
            // The drives tell a torque.
            Contact::Torque | Contact::Unfelt => false,
        })
    }

    /// Moves them to where `commanded` says, of which `shift` is no motion.
    pub(super) fn follow(&mut self, commanded: [f64; 3], shift: Option<[f64; 3]>) {
        let shift = shift.unwrap_or_default();
        for i in 0..3 {
            let way = wrapped(commanded[i] - self.commanded[i] - shift[i]) + self.rest[i];
            let step = self.steps[i];
            let taken = if step > 0.0 {
                (way / step).round() * step
            } else {
                way
            };
            self.rest[i] = way - taken;
            self.commanded[i] = commanded[i];
            self.angles[i] += taken;
            let over = self.past(i);
            self.stalls[i] = self.homing.contact != Contact::Switch && over > 0.0;
            // A drive that follows its joint loses nothing.
            let loses = self.stalls[i] && self.homing.contact != Contact::Torque;
            if loses {
                self.angles[i] -= self.homing.motors[i].sign() * over;
            }
        }
    }

    /// True joint angles less the commanded ones, rad.
    pub(super) fn errors(&self) -> [f64; 3] {
        [0, 1, 2].map(|i| wrapped(self.angles[i] - self.commanded[i]))
    }

    /// Puts the joints of drives that tell their torque at the stops against which they press.
    pub(super) fn press<N: Number>(&self, readings: &mut [DriveReading<N>; 3]) {
        for (i, reading) in readings.iter_mut().enumerate() {
            if self.homing.contact == Contact::Torque && self.stalls[i] {
                let motor = &self.homing.motors[i];
                let (sign, stall) = (motor.sign(), motor.stall_torque_nm / self.torque_nm);
                reading.torque = N::from_f64(sign * PRESS * stall);
                reading.angle = reading.angle - N::angle_from_f64(sign * self.past(i));
            }
        }
    }

    /// Joint angle of motor `i` beyond its reference, rad; negative before.
    fn past(&self, i: usize) -> f64 {
        let motor = &self.homing.motors[i];
        motor.sign() * wrapped(self.angles[i] - motor.angle_rad)
    }
}

/// `angle` in [-pi, pi).
pub(super) fn wrapped(angle: f64) -> f64 {
    (angle + PI).rem_euclid(TAU) - PI
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_are_wrapped_to_half_a_turn() {
        for (angle, expected) in [
            (0.1, 0.1),
            (PI + 0.1, 0.1 - PI),
            (-PI - 0.1, PI - 0.1),
            (6.2, 6.2 - TAU),
        ] {
            assert!((wrapped(angle) - expected).abs() < 1e-12, "{angle}");
        }
    }
}
