//! mjbots moteus: registers over CAN FD.
//!
//! From the moteus documentation:
//! [docs/protocol/can.md](https://github.com/mjbots/moteus/blob/main/docs/protocol/can.md) (subframes,
//! identifiers) and
//! [docs/protocol/registers.md](https://github.com/mjbots/moteus/blob/main/docs/protocol/registers.md).
//!
//! | bytes | |
//! |---|---|
//! | `01 00 0a` | write one int8: register 0x000, mode, 10 (position); 0 is stopped, which clears faults |
//! | `07 20` or `0f 20` | write three int16 or floats from register 0x020: position, velocity, torque |
//! | `14 04 00` or `1c 04 00` | read four int16 or floats from register 0x000: mode, position, velocity, torque |
//! | `13 0d` | read three int8 from register 0x00d: voltage, temperature, fault code |
//! | `50` | no operation, up to a length that CAN FD has |
//!
//! A frame takes 16 or 24 bytes, at 1 Mbit/s and 5 Mbit/s in the data: CAN FD. The drive answers each one.
//! moteus has no such command for the eight bytes of classic CAN ("no easy way to use moteus with CAN 2.0", its
//! author in moteus issue 44). A frame type that holds eight bytes refuses every command.
//!
//! Positions and torques of moteus are those of its output shaft: set `motor_position.rotor_to_output_ratio` to 1. The
//! watchdog of moteus (`servo.default_timeout_s`) stops a motor without commands. A drive with a fault is off, and is
//! not told to stop, for that would clear the fault. Each command has the mode: one that has restarted would take it for an
//! order to go on, at turns that it does not count any more.

use super::heard::finite;
use super::odrive::whole;
use super::{Heard, NoFrame, Protocol, RotorCommand, Say, Told};
use embedded_can::{ExtendedId, Frame, Id};
use trirrr_protocol::message::DriveState;

/// moteus; nodes 1 to 127. The source is 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moteus {
    /// Encoding of values.
    pub resolution: Resolution,
}

/// Encoding of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// 16 bytes: steps of 0.0001 turns, 0.00025 turns/s and 0.01 N m, up to 3.2767 turns, 8.19175
    /// turns/s and 327.67 N m.
    Int16,
    /// 24 bytes: binary32.
    Float,
}

/// Write one int8 register, the mode.
const WRITE_MODE: [u8; 2] = [0x01, 0x00];
const STOPPED: u8 = 0;
const POSITION: u8 = 10;
/// Write three registers of these types,
const WRITE_3_INT16: u8 = 0x07;
const WRITE_3_FLOATS: u8 = 0x0F;
/// from this one: position, velocity, feed-forward torque.
const COMMAND_POSITION: u8 = 0x20;
/// Read registers of these types; the number follows.
const READ_INT16: u8 = 0x14;
const READ_FLOATS: u8 = 0x1C;
/// Mode, position, velocity, torque.
const MOTION: [u8; 2] = [4, 0x00];
/// Read three int8 registers: voltage, temperature, fault code.
const READ_HEALTH: [u8; 2] = [0x13, 0x0D];
const NOP: u8 = 0x50;
/// Upper bits of a reply's subframe.
const REPLY: u8 = 0x20;
/// The drive is to reply: the upper bit of the source.
const ANSWER: u32 = 0x8000;

const MOTOR_NOT_CONFIGURED: f32 = 36.0;

impl Moteus {
    /// Rate of the bits in the data of a frame, Hz.
    pub const DATA_RATE_HZ: u32 = 5_000_000;
}

impl Protocol for Moteus {
    const PREPARATION: u8 = 0;
    const COMMAND_SWITCHES_ON: bool = true;

    #[inline]
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame> {
        let [write, mode] = WRITE_MODE;
        let [number, first] = MOTION;
        let [health, voltage] = READ_HEALTH;
        let read = match self.resolution {
            Resolution::Int16 => READ_INT16,
            Resolution::Float => READ_FLOATS,
        };
        match (say, self.resolution) {
            (Say::Off | Say::Clear, _) => {
                let data = [write, mode, STOPPED, read, number, first, health, voltage];
                frame(node, &data)
            }
            (Say::Ask(_), _) => frame(node, &[read, number, first, health, voltage]),
            (Say::Prepare(_, command) | Say::Move(command), Resolution::Int16) => {
                let [p0, p1] = whole(command.position * 10_000.0)?.to_le_bytes();
                let [v0, v1] = whole(command.velocity * 4_000.0)?.to_le_bytes();
                let [t0, t1] = whole(command.torque * 100.0)?.to_le_bytes();
                let (w, r) = (WRITE_3_INT16, COMMAND_POSITION);
                let data = [
                    write, mode, POSITION, w, r, p0, p1, v0, v1, t0, t1, read, number, first,
                    health, voltage,
                ];
                frame(node, &data)
            }
            (Say::Prepare(_, command) | Say::Move(command), Resolution::Float) => {
                let RotorCommand {
                    position,
                    velocity,
                    torque,
                } = command;
                let [p0, p1, p2, p3] = position.to_le_bytes();
                let [v0, v1, v2, v3] = velocity.to_le_bytes();
                let [t0, t1, t2, t3] = torque.to_le_bytes();
                let (w, r) = (WRITE_3_FLOATS, COMMAND_POSITION);
                let data = [
                    write, mode, POSITION, w, r, p0, p1, p2, p3, v0, v1, v2, v3, t0, t1, t2, t3,
                    read, number, first, health, voltage, NOP, NOP,
                ];
                frame(node, &data)
            }
        }
    }

