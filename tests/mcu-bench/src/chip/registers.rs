//! Accesses to registers, by the peripheral at their address.

use super::flash::FlashEffect;
use super::interrupts::Effect;
use super::map::{Place, TIMERS, place, single_bit};
use super::timer::Timer;
use super::{Chip, PORTS, g474, usb};

const RESET_OF_PORTS: u32 = 0x4002_3810;
const RESETS_OF_APB1: u32 = 0x4002_3820;
const CAN1: u32 = 1 << 25;

impl Chip {
    /// Reads a register, as much of its word as `size` bytes hold.
    pub(crate) fn read(&mut self, address: u32, size: usize) -> u32 {
        if let Some((word, bit)) = single_bit(address) {
            return self.read_word(word) >> bit & 1;
        }
        let word = self.read_word(address & !3);
        let shifted = word >> (8 * (address & 3));
        match size {
            1 => shifted & 0xFF,
            2 => shifted & 0xFFFF,
            _ => word,
        }
    }

    fn read_word(&mut self, address: u32) -> u32 {
        let (now, apb1, core) = (self.now, self.clocks.apb1, self.clocks.core);
        let found = match place(self.kind, address) {
            Place::Clock(offset) => self.clock.read(offset, now),
            Place::Core(offset) => {
                self.interrupts.advance(now, core);
                self.interrupts.read(offset, now, core)
            }
            Place::Port(index, offset) => self.ports[index].read(offset),
            Place::Timer(index, offset) => {
                self.advance_rotors();
                self.advance_timer(index);
                self.timers[index].read(offset, now)
            }
            Place::Serial(index, offset) => {
                self.advance_serials();
                let read = self.serials[index].read(offset, now, apb1);
                self.set_lines();
                read
            }
            Place::Watchdog(offset) => self.watchdog.read(offset),
            Place::Capture(offset) => {
                let clock = self.clocks.timers(self.clocks.apb2);
                let input = self.clock.divided_crystal(now);
                self.capture.read(offset, now, clock, input)
            }
            Place::Can(offset) => {
                self.advance_can();
                let read = self.can.read(offset);
                self.set_lines();
                read
            }
            Place::MessageRam(offset) => self.can.read_ram(offset),
            Place::OtherClock(offset) => g474::read_clock(&self.clock, &self.held, offset, now),
            Place::OtherSerial(index, offset) => {
                self.advance_serials();
                let read = g474::read_serial(&mut self.serials[index], offset, now, apb1);
                self.set_lines();
                read
            }
            Place::Stream(offset) => {
                self.advance_serials();
                self.dma.read_stream(offset)
            }
            Place::Channel(offset) => {
                self.advance_serials();
                self.dma.read_channel(offset)
            }
            Place::Supply(offset) => self.supply.read(offset),
            Place::Lines(offset) => self.supply.read_line(offset),
            Place::Flash(offset) => self.flash.read(offset, now),
            Place::Usb(offset) if self.has_usb() => {
                self.advance_usb();
                let read = self.usb.read(offset);
                self.set_lines();
                read
            }
            Place::Packets(offset) if self.has_usb() => self.usb.read_packets(offset),
            // The controller has no clock.
            Place::Usb(_) | Place::Packets(_) => None,
            Place::Trimming(offset) => self.oscillator.read(offset, now),
            Place::Number(word) => Some(0x0041_0032 + word),
            // Revision of an STM32F405: an emulator has none, and the image asks.
            Place::Identity => Some(0x1001_6413),
            Place::Held => Some(self.held.get(&address).copied().unwrap_or(0)),
            Place::Unknown => None,
        };
        found.unwrap_or_else(|| {
            self.unknown.insert(format!("read of {address:#010x}"));
            0
        })
    }

