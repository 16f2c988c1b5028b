//! A moteus, by its documentation: registers in CAN FD frames.

use super::frame::BusFrame;
use super::model::{Common, DriveModel, RotorTarget, Servo};
use embedded_can::{Frame, Id};

const STOPPED: u8 = 0;
const FAULT: u8 = 1;
const POSITION: u8 = 10;
const TIMEOUT: u8 = 11;

const MOTOR_NOT_CONFIGURED: u8 = 36;
const OVER_TEMPERATURE: u8 = 38;

const COLD_C: f32 = 35.0;
const HOT_C: f32 = 90.0;
const SUPPLY_V: f32 = 24.0;

/// Scales of int8, int16 and int32 in the unit of a register.
fn scales(register: u8) -> [f64; 3] {
    match register {
        0x01 | 0x20 => [0.01, 1e-4, 1e-5],
        0x02 | 0x21 => [0.1, 0.000_25, 1e-5],
        0x03 | 0x22 => [0.5, 0.01, 0.001],
        0x0D => [0.5, 0.1, 0.001],
        0x0E => [1.0, 0.1, 0.001],
        _ => [1.0; 3],
    }
}

/// Drive on the bus with registers.
#[derive(Debug)]
pub struct MoteusModel {
    node: u8,
    common: Common<64>,
    mode: u8,
    fault: u8,
    target: RotorTarget,
    /// Time of the command, and up to which it counts.
    told_ns: u64,
    watchdog_ns: u64,
    now_ns: u64,
}

impl MoteusModel {
    /// Drive `node`, calibrated and stopped. A command counts for `watchdog_s`.
    pub fn new(node: u8, servo: Servo, watchdog_s: f64) -> Self {
        Self {
            node,
            common: Common::new(servo),
            mode: STOPPED,
            fault: 0,
            target: RotorTarget::default(),
            told_ns: 0,
            watchdog_ns: (watchdog_s * 1e9) as u64,
            now_ns: 0,
        }
    }

    fn fail(&mut self, fault: u8) {
        (self.mode, self.fault) = (FAULT, fault);
    }

    /// Writes the mode: a stop clears a fault, and nothing else leaves one.
    fn enter(&mut self, mode: u8) {
        match (mode, self.mode) {
            (STOPPED, _) => {
                (self.mode, self.fault) = (STOPPED, 0);
                if self.common.is_hot {
                    self.fail(OVER_TEMPERATURE);
                }
            }
            (_, FAULT | TIMEOUT) => {}
            (POSITION, _) if !self.common.is_calibrated => self.fail(MOTOR_NOT_CONFIGURED),
            (mode, _) => self.mode = mode,
        }
    }

    fn write(&mut self, register: u8, value: f64) {
        match register {
            0x00 => self.enter(value as u8),
            0x20 => self.target.position = value,
            0x21 => self.target.velocity = value,
            0x22 => self.target.torque = value,
            _ => {}
        }
    }

    fn read(&self, register: u8) -> f64 {
        let [position, velocity] = self.common.servo.estimates();
        match register {
            0x00 => self.mode.into(),
            0x01 => position,
            0x02 => velocity,
            0x03 => self.common.servo.torque / self.common.servo.gear(),
            0x0D => SUPPLY_V.into(),
            0x0E => f64::from(if self.common.is_hot { HOT_C } else { COLD_C }),
            0x0F => self.fault.into(),
            _ => 0.0,
        }
    }

    /// Carries out the subframes and makes the reply; none for bytes that are not subframes.
    fn carry_out(&mut self, mut data: &[u8]) -> Option<Vec<u8>> {
        let mut reply = Vec::new();
        while let [subframe, rest @ ..] = data {
            data = rest;
            if *subframe == 0x50 {
                continue;
            }
            let number = match subframe & 0x03 {
                0 => {
                    let (number, rest) = data.split_first()?;
                    data = rest;
                    *number
                }
                number => number,
            };
            let (register, rest) = data.split_first()?;
            data = rest;
            let kind = usize::from(subframe >> 2 & 0x03);
            let reads = match subframe & 0xF0 {
                0x00 => false,
                0x10 => true,
                _ => return None,
            };
            if reads {
                reply.extend([0x20 | (kind as u8) << 2, number, *register]);
            }
            for register in *register..register.saturating_add(number) {
                let scale = scales(register).get(kind).copied();
                if reads {
                    encode(&mut reply, kind, self.read(register), scale);
                    continue;
                }
                let (value, rest) = decode(kind, data, scale)?;
                data = rest;
                self.write(register, value);
            }
        }
        Some(reply)
    }
}

