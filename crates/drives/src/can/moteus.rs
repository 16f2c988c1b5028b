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
//! | `50` | no operation, up to a length that CAN FD has |
//!
//! A frame takes 11 or 17 bytes, padded to 12 or 20, at 1 Mbit/s and 5 Mbit/s in the data: CAN FD.
//! moteus has no such command for the eight bytes of classic CAN ("no easy way to use moteus with CAN 2.0", its
//! author in moteus issue 44). A frame type that holds eight bytes refuses every command.
//!
//! Positions and torques of moteus are those of its output shaft: set `motor_position.rotor_to_output_ratio`
//! to 1. The watchdog of moteus (`servo.default_timeout_s`) stops a motor without commands.

use super::odrive::whole;
use super::{NoFrame, Protocol, Say};
use embedded_can::{Frame, Id, StandardId};

/// moteus; nodes 1 to 127. The source is 0, and no reply is asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moteus {
    /// Encoding of values.
    pub resolution: Resolution,
}

/// Encoding of values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Resolution {
    /// 12 bytes: steps of 0.0001 turns, 0.00025 turns/s and 0.01 N m, up to 3.2767 turns, 8.19175
    /// turns/s and 327.67 N m.
    Int16,
    /// 20 bytes: binary32.
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
const NOP: u8 = 0x50;

impl Protocol for Moteus {
    const PREPARATION: u8 = 0;

    #[inline]
    fn frame<F: Frame>(&self, node: u8, say: &Say) -> Result<F, NoFrame> {
        let [write, mode] = WRITE_MODE;
        match (say, self.resolution) {
            (Say::Off, _) => frame(node, &[write, mode, STOPPED]),
            (Say::Prepare(_, command) | Say::Move(command), Resolution::Int16) => {
                let [p0, p1] = whole(command.position * 10_000.0)?.to_le_bytes();
                let [v0, v1] = whole(command.velocity * 4_000.0)?.to_le_bytes();
                let [t0, t1] = whole(command.torque * 100.0)?.to_le_bytes();
                let (w, r) = (WRITE_3_INT16, COMMAND_POSITION);
                let data = [write, mode, POSITION, w, r, p0, p1, v0, v1, t0, t1, NOP];
                frame(node, &data)
            }
            (Say::Prepare(_, command) | Say::Move(command), Resolution::Float) => {
                let [p0, p1, p2, p3] = command.position.to_le_bytes();
                let [v0, v1, v2, v3] = command.velocity.to_le_bytes();
                let [t0, t1, t2, t3] = command.torque.to_le_bytes();
                let (w, r) = (WRITE_3_FLOATS, COMMAND_POSITION);
                let data = [
                    write, mode, POSITION, w, r, p0, p1, p2, p3, v0, v1, v2, v3, t0, t1, t2, t3,
                    NOP, NOP, NOP,
                ];
                frame(node, &data)
            }
        }
    }

    /// None: no reply is asked for, and replies to other masters do not count.
    fn error<F: Frame>(&self, _: &F) -> Option<(u8, u32)> {
        None
    }
}

/// From source 0; the destination is the lower byte of the identifier.
fn frame<F: Frame>(node: u8, data: &[u8]) -> Result<F, NoFrame> {
    let id = StandardId::new(u16::from(node)).ok_or(NoFrame::Range)?;
    F::new(Id::Standard(id), data).ok_or(NoFrame::TooLong)
}
