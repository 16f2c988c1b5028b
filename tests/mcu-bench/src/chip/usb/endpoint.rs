//! One direction of an endpoint of the OTG controller: its registers, and its FIFO to the host (RM0090, 34.16.4).

use super::Answer;
use std::collections::VecDeque;

/// Control of an endpoint: active, refuses, stalls, clear and set of the refusal, even and odd toggle, off, on.
pub(super) const ACTIVE: u32 = 1 << 15;
pub(super) const REFUSES: u32 = 1 << 17;
pub(super) const STALLS: u32 = 1 << 21;
pub(super) const CLEAR_REFUSAL: u32 = 1 << 26;
pub(super) const SET_REFUSAL: u32 = 1 << 27;
pub(super) const EVEN: u32 = 1 << 28;
pub(super) const ODD: u32 = 1 << 29;
pub(super) const OFF: u32 = 1 << 30;
pub(super) const ON: u32 = 1 << 31;

/// What a program writes as it is: size, type, FIFO, and whether it is active.
pub(super) const SETTINGS: u32 = 0x7FF | ACTIVE | 3 << 18 | 0xF << 22;

/// Flags of an endpoint: transfer complete, off, and by direction the end of a control transfer's first packet, and a token without data.
pub(super) const COMPLETE: u32 = 1 << 0;
pub(super) const IS_OFF: u32 = 1 << 1;
pub(super) const SET_UP_DONE: u32 = 1 << 3;
pub(super) const NO_DATA: u32 = 1 << 4;
pub(super) const EMPTY: u32 = 1 << 7;

/// One direction of an endpoint.
#[derive(Clone, Debug, Default)]
pub(super) struct HalfEndpoint {
    pub(super) control: u32,
    pub(super) flags: u32,
    /// Packets and bytes to go.
    pub(super) size: u32,
    pub(super) is_odd: bool,
    /// Words to the host.
    pub(super) fifo: VecDeque<u32>,
}

impl HalfEndpoint {
    pub(super) fn most_bytes(&self, number: usize) -> u32 {
        match number {
            0 => 64 >> (self.control & 3),
            _ => self.control & 0x7FF,
        }
    }

    pub(super) fn packets(&self) -> u32 {
        self.size >> 19 & 0x3FF
    }

    pub(super) fn bytes(&self) -> u32 {
        self.size & 0x7_FFFF
    }

    /// Returns what a token gets that no data can answer.
    pub(super) fn refusal(&self) -> Option<Answer> {
        if self.control & ACTIVE == 0 {
            return Some(Answer::Silence);
        }
        if self.control & STALLS != 0 {
            return Some(Answer::Stall);
        }
        (self.control & ON == 0 || self.control & REFUSES != 0).then_some(Answer::NotNow)
    }

    /// Counts a packet. Returns true if it was the last one.
    pub(super) fn count(&mut self, bytes: u32) -> bool {
        // A count of none: the manual does not say what the core does. Here each packet is a transfer then.
        let packets = self.packets().saturating_sub(1);
        self.size = packets << 19 | self.bytes().saturating_sub(bytes);
        self.is_odd = !self.is_odd;
        packets == 0
    }

    pub(super) fn read(&self) -> u32 {
        self.control | u32::from(self.is_odd) << 16
    }

    pub(super) fn write(&mut self, number: usize, value: u32) {
        let kept = self.control & (ON | REFUSES);
        // A control endpoint stalls until the next transfer begins.
        let stalls = match number {
            0 => (self.control | value) & STALLS | ACTIVE,
            _ => value & STALLS,
        };
        self.control = value & SETTINGS | kept | stalls;
        if value & CLEAR_REFUSAL != 0 {
            self.control &= !REFUSES;
        }
        if value & SET_REFUSAL != 0 {
            self.control |= REFUSES;
        }
        if value & (EVEN | ODD) != 0 {
            self.is_odd = value & ODD != 0;
        }
        if value & ON != 0 {
            self.control |= ON;
        }
        if value & OFF != 0 && self.control & ON != 0 {
            self.control &= !ON;
            self.flags |= IS_OFF;
        }
    }
}
