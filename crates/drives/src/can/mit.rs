//! MIT-mode frames: classic CAN, eleven-bit identifiers, eight bytes, first byte highest.
//!
//! The frame of the MIT mini cheetah's motors, which many makers have taken over. To the drive, at its address:
//! position in 16 bits, velocity, kp, kd and torque in 12 bits each. From the drive, at the address of its host: the
//! drive's address, position in 16 bits, velocity and torque in 12, and two bytes that differ ([`Answer`]). Zero is the
//! middle of a range. The drive computes torque = kp (position - its own) + kd (velocity - its own) + torque.
//!
//! | bytes to the drive | |
//! |---|---|
//! | `ff ff ff ff ff ff ff fc` | on |
//! | `ff ff ff ff ff ff ff fd` | off |
//! | `ff ff ff ff ff ff ff fe` | present position is 0; not sent, for the scene has `zero_rad` |
//! | `ff ff ff ff ff ff ff fb` | clear errors (Damiao, RobStride) |
//!
//! A drive answers each frame, and says nothing by itself. A drive that is off is told so again in each tick: that asks
//! for an answer.
//!
//! Sources: Damiao, [openarm_can](https://github.com/enactic/openarm_can) (`dm_motor_control.cpp`,
//! `dm_motor_constants.hpp`); T-Motor (CubeMars) AK,
//! [TMotorCANControl](https://github.com/neurobionics/TMotorCANControl) (`mit_can.py`); RobStride, its user manual of
//! the RS00, chapter on the MIT protocol, [Product_Information](https://github.com/RobStride/Product_Information).

use super::{Heard, NoFrame, Protocol, RotorCommand, Say, Told};
use core::f32::consts::TAU;
use embedded_can::{Frame, Id, StandardId};
use trirrr_protocol::message::DriveState;

/// MIT mode; addresses 1 to 127, with Damiao 1 to 15.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mit {
    /// Ranges of the fields.
    pub ranges: MitRanges,
    /// Gain of the position in the drive, N m/rad.
    pub kp: f32,
    /// Gain of the velocity in the drive, N m s/rad.
    pub kd: f32,
    /// Layout of an answer.
    pub answer: Answer,
    /// Identifier of the answers: the address of the host that the drives are set to.
    pub host_id: u16,
}

/// Largest values of the fields of a frame. Position, velocity and torque have both signs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MitRanges {
    /// rad.
    pub position: f32,
    /// rad/s.
    pub velocity: f32,
    /// N m.
    pub torque: f32,
    /// N m/rad.
    pub kp: f32,
    /// N m s/rad.
    pub kd: f32,
}

/// Layout of an answer's bytes 0, 6 and 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// Damiao: state and address in four bits each, two temperatures.
    Damiao,
    /// RobStride: address, temperature in tenths.
    RobStride,
    /// T-Motor AK: address, temperature, error.
    TMotor,
}

const CLEAR: u8 = 0xFB;
const ENTER: u8 = 0xFC;
const EXIT: u8 = 0xFD;

impl Protocol for Mit {
    const PREPARATION: u8 = 1;

    #[inline]
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame> {
        let data = match say {
            Say::Off | Say::Ask(_) => special(EXIT),
            Say::Clear => special(match self.answer {
                Answer::Damiao | Answer::RobStride => CLEAR,
                // Off and on is all that it knows.
                Answer::TMotor => EXIT,
            }),
            Say::Prepare(_, _) => special(ENTER),
            Say::Move(command) => self.packed(command)?,
        };
        let id = StandardId::new(node.into()).ok_or(NoFrame::Range)?;
        F::new(id, &data).ok_or(NoFrame::TooLong)
    }

    fn hear<F: Frame>(&self, frame: &F) -> Option<(u8, Heard)> {
        let Id::Standard(id) = frame.id() else {
            return None;
        };
        let &[from, p1, p0, v1, vt, t0, a, b] = frame.data() else {
            return None;
        };
        if id.as_raw() != self.host_id {
            return None;
        }
        let MitRanges {
            position,
            velocity,
            torque,
            ..
        } = self.ranges;
        let (node, state, error, temperature) = match self.answer {
            Answer::Damiao => {
                let (code, hottest) = (from >> 4, a.max(b));
                let (state, error) = match code {
                    0 => (DriveState::Off, 0),
                    1 => (DriveState::On, 0),
                    code => (DriveState::Fault, code),
                };
                (from & 0x0F, Told::State(state), error, f32::from(hottest))
            }
            Answer::RobStride => {
                let tenths = f32::from(i16::from_be_bytes([a, b]));
                (from, Told::Obeys, 0, tenths * 0.1)
            }
            Answer::TMotor => {
                let state = match b {
                    0 => Told::Obeys,
                    _ => Told::State(DriveState::Fault),
                };
                (from, state, b, f32::from(a as i8))
            }
        };
        let heard = Heard {
            state: Some(state),
            error: Some(error.into()),
            position: Some(unpacked(u16::from_be_bytes([p1, p0]), 16, position) / TAU),
            velocity: Some(unpacked(u16::from(v1) << 4 | u16::from(vt >> 4), 12, velocity) / TAU),
            torque: Some(unpacked(
                u16::from(vt & 0x0F) << 8 | u16::from(t0),
                12,
                torque,
            )),
            temperature: Some(temperature),
            ..Heard::default()
        };
        Some((node, heard))
    }
}

impl Mit {
    #[inline]
    fn packed(&self, command: &RotorCommand) -> Result<[u8; 8], NoFrame> {
        let ranges = &self.ranges;
        let position = packed(
            command.position * TAU,
            -ranges.position,
            ranges.position,
            16,
        )?;
        let velocity = packed(
            command.velocity * TAU,
            -ranges.velocity,
            ranges.velocity,
            12,
        )?;
        let torque = packed(command.torque, -ranges.torque, ranges.torque, 12)?;
        let kp = packed(self.kp, 0.0, ranges.kp, 12)?;
        let kd = packed(self.kd, 0.0, ranges.kd, 12)?;
        let [p1, p0] = position.to_be_bytes();
        Ok([
            p1,
            p0,
            (velocity >> 4) as u8,
            (velocity << 4 | kp >> 8) as u8,
            kp as u8,
            (kd >> 4) as u8,
            (kd << 4 | torque >> 8) as u8,
            torque as u8,
        ])
    }
}

fn special(last: u8) -> [u8; 8] {
    [0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, last]
}

/// Whole number of `bits` bits for `value` from `least` to `most`: to the nearest, down in the middle, so that 0 is
/// what the makers have.
#[inline]
fn packed(value: f32, least: f32, most: f32, bits: u8) -> Result<u16, NoFrame> {
    if !(value >= least && value <= most) {
        return Err(NoFrame::Range);
    }
    let parts = (value - least) * largest(bits) / (most - least);
    let below = parts as u16;
    Ok(match parts - f32::from(below) > 0.5 {
        true => below.saturating_add(1),
        false => below,
    })
}

/// Value of a whole number of `bits` bits, whose range is `most` of either sign.
#[inline]
fn unpacked(parts: u16, bits: u8, most: f32) -> f32 {
    f32::from(parts) * (2.0 * most) / largest(bits) - most
}

fn largest(bits: u8) -> f32 {
    match bits {
        12 => 4095.0,
        _ => 65_535.0,
    }
}
