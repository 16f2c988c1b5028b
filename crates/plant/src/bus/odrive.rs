//! An ODrive of firmware 0.6, by its documentation.

use super::frame::BusFrame;
use super::model::{Common, DriveModel, RotorTarget, Servo};
use embedded_can::{Frame, Id};

const IDLE: u8 = 1;
const CLOSED_LOOP: u8 = 8;
const POSITION_CONTROL: u32 = 3;
const PASSTHROUGH: u32 = 1;

const DISARMED: u8 = 3;
const INVALID_STATE: u8 = 13;
const NOT_CALIBRATED: u8 = 14;

const MOTOR_OVER_TEMP: u32 = 0x2000;
const WATCHDOG_TIMER_EXPIRED: u32 = 0x0100_0000;
const ESTOP_REQUESTED: u32 = 0x0200_0000;

const COLD_C: f32 = 35.0;
const HOT_C: f32 = 130.0;
const SUPPLY_V: f32 = 48.0;

/// Cyclic messages: command and period, ns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Cycle {
    command: u8,
    period_ns: u64,
    due_ns: u64,
}

/// Drive on the bus with CANSimple.
#[derive(Debug)]
pub struct OdriveModel {
    node: u32,
    common: Common<8>,
    state: u8,
    result: u8,
    errors: u32,
    disarm_reason: u32,
    modes: [u32; 2],
    target: RotorTarget,
    watchdog_ns: u64,
    fed_ns: u64,
    cycles: [Cycle; 3],
}

impl OdriveModel {
    /// Drive `node`, calibrated and idle, that sends `messages_hz` messages by itself, one heartbeat for ten estimates
    /// of the encoder and as many of the torque. The watchdog lets it run for `watchdog_s` without a command.
    pub fn new(node: u8, servo: Servo, messages_hz: f64, watchdog_s: f64) -> Self {
        let node = u32::from(node);
        let cycle = |command: u8, share: f64| Cycle {
            command,
            period_ns: (1e9 / (messages_hz * share)) as u64,
            // The phases of several drives differ.
            due_ns: 1_000_000 + u64::from(node) * 137_000 + u64::from(command) * 11_000,
        };
        Self {
            node,
            common: Common::new(servo),
            state: IDLE,
            result: 0,
            errors: 0,
            disarm_reason: 0,
            modes: [0; 2],
            target: RotorTarget::default(),
            watchdog_ns: (watchdog_s * 1e9) as u64,
            fed_ns: 0,
            cycles: [
                cycle(0x01, 1.0 / 21.0),
                cycle(0x09, 10.0 / 21.0),
                cycle(0x1C, 10.0 / 21.0),
            ],
        }
    }

    /// Opens the loop for an error.
    fn disarm(&mut self, error: u32) {
        self.errors |= error;
        if self.state == CLOSED_LOOP {
            self.disarm_reason |= error;
            self.result = DISARMED;
        }
        self.state = IDLE;
    }

    /// Carries out a request for a state.
    fn request(&mut self, state: u32, now_ns: u64) {
        self.result = match state {
            1 => 0,
            8 if self.errors != 0 => INVALID_STATE,
            8 if !self.common.is_calibrated => NOT_CALIBRATED,
            8 => 0,
            _ => INVALID_STATE,
        };
        if self.result != 0 {
            return;
        }
        self.state = state as u8;
        if self.state == CLOSED_LOOP {
            // No step: it holds where it is until it is told otherwise.
            let [position, _] = self.common.servo.estimates();
            self.target = RotorTarget {
                position,
                ..RotorTarget::default()
            };
            self.fed_ns = now_ns;
        }
    }