/// Appends a value of this kind; without a scale, a float.
fn encode(reply: &mut Vec<u8>, kind: usize, value: f64, scale: Option<f64>) {
    let parts = match value.is_nan() {
        // The most negative number is none.
        true => f64::NEG_INFINITY,
        false => (value / scale.unwrap_or(1.0)).round(),
    };
    // Casts saturate.
    match kind {
        0 => reply.extend((parts as i8).to_le_bytes()),
        1 => reply.extend((parts as i16).to_le_bytes()),
        2 => reply.extend((parts as i32).to_le_bytes()),
        _ => reply.extend((value as f32).to_le_bytes()),
    }
}

/// Value of this kind at the beginning of `data`, and what follows.
fn decode(kind: usize, data: &[u8], scale: Option<f64>) -> Option<(f64, &[u8])> {
    let (bytes, rest) = data.split_at_checked([1, 2, 4, 4][kind])?;
    let whole = match *bytes {
        [a] => i32::from(a as i8),
        [a, b] => i32::from(i16::from_le_bytes([a, b])),
        [a, b, c, d] if kind == 3 => return Some((f32::from_le_bytes([a, b, c, d]).into(), rest)),
        [a, b, c, d] => i32::from_le_bytes([a, b, c, d]),
        _ => return None,
    };
    Some((f64::from(whole) * scale.unwrap_or(1.0), rest))
}

impl DriveModel<64> for MoteusModel {
    fn receive(&mut self, frame: &BusFrame<64>, now_ns: u64) {
        let id = match frame.id() {
            Id::Standard(id) => u32::from(id.as_raw()),
            Id::Extended(id) => id.as_raw(),
        };
        if id & 0xFF != u32::from(self.node) {
            return;
        }
        let commands = frame.data().first().is_some_and(|first| first & 0xF0 == 0);
        if commands {
            self.told_ns = now_ns;
        }
        let Some(mut reply) = self.carry_out(frame.data()) else {
            return;
        };
        if id & 0x8000 != 0 {
            let host = id >> 8 & 0x7F;
            // A length that CAN FD has.
            let lengths = [8, 12, 16, 20, 24, 32, 48, 64];
            if let Some(length) = lengths.into_iter().find(|length| *length >= reply.len()) {
                reply.resize(length, 0x50);
            }
            self.common
                .outbox
                .put(u32::from(self.node) << 8 | host, &reply);
        }
    }

    fn at(&mut self, now_ns: u64) {
        self.now_ns = now_ns;
        if self.mode == POSITION && now_ns > self.told_ns + self.watchdog_ns {
            self.mode = TIMEOUT;
        }
    }

    fn sample(&mut self, angle: f64, period_s: f64) -> f64 {
        self.common.servo.sense(angle, period_s);
        if !self.common.is_alive || self.mode != POSITION {
            return self.common.servo.release();
        }
        // The commanded position goes on at the commanded velocity.
        let since_s = self.now_ns.saturating_sub(self.told_ns) as f64 * 1e-9;
        let target = RotorTarget {
            position: self.target.position + self.target.velocity * since_s,
            ..self.target
        };
        self.common.servo.follow(&target)
    }

    fn idle(&mut self) {
        self.mode = STOPPED;
    }

    fn start(&mut self) {
        (self.mode, self.fault) = (STOPPED, 0);
        self.target = RotorTarget::default();
    }

    fn heat(&mut self) {
        self.common.is_hot = true;
        self.fail(OVER_TEMPERATURE);
    }

    fn common(&self) -> &Common<64> {
        &self.common
    }

    fn common_mut(&mut self) -> &mut Common<64> {
        &mut self.common
    }
}
