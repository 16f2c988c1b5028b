//! ODrive's CANSimple: classic CAN, eleven-bit identifiers.
//!
//! Fields from ODrive's own list of messages for firmware 0.6 (Pro, S1, Micro),
//! [can_simple_messages.hpp](https://github.com/odriverobotics/ODriveArduino/blob/master/src/can_simple_messages.hpp),
//! and for firmware 0.5 (v3.x)
//! [can_simple.cpp](https://github.com/odriverobotics/ODrive/blob/master/Firmware/communication/can/can_simple.cpp);
//! codes from [ODriveEnums.h](https://github.com/odriverobotics/ODriveArduino/blob/master/src/ODriveEnums.h). The
//! identifier is `node << 5 | command`, all values are little endian.
//!
//! | command | | content |
//! |---|---|---|
//! | 0x01 | Heartbeat, from the drive | error u32, state u8, procedure result u8 |
//! | 0x03 | Get Error, from the drive | active errors u32, disarm reason u32; in firmware 0.5 the motor's error u64 |
//! | 0x07 | Set Axis State | state u32: 1 idle, 8 closed loop control |
//! | 0x09 | Get Encoder Estimates, from the drive | position f32, turns; velocity f32, turns/s |
//! | 0x0B | Set Controller Mode | control u32: 3 position; input u32: 1 passthrough |
//! | 0x0C | Set Input Pos | position f32, turns; velocity i16, 0.001 turns/s; torque i16, 0.001 N m |
//! | 0x14 | Get Iq, from the drive | setpoint f32, measured f32, A |
//! | 0x15 | Get Temperature, from the drive, firmware 0.6 | power stage f32, motor f32, degrees Celsius |
//! | 0x17 | Get Bus Voltage Current, from the drive | voltage f32, V; current f32, A |
//! | 0x18 | Clear Errors | |
//! | 0x1C | Get Torques, from the drive, firmware 0.6 | target f32, estimate f32, N m |
//!
//! A drive sends its messages in cycles that its configuration sets. While drives are off, the board asks for 0x09,
//! 0x03 and 0x17 by remote frames, one in a tick, and for nothing that a firmware 0.5 would take for another message.
//!
//! To switch on: position control without a filter, the present position, closed loop. To switch off: idle, not an
//! estop, which is an error of the drive.

use super::heard::finite;
use super::{Heard, NoFrame, Protocol, RotorCommand, Say, Told};
use embedded_can::{Frame, Id, StandardId};
use trirrr_protocol::message::DriveState;

/// CANSimple; nodes 0 to 63.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odrive;

const HEARTBEAT: u8 = 0x01;
const GET_ERROR: u8 = 0x03;
const SET_AXIS_STATE: u8 = 0x07;
const GET_ENCODER_ESTIMATES: u8 = 0x09;
const SET_CONTROLLER_MODE: u8 = 0x0B;
const SET_INPUT_POS: u8 = 0x0C;
const GET_IQ: u8 = 0x14;
const GET_TEMPERATURE: u8 = 0x15;
const GET_BUS_VOLTAGE_CURRENT: u8 = 0x17;
const CLEAR_ERRORS: u8 = 0x18;
const GET_TORQUES: u8 = 0x1C;

const IDLE: u8 = 1;
const CLOSED_LOOP_CONTROL: u8 = 8;
const POSITION_CONTROL: u32 = 3;
const PASSTHROUGH: u32 = 1;
const NOT_CALIBRATED: u8 = 14;
const CALIBRATION_ERROR: u32 = 0x4000_0000;

impl Protocol for Odrive {
    const PREPARATION: u8 = 3;

    #[inline(always)]
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame> {
        match say {
            Say::Move(command) => input(node, command),
            other => seldom(node, other),
        }
    }

