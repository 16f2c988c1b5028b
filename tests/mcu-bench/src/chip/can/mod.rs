//! Controllers of CAN by their registers. Both kinds have the same fault confinement and the same way to the bus.

mod bxcan;
mod fdcan;

pub(super) use bxcan::BxCan;
pub(super) use fdcan::FdCan;

use crate::bus::{BusEvent, CanBus, WireFrame};
use crate::time::Time;

/// Places of FIFO 0, and mailboxes or buffers of frames that go out.
const PLACES: usize = 3;

/// Error counters at which a controller warns, is passive, and off.
const WARNING: u32 = 96;
const PASSIVE: u32 = 128;
const OFF: u32 = 256;

/// Bits of silence after which a controller takes part, and after which one that is off is back: 128 times.
const SILENCE: Time = 11;

/// Parts of a bit rate by which a controller's may be off that of the drives.
const RATE_ERROR: f64 = 0.005;

/// Returns true if a bit rate is too far off that of the drives, both in Hz.
fn is_off_rate(rate_hz: f64, of_drives_hz: u32) -> bool {
    (rate_hz / f64::from(of_drives_hz) - 1.0).abs() > RATE_ERROR
}

/// Error of a frame that was sent, by the code that a controller keeps of the last one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum SendError {
    NotAcknowledged = 3,
    /// A dominant bit that was read as recessive.
    Bit = 5,
}

/// Controller as the chip sees it.
pub(super) trait CanController {
    /// Number of the interrupt of received frames.
    fn interrupt(&self) -> u16;

    /// Returns true while that interrupt is asked for.
    fn interrupts(&self) -> bool;

    /// Reads a register.
    fn read(&self, offset: u32) -> Option<u32>;

    /// Writes a register. The controller has to be [advanced](Self::advance) to `now` before, and after.
    fn write(&mut self, offset: u32, value: u32, now: Time, clock: Time, is_sending: bool) -> bool;

    /// Reads a word of the message RAM, if there is one.
    fn read_ram(&self, _: u32) -> Option<u32> {
        None
    }

    /// Writes to the message RAM so many bytes.
    fn write_ram(&mut self, _: u32, _: usize, _: u32) -> bool {
        false
    }

    fn confinement(&self) -> &Confinement;

    fn confinement_mut(&mut self) -> &mut Confinement;

    /// Returns true if the controller, with a clock of this period, reads the bits on the bus, and its own.
    fn understands(&self, clock: Time, bus: &dyn CanBus) -> bool;

    /// Returns the frame that takes part in the next arbitration.
    fn offered(&mut self, now: Time) -> Option<WireFrame>;

    /// A drive has acknowledged a frame of the controller.
    fn sent(&mut self, frame: &WireFrame);

    /// A frame has not got through: it is repeated, unless the program has aborted it.
    fn failed(&mut self, error: SendError);

    /// The controller has gone off the bus at `time`.
    fn gone_off(&mut self, time: Time, clock: Time);

    /// A frame of a drive is there.
    fn receive(&mut self, frame: &WireFrame);

    /// Brings the controller and its bus to the present time.
    fn advance(&mut self, now: Time, clock: Time, bus: Option<&mut (dyn CanBus + '_)>) {
        self.confinement_mut().advance(now);
        let Some(bus) = bus else {
            return;
        };
        let understands = self.understands(clock, bus);
        loop {
            bus.set_listening(self.confinement().is_on(now) && understands);
            bus.offer(self.offered(now));
            let Some((time, event)) = bus.step(now) else {
                return;
            };
            self.handle(time, clock, event);
        }
    }

    /// Carries out an event on the bus.
    fn handle(&mut self, time: Time, clock: Time, event: BusEvent) {
        match event {
            BusEvent::Sent(frame) => {
                self.confinement_mut().count_sent();
                self.sent(&frame);
            }
            BusEvent::NotAcknowledged => {
                self.confinement_mut().count_unacknowledged();
                self.failed(SendError::NotAcknowledged);
            }
            BusEvent::BitError => {
                let goes_off = self.confinement_mut().count_bit_error();
                self.failed(SendError::Bit);
                if goes_off {
                    self.gone_off(time, clock);
                }
            }
            BusEvent::Received(frame) => self.receive(&frame),
        }
    }
}

/// Fault confinement: the counter of transmit errors, and the time from which on a controller takes part.
#[derive(Clone, Debug, Default)]
pub(super) struct Confinement {
    transmit_errors: u32,
    /// None in initialisation, asleep, and off the bus for good.
    on_since: Option<Time>,
    is_off: bool,
    offs: u32,
}

impl Confinement {
    /// Returns how often the controller has gone off the bus.
    pub(super) fn offs(&self) -> u32 {
        self.offs
    }

    /// Returns the time of the next change; `bus` tells when it has one.
    pub(super) fn next(&self, bus: Option<&dyn CanBus>) -> Option<Time> {
        let back = self.on_since.filter(|_| self.is_off);
        let on = self.on_since.and_then(|_| bus.and_then(CanBus::next));
        on.into_iter().chain(back).min()
    }

    /// Returns true from the time on at which the controller takes part.
    fn is_on(&self, now: Time) -> bool {
        self.on_since.is_some_and(|since| since <= now)
    }

    fn advance(&mut self, now: Time) {
        if self.is_off && self.is_on(now) {
            (self.is_off, self.transmit_errors) = (false, 0);
        }
    }

    /// Lets the controller take part after bits of this length of silence.
    fn start(&mut self, now: Time, bit: Time) {
        let times = if self.is_off { 128 } else { 1 };
        self.on_since = Some(now + times * SILENCE * bit);
    }

    fn stop(&mut self) {
        self.on_since = None;
    }

    fn count_sent(&mut self) {
        self.transmit_errors = self.transmit_errors.saturating_sub(1);
    }

    /// A controller that is passive counts no more frames without an acknowledgement: none else may be on the bus.
    fn count_unacknowledged(&mut self) {
        if !self.is_passive() {
            self.transmit_errors += 8;
        }
    }

    /// Returns true if the controller goes off the bus with this error.
    fn count_bit_error(&mut self) -> bool {
        self.transmit_errors += 8;
        if self.transmit_errors < OFF {
            return false;
        }
        self.is_off = true;
        self.offs += 1;
        self.stop();
        true
    }

    fn warns(&self) -> bool {
        self.transmit_errors >= WARNING
    }

    fn is_passive(&self) -> bool {
        self.transmit_errors >= PASSIVE
    }

    /// Counter as a register of eight bits shows it.
    fn shown_errors(&self) -> u32 {
        self.transmit_errors.min(255)
    }
}