    /// Writes a register.
    pub(crate) fn write(&mut self, address: u32, size: usize, value: u32) {
        if let Some((word, bit)) = single_bit(address) {
            let others = self.read_word(word) & !(1 << bit);
            return self.write(word, 4, others | (value & 1) << bit);
        }
        let (now, apb1, core) = (self.now, self.clocks.apb1, self.clocks.core);
        let known = match place(self.kind, address & !3) {
            Place::Clock(offset) => {
                let known = self.clock.write(offset, value, now);
                self.set_clocks();
                known
            }
            // Priorities are written byte by byte.
            Place::Core(offset) => {
                self.interrupts.advance(now, core);
                let offset = offset + (address & 3);
                match self.interrupts.write(offset, size, value, now) {
                    Effect::Reset => {
                        self.asks_for_reset = true;
                        true
                    }
                    effect => effect == Effect::None,
                }
            }
            Place::Port(index, offset) => {
                self.advance_rotors();
                let known = self.ports[index].write(offset, value);
                self.show_port(index);
                known
            }
            Place::Timer(index, offset) => {
                self.advance_rotors();
                self.advance_timer(index);
                let known = self.timers[index].write(offset, value, now);
                self.show_channels(TIMERS[index].0);
                known
            }
            Place::Serial(index, offset) => {
                self.advance_serials();
                self.serials[index].write(offset, value, now, apb1)
            }
            Place::Watchdog(offset) => self.watchdog.write(offset, value, now),
            Place::Capture(offset) => self.capture.write(offset, value, now),
            Place::Can(offset) => {
                self.advance_can();
                let is_sending = self.bus.as_ref().is_some_and(|bus| bus.is_sending());
                let known = self.can.write(offset, value, now, apb1, is_sending);
                self.advance_can();
                known
            }
            Place::MessageRam(offset) => self.can.write_ram(offset, size, value),
            Place::OtherClock(offset) => {
                self.held.insert(address, value);
                let known = g474::write_clock(&mut self.clock, offset, value, now);
                self.set_clocks();
                known
            }
            Place::OtherSerial(index, offset) => {
                self.advance_serials();
                g474::write_serial(&mut self.serials[index], offset, value, now, apb1)
            }
            Place::Stream(offset) => {
                self.advance_serials();
                self.dma.write_stream(offset, value)
            }
            Place::Channel(offset) => {
                self.advance_serials();
                self.dma.write_channel(offset, value)
            }
            Place::Supply(offset) => self.supply.write(offset, value),
            Place::Lines(offset) => self.supply.write_line(offset, value),
            Place::Flash(offset) => match self.flash.write(offset, value, now, self.executes_at) {
                FlashEffect::Changed { content, time } => {
                    self.changed.extend(content);
                    self.now += time;
                    true
                }
                effect => effect == FlashEffect::None,
            },
            Place::Usb(offset) if self.has_usb() => {
                self.advance_usb();
                self.usb.write(offset, value)
            }
            Place::Packets(offset) if self.has_usb() => {
                let offset = offset + (address & 3);
                self.usb.write_packets(offset, size, value)
            }
            Place::Usb(_) | Place::Packets(_) => false,
            Place::Trimming(offset) => self.oscillator.write(offset, value, now),
            Place::Held => {
                self.hold(address, value);
                true
            }
            Place::Identity | Place::Number(_) | Place::Unknown => false,
        };
        // What was set up moves its first byte at once.
        self.advance_serials();
        if !known {
            self.unknown.insert(format!("write of {address:#010x}"));
        }
        self.set_lines();
        // The next event may be another one now, or an interrupt due.
        self.stop_at = self.now;
    }

    /// Keeps a value, and resets the peripherals that it says.
    fn hold(&mut self, address: u32, value: u32) {
        self.held.insert(address, value);
        if self.resets_usb(address, value) {
            self.usb = usb::controller(self.kind);
        }
        match address {
            RESET_OF_PORTS | g474::RESET_OF_PORTS => {
                for index in 0..PORTS.len() {
                    if value >> index & 1 != 0 {
                        self.ports[index].reset();
                        self.show_port(index);
                    }
                }
            }
            RESETS_OF_APB1 => {
                for (index, of) in TIMERS.into_iter().enumerate() {
                    // Bits 0 to 5: TIM2 to TIM7.
                    if of.0 >= 2 && value >> (of.0 - 2) & 1 != 0 {
                        self.timers[index] = Timer::new(of.4);
                        self.show_channels(of.0);
                    }
                }
                if value & CAN1 != 0 {
                    self.can = self.kind.controller();
                }
                self.set_clocks();
            }
            _ => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chip::Kind;
    use crate::trace::{Level, Pin};

    fn chip() -> Chip {
        let kind = Kind::Stm32f405;
        Chip::new(kind, kind.crystal(), 32_000)
    }

    #[test]
    fn an_access_that_is_not_modelled_is_named() {
        let mut chip = chip();
        chip.write(0x4001_3000, 4, 1);
        chip.read(0x4002_3C00, 4);
        let unknown: Vec<&String> = chip.unknown.iter().collect();
        assert_eq!(unknown, ["write of 0x40013000"]);
    }

    #[test]
    fn an_address_may_stand_for_a_bit() {
        // RCC_AHB1ENR, ports A and C.
        let mut chip = chip();
        chip.write(0x4247_0600, 4, 1);
        chip.write(0x4247_0608, 4, 1);
        assert_eq!(chip.read(0x4002_3830, 4), 0b101);
        assert_eq!(
            (chip.read(0x4247_0604, 4), chip.read(0x4247_0608, 4)),
            (0, 1)
        );
    }

    #[test]
    fn a_reset_of_the_ports_lets_all_pins_go() {
        let mut chip = chip();
        chip.write(0x4002_0400, 4, 1 << 24);
        chip.write(0x4002_0418, 4, 1 << 12);
        assert_eq!(chip.trace.level(Pin('B', 12)), Level::High);
        chip.now = 100;
        chip.write(RESET_OF_PORTS, 4, 0x1F);
        assert_eq!(chip.trace.level(Pin('B', 12)), Level::Floating);
        assert_eq!(
            chip.trace.edges(Pin('B', 12)).last().map(|edge| edge.time),
            Some(100)
        );
    }
}
