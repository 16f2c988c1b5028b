//! ODrive's CANSimple: classic CAN, eleven-bit identifiers.
//!
//! From the ODrive documentation, docs/can-protocol.rst with its table
//! [can-protocol.csv](https://github.com/odriverobotics/ODrive/blob/master/docs/_static/can-protocol.csv):
//! the identifier is `node << 5 | command`, all values are little endian.
//!
//! | command | | content |
//! |---|---|---|
//! | 0x01 | Heartbeat, from the axis | error u32, state u8, ... |
//! | 0x07 | Set Axis Requested State | state u32: 1 idle, 8 closed loop control |
//! | 0x0B | Set Controller Modes | control i32: 3 position; input i32: 1 passthrough |
//! | 0x0C | Set Input Pos | position f32, turns; velocity i16, 0.001 turns/s; torque i16, 0.001 N m |
//! | 0x18 | Clear Errors | |
//!
//! To switch on: clear errors, position control without a filter, the present position, closed loop. To switch
//! off: idle, not an estop, which is an error of the drive.

use super::{NoFrame, Protocol, RotorCommand, Say};
use embedded_can::{Frame, Id, StandardId};

/// CANSimple; nodes 0 to 63.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Odrive;

const HEARTBEAT: u8 = 0x01;
const SET_AXIS_REQUESTED_STATE: u8 = 0x07;
const SET_CONTROLLER_MODES: u8 = 0x0B;
const SET_INPUT_POS: u8 = 0x0C;
const CLEAR_ERRORS: u8 = 0x18;

const IDLE: u32 = 1;
const CLOSED_LOOP_CONTROL: u32 = 8;
const POSITION_CONTROL: u32 = 3;
const PASSTHROUGH: u32 = 1;

impl Protocol for Odrive {
    const PREPARATION: u8 = 4;

    #[inline(always)]
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame> {
        match say {
            Say::Move(command) => input(node, command),
            other => seldom(node, other),
        }
    }

    fn error<F: Frame>(&self, frame: &F) -> Option<(u8, u32)> {
        let Id::Standard(id) = frame.id() else {
            return None;
        };
        let is_heartbeat = id.as_raw() & 0x1F == u16::from(HEARTBEAT);
        let &[a, b, c, d, ..] = frame.data() else {
            return None;
        };
        let error = u32::from_le_bytes([a, b, c, d]);
        (is_heartbeat && error != 0).then_some(((id.as_raw() >> 5) as u8, error))
    }
}

/// Frames of the preparation, and of a drive that is off.
// Apart from the command of each tick, which is inlined.
#[inline(never)]
fn seldom<F: Frame>(node: u8, say: &Say) -> Result<F, NoFrame> {
    match say {
        Say::Off => state(node, IDLE),
        Say::Prepare(0, _) => frame(node, CLEAR_ERRORS, &[]),
        Say::Prepare(1, _) => {
            let modes = u64::from(POSITION_CONTROL) | u64::from(PASSTHROUGH) << 32;
            frame(node, SET_CONTROLLER_MODES, &modes.to_le_bytes())
        }
        Say::Prepare(2, command) | Say::Move(command) => input(node, command),
        Say::Prepare(_, _) => state(node, CLOSED_LOOP_CONTROL),
    }
}

#[inline(always)]
fn frame<F: Frame>(node: u8, command: u8, data: &[u8]) -> Result<F, NoFrame> {
    let id = u16::from(node & 0x3F) << 5 | u16::from(command);
    let id = StandardId::new(id).ok_or(NoFrame::Range)?;
    F::new(id, data).ok_or(NoFrame::TooLong)
}

fn state<F: Frame>(node: u8, state: u32) -> Result<F, NoFrame> {
    frame(node, SET_AXIS_REQUESTED_STATE, &state.to_le_bytes())
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
