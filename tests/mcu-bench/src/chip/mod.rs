//! Registers of the STM32F405 that the image uses, and what they do in time.
//!
//! Registers that the image touches and that are not here are an error of the bench, not memory: [`Chip::unknown`].

mod bxcan;
mod capture;
mod clock;
mod dma;
mod fdcan;
mod g474;
mod interrupts;
mod memory;
mod port;
mod serial;
mod supply;
mod timer;
mod watchdog;

pub(crate) use clock::{ClockControl, Clocks, Crystal, ResetCause};
pub(crate) use interrupts::{HARD_FAULT, Interrupts, NMI, SYS_TICK};
pub(crate) use memory::{RAM, RAM_BYTES};
pub(crate) use port::{Mode, Port};
pub(crate) use serial::Serial;

use crate::bus::CanBus;
use crate::rotors::Rotors;
use crate::time::Time;
use crate::trace::{Level, Pin, Trace};
use crate::wiring;
use bxcan::BxCan;
use capture::CrystalCapture;
use dma::Dma;
use fdcan::FdCan;
use interrupts::Effect;
use std::collections::{BTreeMap, BTreeSet};
use supply::Supply;
use timer::Timer;
use watchdog::Watchdog;

/// Ports A to E.
const PORTS: [char; 5] = ['A', 'B', 'C', 'D', 'E'];

/// Interrupt of TIM7: the slots of the steppers.
pub(crate) const TIM7: u16 = 55;

/// Timers: number, address, interrupt, on APB2, with 32 bits.
const TIMERS: [(u8, u32, u16, bool, bool); 6] = [
    (1, 0x4001_0000, 25, true, false),
    (2, 0x4000_0000, 28, false, true),
    (3, 0x4000_0400, 29, false, false),
    (4, 0x4000_0800, 30, false, false),
    (5, 0x4000_0C00, 50, false, true),
    (7, 0x4000_1400, TIM7, false, false),
];

/// Serial ports: address, interrupt. USART2 is the line, USART3 the log.
const SERIALS: [(u32, u16); 2] = [(0x4000_4400, 38), (0x4000_4800, 39)];

/// Index of the line among the serial ports.
const LINE: usize = 0;

/// Pins of channels of timers: pin, alternate function, timer, channel.
const CHANNELS: [(Pin, u8, u8, u8); 5] = [
    (Pin('A', 0), 1, 2, 0),
    (Pin('A', 5), 1, 2, 0),
    (Pin('C', 6), 2, 3, 0),
    (Pin('C', 7), 2, 3, 1),
    (Pin('C', 8), 2, 3, 2),
];

/// Timers with encoders of motor 1, 2, 3, and the one with the set values.
const ENCODERS: [u8; 3] = [1, 4, 5];
const SET_VALUE_TIMER: u8 = 3;

/// Registers that hold what is written and do nothing that the bench shows: address and bytes.
const HELD: [(u32, u32); 5] = [
    // RCC: resets and clocks of peripherals, and in standby.
    (0x4002_3810, 0x60),
    // Flash: wait states and caches. The model of time has them in its mean.
    (0x4002_3C00, 0x18),
    // DBGMCU: what stands still under a debugger.
    (0xE004_2004, 12),
    // FPU: lazy stacking.
    (0xE000_EF34, 12),
    // DWT and DCB.
    (0xE000_EDF0, 16),
];

const RESET_OF_PORTS: u32 = 0x4002_3810;
const RESETS_OF_APB1: u32 = 0x4002_3820;
const CAN1: u32 = 1 << 25;
const IDENTITY: u32 = 0xE004_2000;
/// DBGMCU_APB1_FZ, and its bit for the watchdog.
const STANDS_AT_HALT: u32 = 0xE004_2008;
const WATCHDOG_STANDS: u32 = 1 << 12;

/// Chip that the bench models.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum Kind {
    Stm32f405,
    Stm32g474,
}

impl Kind {
    /// Returns the crystal for which images are built: that of the generic board, or of the Nucleo.
    pub(crate) fn crystal(self) -> Crystal {
        match self {
            Self::Stm32f405 => Crystal::Runs { mhz: 8 },
            Self::Stm32g474 => Crystal::Runs { mhz: 24 },
        }
    }
}

