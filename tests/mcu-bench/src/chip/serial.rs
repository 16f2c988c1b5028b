//! A serial port (RM0090, chapter 30), and the wires to it.

use crate::time::Time;
use std::collections::VecDeque;

/// Bits of a byte on the wire.
const BITS: Time = 10;

/// Bits of the third control register: the DMA serves receiver and transmitter.
const RECEIVES_BY_DMA: u32 = 1 << 6;
const TRANSMITS_BY_DMA: u32 = 1 << 7;

/// Way of a port's bytes without the processor.
pub(crate) trait BytePath {
    /// Takes a byte from the receiver. Returns false if nothing is set up to take it.
    fn take(&mut self, byte: u8) -> bool;
    /// Returns the next byte for the transmitter, if there is one.
    fn next(&mut self) -> Option<u8>;
}

#[derive(Clone, Debug, Default)]
pub(crate) struct Serial {
    control: [u32; 3],
    divider: u32,
    received: Option<u8>,
    overrun: bool,
    /// Byte that waits behind the one that is being shifted out.
    waiting: Option<u8>,
    /// End of the byte that is being shifted out.
    busy_until: Time,
    /// Bytes that the wire brings, with the end of their stop bits.
    pub(crate) coming: VecDeque<(Time, u8)>,
    /// Bytes that went out, with the end of their stop bits.
    pub(crate) sent: Vec<(Time, u8)>,
    /// Bytes that came while another one was not read yet.
    pub(crate) lost: u32,
}

impl Serial {
    /// Registers as after a reset. What is on the wire stays there.
    pub(crate) fn reset(&mut self) {
        *self = Self {
            coming: std::mem::take(&mut self.coming),
            sent: std::mem::take(&mut self.sent),
            lost: self.lost,
            ..Self::default()
        };
    }

    /// Returns the baud rate on a bus with the period `bus`, of a port that was set up.
    pub(crate) fn baud(&self, bus: Time) -> Option<f64> {
        let bit = Time::from(self.divider) * bus;
        (bit > 0).then(|| crate::time::SECOND as f64 / bit as f64)
    }

    fn byte_time(&self, bus: Time) -> Time {
        BITS * Time::from(self.divider) * bus
    }

    fn is_on(&self, bit: u32) -> bool {
        self.control[0] & 1 << 13 != 0 && self.control[0] & 1 << bit != 0
    }

    fn is_served(&self, bit: u32) -> bool {
        self.control[2] & bit != 0
    }

    pub(crate) fn next_event(&self) -> Option<Time> {
        let coming = self.coming.front().map(|(time, _)| *time);
        // The DMA brings the next byte then.
        let is_asking = self.waiting.is_some() && self.is_served(TRANSMITS_BY_DMA);
        let free = is_asking.then_some(self.busy_until);
        coming.into_iter().chain(free).min()
    }

    /// Lets the wire, and what the DMA moves by `path`, go on to the present time.
    pub(crate) fn serve(&mut self, now: Time, bus: Time, path: &mut impl BytePath) {
        self.receive(now, path);
        // Before the present nothing was there to be sent, or the DMA has stopped within a byte.
        let mut time = now;
        loop {
            while self.waiting.is_none()
                && self.is_on(3)
                && self.is_served(TRANSMITS_BY_DMA)
                && let Some(byte) = path.next()
            {
                self.put(byte, time, bus);
            }
            if self.waiting.is_none() || self.busy_until > now {
                return;
            }
            time = self.busy_until;
            self.shift_waiting(bus);
        }
    }

    /// Moves the byte in the receiver to where the DMA wants it.
    fn hand_over(&mut self, path: &mut impl BytePath) {
        if let Some(byte) = self.received
            && self.is_served(RECEIVES_BY_DMA)
            && path.take(byte)
        {
            self.received = None;
        }
    }

    fn receive(&mut self, now: Time, path: &mut impl BytePath) {
        self.hand_over(path);
        while let Some(&(_, byte)) = self.coming.front().filter(|(time, _)| *time <= now) {
            self.coming.pop_front();
            // A receiver that is off hears nothing.
            if !self.is_on(2) {
                continue;
            }
            match self.received {
                Some(_) => {
                    self.overrun = true;
                    self.lost += 1;
                }
                None => self.received = Some(byte),
            }
            self.hand_over(path);
        }
    }

    /// Lets the wire go on to the present time, without a DMA.
    fn advance(&mut self, now: Time, bus: Time) {
        self.receive(now, &mut NoPath);
        if self.waiting.is_some() && self.busy_until <= now {
            self.shift_waiting(bus);
        }
    }