    /// Puts a message into the outbox.
    fn tell(&mut self, command: u8) {
        let [position, velocity] = self.common.servo.estimates();
        let torque = (self.common.servo.torque / self.common.servo.gear()) as f32;
        let floats = |one: f32, two: f32| (one.to_bits(), two.to_bits());
        let (one, two) = match command {
            0x01 => {
                let words = [self.state, self.result, 0, 0];
                (self.errors | self.disarm_reason, u32::from_le_bytes(words))
            }
            0x03 => (self.errors, self.disarm_reason),
            0x09 => floats(position as f32, velocity as f32),
            0x15 => {
                let motor = if self.common.is_hot { HOT_C } else { COLD_C };
                floats(COLD_C, motor)
            }
            0x17 => floats(SUPPLY_V, 0.0),
            0x1C => floats(torque, torque),
            _ => return,
        };
        let data = u64::from(one) | u64::from(two) << 32;
        self.common
            .outbox
            .put(self.node << 5 | u32::from(command), &data.to_le_bytes());
    }
}

impl DriveModel<8> for OdriveModel {
    fn receive(&mut self, frame: &BusFrame<8>, now_ns: u64) {
        let Id::Standard(id) = frame.id() else {
            return;
        };
        if u32::from(id.as_raw()) >> 5 != self.node {
            return;
        }
        let command = id.as_raw() as u8 & 0x1F;
        if frame.is_remote_frame() {
            self.tell(command);
            return;
        }
        let data = frame.data();
        let word = |at: usize| {
            let bytes = data.get(at..at + 4)?;
            Some(u32::from_le_bytes(bytes.try_into().ok()?))
        };
        let half = |at: usize| {
            let bytes = data.get(at..at + 2)?;
            Some(f64::from(i16::from_le_bytes(bytes.try_into().ok()?)) * 1e-3)
        };
        match (command, word(0), word(4)) {
            (0x02, ..) => self.disarm(ESTOP_REQUESTED),
            (0x07, Some(state), _) => self.request(state, now_ns),
            (0x0B, Some(control), Some(input)) => self.modes = [control, input],
            (0x0C, Some(position), Some(_)) => {
                self.fed_ns = now_ns;
                self.target = RotorTarget {
                    position: f32::from_bits(position).into(),
                    velocity: half(4).unwrap_or(0.0),
                    torque: half(6).unwrap_or(0.0),
                };
            }
            (0x18, ..) => {
                self.errors = if self.common.is_hot {
                    MOTOR_OVER_TEMP
                } else {
                    0
                };
                self.disarm_reason = 0;
            }
            _ => {}
        }
    }

    fn at(&mut self, now_ns: u64) {
        if !self.common.is_alive {
            // Messages of the time without power are not caught up with.
            for cycle in &mut self.cycles {
                let missed = now_ns
                    .saturating_sub(cycle.due_ns)
                    .div_ceil(cycle.period_ns);
                cycle.due_ns += missed * cycle.period_ns;
            }
            return;
        }
        if self.state == CLOSED_LOOP && now_ns > self.fed_ns + self.watchdog_ns {
            self.disarm(WATCHDOG_TIMER_EXPIRED);
        }
        for at in 0..self.cycles.len() {
            let cycle = &mut self.cycles[at];
            if cycle.due_ns <= now_ns {
                cycle.due_ns += cycle.period_ns;
                let command = cycle.command;
                self.tell(command);
            }
        }
    }

    fn next_ns(&self) -> Option<u64> {
        let due = self.cycles.iter().map(|cycle| cycle.due_ns).min();
        due.filter(|_| self.common.is_alive)
    }

    fn sample(&mut self, angle: f64, period_s: f64) -> f64 {
        self.common.servo.sense(angle, period_s);
        let follows = self.common.is_alive
            && self.state == CLOSED_LOOP
            && self.modes == [POSITION_CONTROL, PASSTHROUGH];
        match follows {
            true => self.common.servo.follow(&self.target),
            false => self.common.servo.release(),
        }
    }

    fn idle(&mut self) {
        self.state = IDLE;
    }

    fn start(&mut self) {
        (self.state, self.result) = (IDLE, 0);
        (self.errors, self.disarm_reason) = (0, 0);
        self.modes = [0; 2];
        self.target = RotorTarget::default();
    }

    fn heat(&mut self) {
        self.common.is_hot = true;
        self.disarm(MOTOR_OVER_TEMP);
    }

    fn common(&self) -> &Common<8> {
        &self.common
    }

    fn common_mut(&mut self) -> &mut Common<8> {
        &mut self.common
    }
}