pub(crate) struct Chip {
    kind: Kind,
    pub(crate) now: Time,
    /// Time at which the processor has to look at the chip again.
    pub(crate) stop_at: Time,
    pub(crate) clock: ClockControl,
    clocks: Clocks,
    pub(crate) interrupts: Interrupts,
    ports: [Port; 5],
    timers: Vec<Timer>,
    serials: [Serial; 2],
    pub(crate) dma: Dma,
    pub(crate) watchdog: Watchdog,
    capture: CrystalCapture,
    /// Machine behind amplifiers and encoders, with the level at which they are on.
    pub(crate) rotors: Option<(Rotors, bool)>,
    can: BxCan,
    fd_can: FdCan,
    /// Bus at the controller.
    pub(crate) bus: Option<Box<dyn CanBus>>,
    supply: Supply,
    held: BTreeMap<u32, u32>,
    /// Accesses to registers that are not modelled.
    pub(crate) unknown: BTreeSet<String>,
    pub(crate) trace: Trace,
    /// Reset that the program has asked for.
    pub(crate) asks_for_reset: bool,
}

impl Chip {
    /// Creates a chip whose watchdog's oscillator has so many Hz.
    pub(crate) fn new(kind: Kind, crystal: Crystal, oscillator_hz: u64) -> Self {
        let clock = ClockControl::new(crystal);
        let clocks = clock.clocks();
        let port = |name| match kind {
            Kind::Stm32f405 => Port::new(name),
            Kind::Stm32g474 => Port::with_modes(g474::reset_modes(name)),
        };
        let mut chip = Self {
            kind,
            now: 0,
            stop_at: 0,
            clock,
            clocks,
            interrupts: Interrupts::new(),
            ports: PORTS.map(port),
            timers: TIMERS.iter().map(|timer| Timer::new(timer.4)).collect(),
            serials: [Serial::default(), Serial::default()],
            dma: Dma::new(kind),
            watchdog: Watchdog::new(oscillator_hz),
            capture: CrystalCapture::default(),
            rotors: None,
            can: BxCan::new(),
            fd_can: FdCan::new(),
            bus: None,
            supply: Supply::new(),
            held: BTreeMap::new(),
            unknown: BTreeSet::new(),
            trace: Trace::default(),
            asks_for_reset: false,
        };
        chip.set_clocks();
        chip
    }

    /// Resets all registers.
    pub(crate) fn reset(&mut self, cause: ResetCause) {
        self.advance();
        self.clock.reset(cause);
        self.interrupts = Interrupts::new();
        for (timer, of) in self.timers.iter_mut().zip(TIMERS) {
            *timer = Timer::new(of.4);
        }
        for port in &mut self.ports {
            port.reset();
        }
        for serial in &mut self.serials {
            serial.reset();
        }
        self.dma.reset();
        self.watchdog.reset();
        self.capture = CrystalCapture::default();
        self.can = BxCan::new();
        self.fd_can = FdCan::new();
        self.supply.reset();
        // What a debugger has set stays.
        self.held.retain(|address, _| *address == STANDS_AT_HALT);
        self.asks_for_reset = false;
        self.set_clocks();
        self.show_all_pins();
    }

    pub(crate) fn core_period(&self) -> Time {
        self.clocks.core
    }

    /// Returns how often the controller has gone off the bus.
    pub(crate) fn bus_offs(&self) -> u32 {
        match self.kind {
            Kind::Stm32f405 => self.can.offs,
            Kind::Stm32g474 => self.fd_can.offs,
        }
    }

    /// Returns the line.
    pub(crate) fn line(&mut self) -> &mut Serial {
        &mut self.serials[LINE]
    }

    /// Returns the baud rate of the line, if it is set up.
    pub(crate) fn line_baud(&self) -> Option<f64> {
        self.serials[LINE].baud(self.clocks.apb1)
    }

    /// Drives a pin from outside; none lets it go.
    pub(crate) fn drive(&mut self, pin: Pin, level: Option<bool>) {
        if let Some(index) = PORTS.iter().position(|name| *name == pin.0) {
            self.ports[index].outside[usize::from(pin.1)] = level;
        }
    }

    /// Changes the voltage of the supply, mV.
    pub(crate) fn set_supply(&mut self, millivolts: u32) {
        self.supply.set_millivolts(millivolts);
        self.set_lines();
    }

    /// The crystal stops. Returns `true` if the core goes on: by the clock security system, or without the crystal.
    pub(crate) fn stop_crystal(&mut self) -> bool {
        self.advance();
        let fed = self.clock.is_fed_by_crystal();
        if self.clock.stop_crystal() {
            self.interrupts.fail();
            self.set_clocks();
            return true;
        }
        !fed
    }

    /// Returns true if the watchdog counts while a debugger holds the core.
    pub(crate) fn watchdog_bites_at_halt(&self) -> bool {
        let frozen = self.held.get(&STANDS_AT_HALT).copied().unwrap_or(0);
        frozen & WATCHDOG_STANDS == 0
    }

    fn set_clocks(&mut self) {
        self.clocks = self.clock.clocks();
        for (timer, (_, _, _, on_apb2, _)) in self.timers.iter_mut().zip(TIMERS) {
            let bus = if on_apb2 {
                self.clocks.apb2
            } else {
                self.clocks.apb1
            };
            timer.clock = self.clocks.timers(bus);
        }
    }