    fn shift_waiting(&mut self, bus: Time) {
        let byte = self.waiting.take();
        let start = self.busy_until;
        self.shift(byte, start, bus);
    }

    /// Gives a byte to the transmitter.
    fn put(&mut self, byte: u8, now: Time, bus: Time) {
        match self.busy_until <= now {
            true => self.shift(Some(byte), now, bus),
            false => self.waiting = Some(byte),
        }
    }

    fn shift(&mut self, byte: Option<u8>, start: Time, bus: Time) {
        if let Some(byte) = byte {
            self.busy_until = start + self.byte_time(bus);
            self.sent.push((self.busy_until, byte));
        }
    }

    pub(crate) fn interrupts(&self) -> bool {
        self.is_on(2) && self.control[0] & 1 << 5 != 0 && (self.received.is_some() || self.overrun)
    }

    pub(crate) fn read(&mut self, offset: u32, now: Time, bus: Time) -> Option<u32> {
        self.advance(now, bus);
        Some(match offset {
            0x00 => {
                let flag = |is: bool, bit: u32| u32::from(is) << bit;
                flag(self.overrun, 3)
                    | flag(self.received.is_some(), 5)
                    | flag(self.waiting.is_none() && self.busy_until <= now, 6)
                    | flag(self.waiting.is_none(), 7)
            }
            0x04 => {
                self.overrun = false;
                self.received.take().unwrap_or(0).into()
            }
            0x08 => self.divider,
            0x0C..=0x14 => self.control[(offset as usize - 0x0C) / 4],
            0x18 => 0,
            _ => return None,
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time, bus: Time) -> bool {
        self.advance(now, bus);
        match offset {
            0x00 | 0x18 => {}
            0x04 if self.is_on(3) => self.put(value as u8, now, bus),
            0x04 => {}
            0x08 => self.divider = value & 0xFFFF,
            0x0C..=0x14 => self.control[(offset as usize - 0x0C) / 4] = value,
            _ => return false,
        }
        true
    }
}

/// No DMA at the port.
struct NoPath;

impl BytePath for NoPath {
    fn take(&mut self, _: u8) -> bool {
        false
    }

    fn next(&mut self) -> Option<u8> {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A DMA that has bytes to be sent, and room.
    #[derive(Default)]
    struct Memory {
        leaving: VecDeque<u8>,
        come: Vec<u8>,
    }

    impl BytePath for Memory {
        fn take(&mut self, byte: u8) -> bool {
            self.come.push(byte);
            true
        }

        fn next(&mut self) -> Option<u8> {
            self.leaving.pop_front()
        }
    }

    #[test]
    fn a_dma_feeds_a_wire_without_gaps_and_loses_no_byte() {
        let mut serial = on();
        serial.write(0x14, RECEIVES_BY_DMA | TRANSMITS_BY_DMA, 0, 24);
        let mut memory = Memory {
            leaving: [1, 2, 3].into(),
            ..Memory::default()
        };
        serial.coming.extend([(100, 7), (200, 8)]);
        // The first byte leaves now, the others one behind the other, however late the bench looks.
        serial.serve(1000, 24, &mut memory);
        assert_eq!(serial.next_event(), Some(12_040));
        serial.serve(50_000, 24, &mut memory);
        assert_eq!(serial.sent, [(12_040, 1), (23_080, 2), (34_120, 3)]);
        assert_eq!((memory.come, serial.lost), (vec![7, 8], 0));
        assert!(!serial.interrupts());
    }

    fn on() -> Serial {
        let mut serial = Serial::default();
        serial.write(0x08, 46, 0, 24);
        serial.write(0x0C, 1 << 13 | 1 << 5 | 3 << 2, 0, 24);
        serial
    }

    #[test]
    fn bytes_leave_one_behind_the_other() {
        let mut serial = on();
        serial.write(0x04, 1, 0, 24);
        serial.write(0x04, 2, 0, 24);
        assert_eq!(
            serial.read(0x00, 0, 24).map(|flags| flags >> 6 & 3),
            Some(0)
        );
        // 10 bits of 46 periods of the bus.
        assert_eq!(
            serial.read(0x00, 11_040, 24).map(|flags| flags >> 6 & 3),
            Some(2)
        );
        assert_eq!(serial.sent, [(11_040, 1), (22_080, 2)]);
    }

    #[test]
    fn a_byte_that_is_not_read_in_time_costs_the_next() {
        let mut serial = on();
        serial.coming.extend([(100, 7), (200, 8)]);
        serial.advance(100, 24);
        assert!(serial.interrupts());
        serial.advance(200, 24);
        assert_eq!(serial.lost, 1);
        assert_eq!(serial.read(0x04, 200, 24), Some(7));
        assert!(!serial.interrupts());
    }
}
