//! Registers of the STM32F405 that the image uses, and what they do in time.
//!
//! Registers that the image touches and that are not here are an error of the bench, not memory: [`Chip::unknown`]. `map` has the addresses,
//! `registers` the accesses, `pins` the levels that follow.

mod can;
mod capture;
mod clock;
mod dma;
mod flash;
mod g474;
mod interrupts;
mod map;
mod memory;
mod pins;
mod port;
mod registers;
mod serial;
mod supply;
mod timer;
mod usb;
mod watchdog;

pub(crate) use clock::{ClockControl, Clocks, Crystal, ResetCause};
pub(crate) use flash::{Content, FlashControl, Stored};
pub(crate) use interrupts::{HARD_FAULT, Interrupts, NMI, SYS_TICK};
pub(crate) use map::TIM7;
pub(crate) use memory::{RAM, RAM_BYTES};
pub(crate) use port::{Mode, Port};
pub(crate) use serial::Serial;
pub(crate) use usb::{Answer, BusSignal, UsbController, UsbPacket};

use crate::bus::CanBus;
use crate::rotors::Rotors;
use crate::time::Time;
use crate::trace::{Level, Pin, Trace};
use crate::usb::UsbHost;
use crate::wiring;
use can::{BxCan, CanController, FdCan};
use capture::CrystalCapture;
use dma::Dma;
use map::{SERIALS, TIMERS};
use std::collections::{BTreeMap, BTreeSet};
use supply::Supply;
use timer::Timer;
use trirrr_boot::Layout;
use usb::Hsi48;
use watchdog::Watchdog;

/// Ports A to E.
const PORTS: [char; 5] = ['A', 'B', 'C', 'D', 'E'];

/// Index of the line among the serial ports.
const LINE: usize = 0;

/// Timers with encoders of motor 1, 2, 3, and the one with the set values.
const ENCODERS: [u8; 3] = [1, 4, 5];
const SET_VALUE_TIMER: u8 = 3;

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

    /// Returns the parts of the flash, where images are replaced over the line.
    pub(crate) fn layout(self) -> Layout {
        match self {
            Self::Stm32f405 => Layout::STM32F405,
            Self::Stm32g474 => Layout::STM32G474,
        }
    }

    /// Returns the chip's controller of CAN as in a reset.
    fn controller(self) -> Box<dyn CanController> {
        match self {
            Self::Stm32f405 => Box::new(BxCan::new()),
            Self::Stm32g474 => Box::new(FdCan::new()),
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
    can: Box<dyn CanController>,
    /// Bus at the controller.
    pub(crate) bus: Option<Box<dyn CanBus>>,
    usb: Box<dyn UsbController>,
    oscillator: Hsi48,
    /// Host at the plug of USB, for an image that has its line there.
    pub(crate) plug: Option<UsbHost>,
    supply: Supply,
    pub(crate) flash: FlashControl,
    /// Content of the flash that is not in the memory of the emulator yet.
    pub(crate) changed: Vec<Content>,
    /// Address of the code that is executed.
    pub(crate) executes_at: u32,
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
            can: kind.controller(),
            bus: None,
            usb: usb::controller(kind),
            oscillator: Hsi48::new(),
            plug: None,
            supply: Supply::new(),
            flash: FlashControl::new(kind),
            changed: Vec::new(),
            executes_at: 0,
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
        self.can = self.kind.controller();
        self.usb = usb::controller(self.kind);
        self.oscillator = Hsi48::new();
        self.supply.reset();
        self.flash.reset();
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
        self.can.confinement().offs()
    }

    /// Returns the time from one call of a timer's interrupt to the next.
    pub(crate) fn slot_period(&self) -> Option<Time> {
        let index = TIMERS.iter().position(|timer| timer.2 == TIM7)?;
        self.timers.get(index).map(Timer::period)
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

    /// The crystal stops: the core goes on from the internal oscillator if the clock security system is on, or from a PLL that runs free.
    pub(crate) fn stop_crystal(&mut self) {
        self.advance();
        if self.clock.stop_crystal() {
            self.interrupts.fail();
        }
        self.set_clocks();
    }

    /// The PLL makes another clock of the core, Hz, and nothing tells so.
    pub(crate) fn run_free(&mut self, hz: u64) {
        self.advance();
        self.clock.run_free(hz);
        self.set_clocks();
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
        self.advance_usb();
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
        self.can.advance(self.now, self.clocks.apb1, bus);
    }

    /// Returns the time for which a level at an encoder's input has to last to count, of each motor.
    pub(crate) fn shortest_levels(&self) -> [Time; 3] {
        ENCODERS.map(|number| {
            let timers = self.timers.iter().zip(TIMERS);
            let mut of = timers.filter(|(_, timer)| timer.0 == number);
            of.next().map_or(0, |(timer, _)| timer.shortest_level())
        })
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

    fn set_lines(&mut self) {
        for (timer, (_, _, interrupt, _, _)) in self.timers.iter().zip(TIMERS) {
            self.interrupts.set_line(interrupt, timer.interrupts());
        }
        self.interrupts
            .set_line(supply::PVD, self.supply.interrupts());
        self.interrupts
            .set_line(self.can.interrupt(), self.can.interrupts());
        self.interrupts
            .set_line(self.usb.interrupt(), self.usb.interrupts());
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
            .chain(self.can.confinement().next(self.bus.as_deref()))
            .chain(self.plug.as_ref().map(UsbHost::next))
            .min()
    }
}
