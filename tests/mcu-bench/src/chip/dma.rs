//! DMA between serial ports and the RAM: the streams of an STM32F405 (RM0090, chapter 10), and the channels of DMA1 of an STM32G474 with the
//! multiplexer of their requests (RM0440, chapters 12 and 13).
//!
//! A transfer takes no time of its own. Modelled are single bytes, one direction at a time, once or round after round; settings beyond that
//! are registers that the model does not have.

use super::memory::Memory;
use super::serial::BytePath;
use super::{Interrupts, Kind};

/// Interrupts of the streams of both controllers, and of the channels of DMA1.
const STREAM_INTERRUPTS: [u16; 16] = [
    11, 12, 13, 14, 15, 16, 17, 47, 56, 57, 58, 59, 60, 68, 69, 70,
];
const CHANNEL_INTERRUPTS: [u16; 7] = [11, 12, 13, 14, 15, 16, 17];

/// Requests of the serial ports: port, direction, address of its data, index of the stream, channel.
const STREAM_REQUESTS: [(usize, Direction, u32, usize, u32); 4] = [
    (0, Direction::FromPort, 0x4000_4404, 5, 4),
    (0, Direction::ToPort, 0x4000_4404, 6, 4),
    (1, Direction::FromPort, 0x4000_4804, 1, 4),
    (1, Direction::ToPort, 0x4000_4804, 3, 4),
];

/// The same in an STM32G474, where each request may go to any channel: port, direction, address of its data, request.
const CHANNEL_REQUESTS: [(usize, Direction, u32, u32); 4] = [
    (0, Direction::FromPort, 0x4000_4424, 26),
    (0, Direction::ToPort, 0x4000_4428, 27),
    (1, Direction::FromPort, 0x4000_4824, 28),
    (1, Direction::ToPort, 0x4000_4828, 29),
];

/// Places of the flags of four streams in their register.
const PLACES: [u32; 4] = [0, 6, 16, 22];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Direction {
    FromPort,
    ToPort,
}

/// Settings of a stream or channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Settings {
    on: bool,
    /// Interrupts at the half, at the end, and at an error.
    interrupts: [bool; 3],
    direction: Direction,
    circular: bool,
    counts: bool,
}

impl Settings {
    /// Reads a stream's register. Returns none for settings that are not modelled.
    fn of_stream(control: u32) -> Option<Self> {
        let is = |bit: u32| control >> bit & 1 != 0;
        // Channel, priority, and the bits of the fields below.
        let known = 0b111 << 25 | 0b11 << 16 | 0b101_0101_1101;
        (control & !known == 0).then(|| Self {
            on: is(0),
            interrupts: [is(3), is(4), is(2)],
            direction: Self::direction(is(6)),
            circular: is(8),
            counts: is(10),
        })
    }

    /// Reads a channel's register. Returns none for settings that are not modelled.
    fn of_channel(control: u32) -> Option<Self> {
        let is = |bit: u32| control >> bit & 1 != 0;
        let known = 0b11 << 12 | 0b1011_1111;
        (control & !known == 0).then(|| Self {
            on: is(0),
            interrupts: [is(2), is(1), is(3)],
            direction: Self::direction(is(4)),
            circular: is(5),
            counts: is(7),
        })
    }

    fn direction(to_port: bool) -> Direction {
        match to_port {
            true => Direction::ToPort,
            false => Direction::FromPort,
        }
    }
}

/// Stream or channel.
#[derive(Clone, Copy, Debug, Default)]
struct Stream {
    control: u32,
    /// Transfers that are left, and those of a round.
    left: u32,
    round: u32,
    port: u32,
    memory: u32,
    half: bool,
    end: bool,
    error: bool,
}

pub(crate) struct Dma {
    kind: Kind,
    streams: [Stream; 16],
    /// Requests of the channels.
    requests: [u32; 7],
    pub(crate) memory: Memory,
    /// Accesses of the DMA itself to where it can not reach.
    pub(crate) faults: Vec<String>,
}

impl Dma {
    pub(crate) fn new(kind: Kind) -> Self {
        Self {
            kind,
            streams: [Stream::default(); 16],
            requests: [0; 7],
            memory: Memory::new(),
            faults: Vec::new(),
        }
    }

    /// Registers as after a reset. The content of the RAM stays.
    pub(crate) fn reset(&mut self) {
        self.streams = [Stream::default(); 16];
        self.requests = [0; 7];
    }