    /// Brings everything to the present time.
    pub(crate) fn advance(&mut self) {
        self.interrupts.advance(self.now, self.clocks.core);
        for index in 0..self.timers.len() {
            self.advance_timer(index);
        }
        self.advance_serials();
        self.advance_can();
        self.set_lines();
    }

    fn advance_serials(&mut self) {
        for (index, serial) in self.serials.iter_mut().enumerate() {
            serial.serve(self.now, self.clocks.apb1, &mut self.dma.path(index));
        }
        self.unknown.extend(self.dma.faults.drain(..));
    }

    fn advance_can(&mut self) {
        let bus = self.bus.as_deref_mut().map(|bus| bus as _);
        match self.kind {
            Kind::Stm32f405 => self.can.advance(self.now, self.clocks.apb1, bus),
            Kind::Stm32g474 => self.fd_can.advance(self.now, self.clocks.apb1, bus),
        }
    }

    /// Lets the machine behind the amplifiers go on to the present time.
    pub(crate) fn advance_rotors(&mut self) {
        let Some((rotors, on)) = &mut self.rotors else {
            return;
        };
        let timer = |number: u8| TIMERS.iter().position(|timer| timer.0 == number);
        let enabled = self.trace.level(wiring::ENABLE) == Level::of(*on);
        let set = timer(SET_VALUE_TIMER)
            .filter(|_| enabled)
            .and_then(|index| {
                let timer = &self.timers[index];
                Some([
                    timer.set_value(0)?,
                    timer.set_value(1)?,
                    timer.set_value(2)?,
                ])
            });
        let turned = rotors.advance(self.now, set);
        for (number, counts) in ENCODERS.into_iter().zip(turned) {
            if let Some(index) = timer(number) {
                self.timers[index].turn(counts);
            }
        }
    }

    fn advance_timer(&mut self, index: usize) {
        let (now, number) = (self.now, TIMERS[index].0);
        let (ports, trace) = (&self.ports, &mut self.trace);
        self.timers[index].advance(now, |edge| {
            let of = |(_, _, timer, channel): &(Pin, u8, u8, u8)| {
                (*timer, *channel) == (number, edge.channel)
            };
            for (pin, function, ..) in CHANNELS.into_iter().filter(of) {
                if mode_of(ports, pin) == Some(Mode::Alternate(function)) {
                    trace.record(edge.time, pin, Level::of(edge.high));
                }
            }
        });
    }

    fn set_lines(&mut self) {
        for (timer, (_, _, interrupt, _, _)) in self.timers.iter().zip(TIMERS) {
            self.interrupts.set_line(interrupt, timer.interrupts());
        }
        self.interrupts
            .set_line(supply::PVD, self.supply.interrupts());
        self.interrupts.set_line(bxcan::RX0, self.can.interrupts());
        self.interrupts
            .set_line(fdcan::IT0, self.fd_can.interrupts());
        for (serial, (_, interrupt)) in self.serials.iter().zip(SERIALS) {
            self.interrupts.set_line(interrupt, serial.interrupts());
        }
        self.dma.set_lines(&mut self.interrupts);
    }

    /// Returns the time of the next event that the processor has to see.
    pub(crate) fn next_event(&self) -> Option<Time> {
        let timers = self.timers.iter().filter_map(Timer::next_interrupt);
        let serials = self.serials.iter().filter_map(Serial::next_event);
        timers
            .chain(serials)
            .chain(self.interrupts.tick.next(self.clocks.core))
            .chain(self.watchdog.bite())
            .chain(match self.kind {
                Kind::Stm32f405 => self.can.next(self.bus.as_deref()),
                Kind::Stm32g474 => self.fd_can.next(self.bus.as_deref()),
            })
            .min()
    }

    /// Records the level of a pin.
    fn show(&mut self, pin: Pin) {
        let Some(port) = port_of(&self.ports, pin) else {
            return;
        };
        let level = match port.mode(pin.1) {
            Mode::Input | Mode::Analog => Level::Floating,
            Mode::Output => port.driven(pin.1),
            Mode::Alternate(function) => {
                let of = |channel: &&(Pin, u8, u8, u8)| (channel.0, channel.1) == (pin, function);
                let Some((_, _, number, channel)) = CHANNELS.iter().find(of) else {
                    return;
                };
                let index = TIMERS.iter().position(|timer| timer.0 == *number);
                let output = index.and_then(|index| self.timers[index].output(*channel, self.now));
                // A channel that is not on drives its idle level.
                Level::of(output.unwrap_or(false))
            }
        };
        self.trace.record(self.now, pin, level);
    }

