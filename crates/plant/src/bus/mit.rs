//! An actuator that takes frames of the MIT mode, by the documents of the makers.

use super::frame::BusFrame;
use super::model::{Common, DriveModel, RotorTarget, Servo};
use embedded_can::{Frame, Id};
use std::f64::consts::TAU;
use trirrr_drives::can::{Answer, Mit};

const OVER_TEMPERATURE: u8 = 0xC;
const COMMUNICATION_LOST: u8 = 0xD;
/// Of a T-Motor AK: over temperature, encoder.
const AK_TOO_HOT: u8 = 1;
const AK_ENCODER: u8 = 5;

const COLD_C: u8 = 35;
const HOT_C: u8 = 120;

/// Drive on the bus in the MIT mode.
#[derive(Debug)]
pub struct MitModel {
    node: u8,
    common: Common<8>,
    settings: Mit,
    is_on: bool,
    error: u8,
    target: RotorTarget,
    told_ns: u64,
    watchdog_ns: u64,
}

impl MitModel {
    /// Drive `node` with the ranges and answers of `settings`, off. The watchdog lets it run for `watchdog_s` without a
    /// command.
    pub fn new(node: u8, servo: Servo, settings: Mit, watchdog_s: f64) -> Self {
        Self {
            node,
            common: Common::new(servo),
            settings,
            is_on: false,
            error: 0,
            target: RotorTarget::default(),
            told_ns: 0,
            watchdog_ns: (watchdog_s * 1e9) as u64,
        }
    }

    fn fail(&mut self, error: u8) {
        self.is_on = false;
        self.error = error;
    }

    fn too_hot(&self) -> u8 {
        match self.settings.answer {
            Answer::Damiao => OVER_TEMPERATURE,
            Answer::RobStride | Answer::TMotor => AK_TOO_HOT,
        }
    }

    /// Takes a command: fields from the highest bit of the first byte on.
    fn command(&mut self, data: [u8; 8]) {
        let word = u64::from_be_bytes(data);
        let field = |shift: u32, bits: u32, least: f32, most: f32| {
            let parts = word >> shift & ((1 << bits) - 1);
            let (least, most) = (f64::from(least), f64::from(most));
            least + parts as f64 * (most - least) / f64::from((1u32 << bits) - 1)
        };
        let ranges = self.settings.ranges;
        self.target = RotorTarget {
            position: field(48, 16, -ranges.position, ranges.position) / TAU,
            velocity: field(36, 12, -ranges.velocity, ranges.velocity) / TAU,
            torque: field(0, 12, -ranges.torque, ranges.torque),
        };
        let gains = [field(24, 12, 0.0, ranges.kp), field(12, 12, 0.0, ranges.kd)];
        // At the joint.
        let gear = self.common.servo.gear();
        self.common
            .servo
            .set_gains(gains.map(|gain| gain * gear * gear));
    }

    fn answer(&mut self) {
        let [position, velocity] = self.common.servo.estimates();
        if position.is_nan() {
            // Not started yet: its frames have no word for that.
            return;
        }
        let torque = self.common.servo.torque / self.common.servo.gear();
        let ranges = self.settings.ranges;
        let field = |value: f64, most: f32, bits: u32| {
            let most = f64::from(most);
            let parts = (value + most) * f64::from((1u32 << bits) - 1) / (2.0 * most);
            // The cast saturates at 0.
            (parts.round() as u64).min((1 << bits) - 1)
        };
        let fields = field(position * TAU, ranges.position, 16) << 24
            | field(velocity * TAU, ranges.velocity, 12) << 12
            | field(torque, ranges.torque, 12);
        let [.., p1, p0, v1, vt, t0] = fields.to_be_bytes();
        let celsius = if self.common.is_hot { HOT_C } else { COLD_C };
        let state = if self.error != 0 {
            self.error
        } else {
            self.is_on.into()
        };
        let [first, a, b] = match self.settings.answer {
            Answer::Damiao => [state << 4 | self.node, celsius, celsius],
            Answer::RobStride => {
                let [a, b] = (u16::from(celsius) * 10).to_be_bytes();
                [self.node, a, b]
            }
            Answer::TMotor => [self.node, celsius, self.error],
        };
        let id = self.settings.host_id.into();
        self.common
            .outbox
            .put(id, &[first, p1, p0, v1, vt, t0, a, b]);
    }
}

impl DriveModel<8> for MitModel {
    fn receive(&mut self, frame: &BusFrame<8>, now_ns: u64) {
        let Id::Standard(id) = frame.id() else {
            return;
        };
        let Ok(data) = <[u8; 8]>::try_from(frame.data()) else {
            return;
        };
        if id.as_raw() != u16::from(self.node) {
            return;
        }
        self.told_ns = now_ns;
        match data {
            [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, special] if special >= 0xFB => match special
            {
                0xFC if !self.common.is_calibrated && self.settings.answer == Answer::TMotor => {
                    self.fail(AK_ENCODER);
                }
                0xFC => {
                    self.is_on = self.error == 0 && self.common.is_calibrated;
                    // Without a torque until it is told one.
                    self.common.servo.set_gains([0.0; 2]);
                    self.target = RotorTarget::default();
                }
                0xFD => {
                    self.is_on = false;
                    // All that an AK knows.
                    if self.settings.answer == Answer::TMotor && !self.common.is_hot {
                        self.error = 0;
                    }
                }
                0xFB => {
                    self.error = if self.common.is_hot {
                        self.too_hot()
                    } else {
                        0
                    }
                }
                _ => {}
            },
            data => self.command(data),
        }
        self.answer();
    }

    fn at(&mut self, now_ns: u64) {
        if self.is_on && now_ns > self.told_ns + self.watchdog_ns {
            let lost = match self.settings.answer {
                Answer::Damiao => COMMUNICATION_LOST,
                Answer::RobStride | Answer::TMotor => 0,
            };
            self.fail(lost);
        }
    }

    fn sample(&mut self, angle: f64, period_s: f64) -> f64 {
        self.common.servo.sense(angle, period_s);
        match self.common.is_alive && self.is_on {
            true => self.common.servo.follow(&self.target),
            false => self.common.servo.release(),
        }
    }

    fn idle(&mut self) {
        self.is_on = false;
    }

    fn start(&mut self) {
        (self.is_on, self.error) = (false, 0);
        self.target = RotorTarget::default();
    }

    fn heat(&mut self) {
        self.common.is_hot = true;
        self.fail(self.too_hot());
    }

    fn common(&self) -> &Common<8> {
        &self.common
    }

    fn common_mut(&mut self) -> &mut Common<8> {
        &mut self.common
    }
}