    fn hear<F: Frame>(&self, frame: &F) -> Option<(u8, Heard)> {
        let Id::Standard(id) = frame.id() else {
            return None;
        };
        let &[a, b, c, d, e, f, g, h] = frame.data() else {
            return None;
        };
        let first = u32::from_le_bytes([a, b, c, d]);
        let second = u32::from_le_bytes([e, f, g, h]);
        let [one, two] = [first, second].map(f32::from_bits);
        let heard = match id.as_raw() as u8 & 0x1F {
            HEARTBEAT => Heard {
                state: Some(Told::State(state_of(first, e, f))),
                error: Some(first),
                ..Heard::default()
            },
            GET_ERROR => Heard {
                error: Some(if first != 0 { first } else { second }),
                ..Heard::default()
            },
            GET_ENCODER_ESTIMATES => Heard {
                position: finite(one),
                velocity: finite(two),
                ..Heard::default()
            },
            GET_IQ => Heard {
                current: finite(two),
                ..Heard::default()
            },
            GET_TEMPERATURE => Heard {
                // A motor without a sensor tells no number, which is no maximum.
                temperature: finite(one.max(two)),
                ..Heard::default()
            },
            GET_BUS_VOLTAGE_CURRENT => Heard {
                supply: finite(one),
                ..Heard::default()
            },
            GET_TORQUES => Heard {
                torque: finite(two),
                ..Heard::default()
            },
            _ => return None,
        };
        Some(((id.as_raw() >> 5) as u8, heard))
    }
}

/// State by a heartbeat.
fn state_of(error: u32, axis_state: u8, procedure_result: u8) -> DriveState {
    match (error, axis_state) {
        (0, CLOSED_LOOP_CONTROL) => DriveState::On,
        (0, IDLE) if procedure_result == NOT_CALIBRATED => DriveState::Uncalibrated,
        (0, IDLE) => DriveState::Off,
        (0, _) => DriveState::Preparing,
        (error, _) if error & CALIBRATION_ERROR != 0 => DriveState::Uncalibrated,
        _ => DriveState::Fault,
    }
}

/// Frames of a drive that is off, or goes on.
// Apart from the command of each tick, which is inlined.
#[inline(never)]
fn seldom<F: Frame>(node: u8, say: &Say) -> Result<F, NoFrame> {
    match say {
        Say::Off => state(node, IDLE),
        Say::Clear => frame(node, CLEAR_ERRORS, &[]),
        Say::Ask(turn) => {
            let asked = match turn % 3 {
                0 => GET_ENCODER_ESTIMATES,
                1 => GET_ERROR,
                _ => GET_BUS_VOLTAGE_CURRENT,
            };
            F::new_remote(id(node, asked)?, 8).ok_or(NoFrame::TooLong)
        }
        Say::Prepare(0, _) => {
            let modes = u64::from(POSITION_CONTROL) | u64::from(PASSTHROUGH) << 32;
            frame(node, SET_CONTROLLER_MODE, &modes.to_le_bytes())
        }
        Say::Prepare(1, command) | Say::Move(command) => input(node, command),
        Say::Prepare(_, _) => state(node, CLOSED_LOOP_CONTROL),
    }
}

#[inline(always)]
fn id(node: u8, command: u8) -> Result<StandardId, NoFrame> {
    let id = u16::from(node & 0x3F) << 5 | u16::from(command);
    StandardId::new(id).ok_or(NoFrame::Range)
}

#[inline(always)]
fn frame<F: Frame>(node: u8, command: u8, data: &[u8]) -> Result<F, NoFrame> {
    F::new(id(node, command)?, data).ok_or(NoFrame::TooLong)
}

fn state<F: Frame>(node: u8, state: u8) -> Result<F, NoFrame> {
    frame(node, SET_AXIS_STATE, &u32::from(state).to_le_bytes())
}

#[inline(always)]
fn input<F: Frame>(node: u8, command: &RotorCommand) -> Result<F, NoFrame> {
    let [p0, p1, p2, p3] = command.position.to_le_bytes();
    let [v0, v1] = thousandths(command.velocity)?.to_le_bytes();
    let [t0, t1] = thousandths(command.torque)?.to_le_bytes();
    frame(node, SET_INPUT_POS, &[p0, p1, p2, p3, v0, v1, t0, t1])
}

/// Nearest whole number of thousandths.
#[inline(always)]
fn thousandths(value: f32) -> Result<i16, NoFrame> {
    whole(value * 1000.0)
}

/// Nearest whole number.
#[inline(always)]
pub(super) fn whole(value: f32) -> Result<i16, NoFrame> {
    if value > -32767.5 && value < 32767.5 {
        let half = if value < 0.0 { -0.5 } else { 0.5 };
        // By way of i32: a cast to i16 checks the range a second time.
        Ok((value + half) as i32 as i16)
    } else {
        Err(NoFrame::Range)
    }
}