    fn show_port(&mut self, index: usize) {
        for bit in 0..16 {
            self.show(Pin(PORTS[index], bit));
        }
    }

    fn show_all_pins(&mut self) {
        for index in 0..PORTS.len() {
            self.show_port(index);
        }
    }

    fn show_channels(&mut self, number: u8) {
        for (pin, _, timer, _) in CHANNELS {
            if timer == number {
                self.show(pin);
            }
        }
    }

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
        let found = match self.place(address) {
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
            Place::FdCan(offset) => {
                self.advance_can();
                let read = self.fd_can.read(offset);
                self.set_lines();
                read
            }
            Place::MessageRam(offset) => self.fd_can.read_ram(offset),
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
        let known = match self.place(address & !3) {
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
            Place::FdCan(offset) => {
                self.advance_can();
                let is_sending = self.bus.as_ref().is_some_and(|bus| bus.is_sending());
                let known = self.fd_can.write(offset, value, now, apb1, is_sending);
                self.advance_can();
                known
            }
            Place::MessageRam(offset) => self.fd_can.write_ram(offset, size, value),
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
            Place::Held => {
                self.hold(address, value);
                true
            }
            Place::Identity | Place::Unknown => false,
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
                    self.can = BxCan::new();
                }
                self.set_clocks();
            }
            _ => {}
        }
    }

    fn place(&self, address: u32) -> Place {
        let within = |start: u32, bytes: u32| {
            (start..start + bytes)
                .contains(&address)
                .then(|| address - start)
        };
        if self.kind == Kind::Stm32g474
            && let Some(place) = g474::place(address)
        {
            return place;
        }
        if let Some(offset) = within(0x4002_3800, 0x0C).or(within(0x4002_3874, 4).map(|_| 0x74)) {
            return Place::Clock(offset);
        }
        if HELD
            .iter()
            .any(|(start, bytes)| within(*start, *bytes).is_some())
        {
            return Place::Held;
        }
        if let Some(offset) = within(0x4002_0000, 0x400 * PORTS.len() as u32) {
            return Place::Port((offset / 0x400) as usize, offset % 0x400);
        }
        for (index, (_, start, ..)) in TIMERS.iter().enumerate() {
            if let Some(offset) = within(*start, 0x400) {
                return Place::Timer(index, offset);
            }
        }
        for (index, (start, _)) in SERIALS.iter().enumerate() {
            if let Some(offset) = within(*start, 0x400) {
                return Place::Serial(index, offset);
            }
        }
        if let Some(offset) = within(0x4002_6000, 0x800) {
            return Place::Stream(offset);
        }
        let others: [(u32, fn(u32) -> Place); 4] = [
            (0x4000_6400, Place::Can),
            (0x4001_4800, Place::Capture),
            (0x4000_7000, Place::Supply),
            (0x4001_3C00, Place::Lines),
        ];
        for (start, place) in others {
            if let Some(offset) = within(start, 0x400) {
                return place(offset);
            }
        }
        match (within(0x4000_3000, 0x400), within(0xE000_E000, 0x1000)) {
            (Some(offset), _) => Place::Watchdog(offset),
            (_, Some(offset)) => Place::Core(offset),
            _ if address == IDENTITY => Place::Identity,
            _ => Place::Unknown,
        }
    }
}

/// Returns the register and the bit of an address that stands for a single bit.
fn single_bit(address: u32) -> Option<(u32, u32)> {
    let offset = address
        .checked_sub(0x4200_0000)
        .filter(|offset| *offset < 0x200_0000)?;
    // 32 bytes for each byte, four for each bit.
    let (byte, bit) = (offset / 32, offset / 4 % 8);
    Some((0x4000_0000 + (byte & !3), (byte & 3) * 8 + bit))
}

/// Peripheral, and the offset in it.
enum Place {
    Clock(u32),
    Core(u32),
    Port(usize, u32),
    Timer(usize, u32),
    Serial(usize, u32),
    Watchdog(u32),
    Capture(u32),
    Can(u32),
    FdCan(u32),
    MessageRam(u32),
    OtherClock(u32),
    OtherSerial(usize, u32),
    Stream(u32),
    Channel(u32),
    Supply(u32),
    Lines(u32),
    Identity,
    Held,
    Unknown,
}

fn port_of(ports: &[Port], pin: Pin) -> Option<&Port> {
    let index = PORTS.iter().position(|name| *name == pin.0)?;
    ports.get(index)
}

fn mode_of(ports: &[Port], pin: Pin) -> Option<Mode> {
    port_of(ports, pin).map(|port| port.mode(pin.1))
}

#[cfg(test)]
mod tests {
    use super::*;

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