    fn settings(&self, control: u32) -> Option<Settings> {
        match self.kind {
            Kind::Stm32f405 => Settings::of_stream(control),
            Kind::Stm32g474 => Settings::of_channel(control),
        }
    }

    /// Sets the lines of the interrupts.
    pub(crate) fn set_lines(&self, interrupts: &mut Interrupts) {
        let lines: &[u16] = match self.kind {
            Kind::Stm32f405 => &STREAM_INTERRUPTS,
            Kind::Stm32g474 => &CHANNEL_INTERRUPTS,
        };
        for (stream, line) in self.streams.iter().zip(lines) {
            let on = self.settings(stream.control).is_some_and(|settings| {
                let [half, end, error] = settings.interrupts;
                half && stream.half || end && stream.end || error && stream.error
            });
            interrupts.set_line(*line, on);
        }
    }

    /// Returns the way of the bytes of a serial port.
    pub(crate) fn path(&mut self, serial: usize) -> Path<'_> {
        Path { dma: self, serial }
    }

    /// Returns the stream that serves a port, and the address that its transfer has in the RAM.
    fn serving(&mut self, serial: usize, direction: Direction) -> Option<(usize, u32)> {
        let is_it = |index: &usize| {
            let stream = &self.streams[*index];
            let of = match self.kind {
                Kind::Stm32f405 => STREAM_REQUESTS.iter().any(|request| {
                    *request
                        == (
                            serial,
                            direction,
                            stream.port,
                            *index,
                            stream.control >> 25 & 7,
                        )
                }),
                Kind::Stm32g474 => self.requests.get(*index).is_some_and(|number| {
                    CHANNEL_REQUESTS.contains(&(serial, direction, stream.port, *number))
                }),
            };
            let settings = self.settings(stream.control);
            of && stream.left > 0
                && settings.is_some_and(|settings| settings.on && settings.direction == direction)
        };
        let index = (0..self.streams.len()).find(is_it)?;
        let stream = &self.streams[index];
        let counts = self.settings(stream.control)?.counts;
        let done = if counts {
            stream.round - stream.left
        } else {
            0
        };
        Some((index, stream.memory + done))
    }

    /// Counts a transfer, which has reached the memory or has not.
    fn count(&mut self, index: usize, reached: bool) {
        let settings = self.settings(self.streams[index].control);
        let stream = &mut self.streams[index];
        if !reached {
            stream.error = true;
            stream.control &= !1;
            self.faults.push(format!(
                "DMA: there is no RAM for it at {:#010x} and behind",
                stream.memory
            ));
            return;
        }
        stream.left -= 1;
        stream.half |= stream.left == stream.round / 2;
        if stream.left > 0 {
            return;
        }
        stream.end = true;
        if settings.is_some_and(|settings| settings.circular) {
            stream.left = stream.round;
        } else if self.kind == Kind::Stm32f405 {
            // A channel of the other stays on, with nothing left.
            stream.control &= !1;
        }
    }

    /// Reads a register of an STM32F405, by its address from the first controller on.
    pub(crate) fn read_stream(&self, offset: u32) -> Option<u32> {
        let controller = (offset / 0x400) as usize * 8;
        Some(match offset % 0x400 {
            register @ (0x00 | 0x04) => {
                let first = controller + register as usize;
                let flags = (0..4).map(|at| {
                    let stream = &self.streams[first + at];
                    let [half, end, error] = [stream.half, stream.end, stream.error].map(u32::from);
                    (error << 3 | half << 4 | end << 5) << PLACES[at]
                });
                flags.sum()
            }
            register @ 0x10..0xD0 => {
                let stream = &self.streams[controller + (register as usize - 0x10) / 0x18];
                match (register - 0x10) % 0x18 {
                    0x00 => stream.control,
                    0x04 => stream.left,
                    0x08 => stream.port,
                    0x0C => stream.memory,
                    _ => return None,
                }
            }
            _ => return None,
        })
    }

    /// Writes a register of an STM32F405. Returns false for one that is not modelled.
    pub(crate) fn write_stream(&mut self, offset: u32, value: u32) -> bool {
        let controller = (offset / 0x400) as usize * 8;
        match offset % 0x400 {
            register @ (0x08 | 0x0C) => {
                let first = controller + (register as usize - 0x08);
                for (at, place) in PLACES.into_iter().enumerate() {
                    self.streams[first + at].clear(value >> place, [4, 5, 3]);
                }
                true
            }
            register @ 0x10..0xD0 => {
                let index = controller + (register as usize - 0x10) / 0x18;
                let is_on = self.streams[index].control & 1 != 0;
                let has_flags = self.streams[index].has_flags();
                match (register - 0x10) % 0x18 {
                    // It does not start with flags of the run before.
                    0x00 if !is_on && value & 1 != 0 && has_flags => false,
                    0x00 => self.set(index, value),
                    // Locked while it is on.
                    _ if is_on => false,
                    offset @ 0x04..=0x0C => self.streams[index].put(offset, value),
                    _ => false,
                }
            }
            _ => false,
        }
    }

    /// Reads a register of an STM32G474: of DMA1, and of the multiplexer.
    pub(crate) fn read_channel(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => {
                let flags = self.streams[..7].iter().enumerate().map(|(at, stream)| {
                    let [half, end, error] = [stream.half, stream.end, stream.error].map(u32::from);
                    (u32::from(stream.has_flags()) | end << 1 | half << 2 | error << 3) << (4 * at)
                });
                flags.sum()
            }
            0x08..0x94 => {
                let stream = &self.streams[(offset as usize - 0x08) / 0x14];
                match (offset - 0x08) % 0x14 {
                    0x00 => stream.control,
                    0x04 => stream.left,
                    0x08 => stream.port,
                    0x0C => stream.memory,
                    _ => return None,
                }
            }
            0x800..0x81C => self.requests[(offset as usize - 0x800) / 4],
            _ => return None,
        })
    }

    /// Writes a register of an STM32G474. Returns false for one that is not modelled.
    pub(crate) fn write_channel(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x04 => {
                for at in 0..7 {
                    let flags = value >> (4 * at) & 0xF;
                    // The first stands for all.
                    let flags = if flags & 1 != 0 { 0xF } else { flags };
                    self.streams[at].clear(flags, [2, 1, 3]);
                }
                true
            }
            0x08..0x94 => {
                let index = (offset as usize - 0x08) / 0x14;
                let is_on = self.streams[index].control & 1 != 0;
                match (offset - 0x08) % 0x14 {
                    0x00 => self.set(index, value),
                    _ if is_on => false,
                    offset @ 0x04..=0x0C => self.streams[index].put(offset, value),
                    _ => false,
                }
            }
            // A request alone, without synchronisation.
            0x800..0x81C if value < 0x80 => {
                self.requests[(offset as usize - 0x800) / 4] = value;
                true
            }
            _ => false,
        }
    }

    /// Writes the settings. What is on takes no others.
    fn set(&mut self, index: usize, value: u32) -> bool {
        let before = self.streams[index].control;
        let is_locked = before & 1 != 0 && value & 1 != 0 && before != value;
        self.streams[index].control = value;
        !is_locked && self.settings(value).is_some()
    }
}