    /// A reply to source 0.
    fn hear<F: Frame>(&self, frame: &F) -> Option<(u8, Heard)> {
        let id = match frame.id() {
            Id::Standard(id) => u32::from(id.as_raw()),
            Id::Extended(id) => id.as_raw(),
        };
        if id & 0xFF != 0 {
            return None;
        }
        let mut heard = Heard::default();
        let (mut mode, mut fault) = (None, None);
        let mut data = frame.data();
        while let [subframe, rest @ ..] = data {
            data = rest;
            if *subframe == NOP {
                continue;
            }
            if subframe & 0xF0 != REPLY {
                return None;
            }
            let (number, rest) = match subframe & 0x03 {
                0 => data.split_first()?,
                1 => (&1, data),
                2 => (&2, data),
                _ => (&3, data),
            };
            let (register, mut rest) = rest.split_first()?;
            for at in 0..*number {
                let (value, later) = value(subframe & 0x0C, rest)?;
                rest = later;
                let register = register.wrapping_add(at);
                let value = value.scaled(register);
                match register {
                    0x00 => mode = value,
                    0x01 => heard.position = value,
                    0x02 => heard.velocity = value,
                    0x03 => heard.torque = value,
                    0x0D => heard.supply = value,
                    0x0E => heard.temperature = value,
                    0x0F => fault = value,
                    _ => {}
                }
            }
            data = rest;
        }
        heard.state = mode.map(|mode| Told::State(state_of(mode, fault)));
        // Outside a fault the code tells what limits the power.
        heard.error = mode.map(|mode| match (mode == 1.0, fault) {
            (true, Some(code)) => code as u32,
            _ => 0,
        });
        Some(((id >> 8) as u8 & 0x7F, heard))
    }
}

/// State by the registers mode and fault code.
fn state_of(mode: f32, fault: Option<f32>) -> DriveState {
    match mode as u8 {
        0 => DriveState::Off,
        // A fault, and a watchdog that has run out, which also takes a stop to leave.
        1 if fault == Some(MOTOR_NOT_CONFIGURED) => DriveState::Uncalibrated,
        1 | 11 => DriveState::Fault,
        POSITION => DriveState::On,
        _ => DriveState::Preparing,
    }
}

/// Value of a register, as it is encoded.
enum Encoded {
    Byte(i8),
    Short(i16),
    Word(i32),
    Float(f32),
}

/// Value at the beginning of `data`, of the type that a subframe names, and what follows.
fn value(kind: u8, data: &[u8]) -> Option<(Encoded, &[u8])> {
    Some(match (kind, data) {
        (0x00, [a, rest @ ..]) => (Encoded::Byte(*a as i8), rest),
        (0x04, [a, b, rest @ ..]) => (Encoded::Short(i16::from_le_bytes([*a, *b])), rest),
        (0x08, [a, b, c, d, rest @ ..]) => {
            (Encoded::Word(i32::from_le_bytes([*a, *b, *c, *d])), rest)
        }
        (0x0C, [a, b, c, d, rest @ ..]) => {
            (Encoded::Float(f32::from_le_bytes([*a, *b, *c, *d])), rest)
        }
        _ => return None,
    })
}

impl Encoded {
    /// Value in the unit of `register`. The most negative whole number is none.
    fn scaled(&self, register: u8) -> Option<f32> {
        // One unit of int8, int16 and int32.
        let [byte, short, word] = match register {
            0x01 => [0.01, 1e-4, 1e-5],
            0x02 => [0.1, 0.000_25, 1e-5],
            0x03 => [0.5, 0.01, 0.001],
            0x0D => [0.5, 0.1, 0.001],
            0x0E => [1.0, 0.1, 0.001],
            _ => [1.0, 1.0, 1.0],
        };
        match *self {
            Encoded::Byte(value) => (value != i8::MIN).then(|| f32::from(value) * byte),
            Encoded::Short(value) => (value != i16::MIN).then(|| f32::from(value) * short),
            Encoded::Word(value) => (value != i32::MIN).then_some(value as f32 * word),
            Encoded::Float(value) => finite(value),
        }
    }
}

/// From source 0, to be answered; the destination is the lower byte of the identifier.
fn frame<F: Frame>(node: u8, data: &[u8]) -> Result<F, NoFrame> {
    let id = ExtendedId::new(ANSWER | u32::from(node)).ok_or(NoFrame::Range)?;
    F::new(Id::Extended(id), data).ok_or(NoFrame::TooLong)
}
