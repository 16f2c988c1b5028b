//! Pins: what drives each of them, and its level in the trace.

use super::map::TIMERS;
use super::{Chip, Mode, PORTS, Port};
use crate::trace::{Level, Pin};

/// Pins of channels of timers: pin, alternate function, timer, channel.
const CHANNELS: [(Pin, u8, u8, u8); 5] = [
    (Pin('A', 0), 1, 2, 0),
    (Pin('A', 5), 1, 2, 0),
    (Pin('C', 6), 2, 3, 0),
    (Pin('C', 7), 2, 3, 1),
    (Pin('C', 8), 2, 3, 2),
];

impl Chip {
    /// Lets a timer go on to the present time, with the edges of its channels.
    pub(super) fn advance_timer(&mut self, index: usize) {
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

    pub(super) fn show_port(&mut self, index: usize) {
        for bit in 0..16 {
            self.show(Pin(PORTS[index], bit));
        }
    }

    pub(super) fn show_all_pins(&mut self) {
        for index in 0..PORTS.len() {
            self.show_port(index);
        }
    }

    pub(super) fn show_channels(&mut self, number: u8) {
        for (pin, _, timer, _) in CHANNELS {
            if timer == number {
                self.show(pin);
            }
        }
    }
}

fn port_of(ports: &[Port], pin: Pin) -> Option<&Port> {
    let index = PORTS.iter().position(|name| *name == pin.0)?;
    ports.get(index)
}

fn mode_of(ports: &[Port], pin: Pin) -> Option<Mode> {
    port_of(ports, pin).map(|port| port.mode(pin.1))
}