impl Stream {
    fn has_flags(&self) -> bool {
        self.half || self.end || self.error
    }

    /// Clears the flags whose bits, of half, end and error, are set.
    fn clear(&mut self, flags: u32, bits: [u32; 3]) {
        let [half, end, error] = bits.map(|bit| flags >> bit & 1 != 0);
        self.half &= !half;
        self.end &= !end;
        self.error &= !error;
    }

    /// Writes number or addresses, which have the same order in both.
    fn put(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x04 => {
                self.left = value & 0xFFFF;
                self.round = self.left;
            }
            0x08 => self.port = value,
            0x0C => self.memory = value,
            _ => return false,
        }
        true
    }
}

/// Way of a serial port's bytes.
pub(crate) struct Path<'d> {
    dma: &'d mut Dma,
    serial: usize,
}

impl BytePath for Path<'_> {
    fn take(&mut self, byte: u8) -> bool {
        let Some((index, address)) = self.dma.serving(self.serial, Direction::FromPort) else {
            return false;
        };
        let reached = self.dma.memory.write(address, byte).is_some();
        self.dma.count(index, reached);
        reached
    }

    fn next(&mut self) -> Option<u8> {
        let (index, address) = self.dma.serving(self.serial, Direction::ToPort)?;
        let byte = self.dma.memory.read(address);
        self.dma.count(index, byte.is_some());
        byte
    }
}

#[cfg(test)]
mod tests {
    use super::super::memory::RAM;
    use super::*;

    /// Settings of USART2: receiver round after round with an interrupt, transmitter.
    const RECEIVES: u32 = 4 << 25 | 1 << 10 | 1 << 8 | 1 << 4 | 1;
    const TRANSMITS: u32 = 4 << 25 | 1 << 10 | 1 << 6 | 1;

    /// Registers of streams 5 and 6.
    const RECEIVER: u32 = 0x10 + 5 * 0x18;
    const TRANSMITTER: u32 = 0x10 + 6 * 0x18;

    fn start(dma: &mut Dma, registers: u32, at: u32, count: u32, settings: u32) -> bool {
        dma.write_stream(registers + 0x08, 0x4000_4404)
            && dma.write_stream(registers + 0x0C, at)
            && dma.write_stream(registers + 0x04, count)
            && dma.write_stream(registers, settings)
    }

    #[test]
    fn a_ring_is_filled_round_after_round() {
        let mut dma = Dma::new(Kind::Stm32f405);
        let ram = RAM as u32;
        assert!(start(&mut dma, RECEIVER, ram + 16, 4, RECEIVES));
        for (byte, left, flags) in [
            (1, 3, 0),
            (2, 2, 0b01),
            (3, 1, 0b01),
            (4, 4, 0b11),
            (5, 3, 0b11),
        ] {
            assert!(dma.path(0).take(byte));
            assert_eq!(dma.read_stream(RECEIVER + 0x04), Some(left));
            // Flags of stream 5 in the second register, from bit 6 on: half and end are bits 4 and 5.
            assert_eq!(
                dma.read_stream(0x04).map(|word| word >> 10 & 3),
                Some(flags)
            );
        }
        let bytes = (0..5).map(|at| dma.memory.read(ram + 16 + at));
        assert_eq!(
            bytes.collect::<Vec<_>>(),
            [Some(5), Some(2), Some(3), Some(4), Some(0)]
        );
        // The other port has no stream.
        assert!(!dma.path(1).take(9));
    }

    #[test]
    fn a_stream_that_has_sent_all_starts_without_flags_only() {
        let mut dma = Dma::new(Kind::Stm32f405);
        let ram = RAM as u32;
        for (at, byte) in (0..).zip([7, 8]) {
            dma.memory.write(ram + at, byte).expect("RAM");
        }
        assert!(start(&mut dma, TRANSMITTER, ram, 2, TRANSMITS));
        assert!(!dma.write_stream(TRANSMITTER + 0x04, 1));
        let sent: Vec<u8> = std::iter::from_fn(|| dma.path(0).next()).collect();
        assert_eq!(sent, [7, 8]);
        assert_eq!(dma.read_stream(TRANSMITTER).map(|word| word & 1), Some(0));
        assert!(!start(&mut dma, TRANSMITTER, ram, 2, TRANSMITS));
        assert!(dma.write_stream(0x0C, 0x3D << 16));
        assert!(start(&mut dma, TRANSMITTER, ram, 2, TRANSMITS));
    }

    #[test]
    fn memory_out_of_its_reach_and_other_settings_are_named() {
        let mut dma = Dma::new(Kind::Stm32f405);
        // The core-coupled RAM.
        assert!(start(&mut dma, RECEIVER, 0x1000_0000, 4, RECEIVES));
        assert!(!dma.path(0).take(1));
        assert_eq!(dma.faults.len(), 1);
        // Words for bytes.
        assert!(!dma.write_stream(TRANSMITTER, TRANSMITS | 1 << 13));
    }

    #[test]
    fn a_channel_serves_the_request_of_its_multiplexer() {
        let mut dma = Dma::new(Kind::Stm32g474);
        let ram = RAM as u32;
        // Channel 2 from USART2, once.
        for (offset, value) in [(0x804, 26), (0x24, 0x4000_4424), (0x28, ram), (0x20, 2)] {
            assert!(dma.write_channel(offset, value), "{offset:#x}");
        }
        assert!(dma.write_channel(0x1C, 1 << 7 | 1 << 1 | 1));
        assert!(dma.path(0).take(1) && dma.path(0).take(2) && !dma.path(0).take(3));
        assert_eq!(dma.read_channel(0x00), Some(0b0111 << 4));
        assert!(dma.write_channel(0x04, 1 << 5 | 1 << 6));
        assert_eq!(dma.read_channel(0x00), Some(0));
    }
}
