//! A port of 16 pins (RM0090, chapter 8).

use crate::trace::Level;

/// Mode of a pin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Input,
    Output,
    /// A peripheral has the pin: this one of 16.
    Alternate(u8),
    Analog,
}

#[derive(Clone, Debug)]
pub(crate) struct Port {
    modes: u32,
    open_drain: u32,
    speeds: u32,
    pulls: u32,
    output: u32,
    alternate: [u32; 2],
    /// Reset value of the modes: debug pins are not inputs.
    reset_modes: u32,
    /// Levels that the world outside drives. It survives a reset of the chip.
    pub(crate) outside: [Option<bool>; 16],
}

impl Port {
    /// Port of an STM32F405.
    pub(crate) fn new(name: char) -> Self {
        let reset_modes = match name {
            'A' => 0xA800_0000,
            'B' => 0x280,
            _ => 0,
        };
        Self::with_modes(reset_modes)
    }

    /// Port whose pins have these modes in a reset.
    pub(crate) fn with_modes(reset_modes: u32) -> Self {
        Self {
            modes: reset_modes,
            open_drain: 0,
            speeds: 0,
            pulls: 0,
            output: 0,
            alternate: [0; 2],
            reset_modes,
            outside: [None; 16],
        }
    }

    pub(crate) fn reset(&mut self) {
        *self = Self {
            modes: self.reset_modes,
            open_drain: 0,
            speeds: 0,
            pulls: 0,
            output: 0,
            alternate: [0; 2],
            ..*self
        };
    }

    pub(crate) fn mode(&self, pin: u8) -> Mode {
        match self.modes >> (2 * pin) & 3 {
            0 => Mode::Input,
            1 => Mode::Output,
            2 => {
                let word = self.alternate[usize::from(pin / 8)];
                Mode::Alternate((word >> (4 * (pin % 8)) & 15) as u8)
            }
            _ => Mode::Analog,
        }
    }

    /// Returns the level that the port drives at a pin that is an output.
    pub(crate) fn driven(&self, pin: u8) -> Level {
        let high = self.output >> pin & 1 != 0;
        match high && self.open_drain >> pin & 1 != 0 {
            true => Level::Floating,
            false => Level::of(high),
        }
    }

    /// Returns the level that the program reads at an input: that from outside, or the pull's, or low.
    fn read_input(&self, pin: u8) -> bool {
        let pull_up = self.pulls >> (2 * pin) & 3 == 1;
        self.outside[usize::from(pin)].unwrap_or(pull_up)
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.modes,
            0x04 => self.open_drain,
            0x08 => self.speeds,
            0x0C => self.pulls,
            0x10 => (0..16).fold(0, |levels, pin| {
                let high = match self.mode(pin) {
                    Mode::Output => self.output >> pin & 1 != 0,
                    Mode::Analog => false,
                    Mode::Input | Mode::Alternate(_) => self.read_input(pin),
                };
                levels | u32::from(high) << pin
            }),
            0x14 => self.output,
            0x18 => 0,
            0x20 => self.alternate[0],
            0x24 => self.alternate[1],
            _ => return None,
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.modes = value,
            0x04 => self.open_drain = value & 0xFFFF,
            0x08 => self.speeds = value,
            0x0C => self.pulls = value,
            0x14 => self.output = value & 0xFFFF,
            // A pin that is set and cleared at once is set.
            0x18 => self.output = self.output & !(value >> 16) | value & 0xFFFF,
            0x20 => self.alternate[0] = value,
            0x24 => self.alternate[1] = value,
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_write_to_bsrr_changes_the_pins_that_it_names() {
        let mut port = Port::new('C');
        port.write(0x00, 0b0101);
        port.write(0x18, 0b11);
        port.write(0x18, 1 << 16);
        assert_eq!((port.driven(0), port.driven(1)), (Level::Low, Level::High));
        assert_eq!(port.read(0x10), Some(0b10));
        port.reset();
        assert_eq!((port.mode(0), port.read(0x14)), (Mode::Input, Some(0)));
    }

    #[test]
    fn an_input_reads_the_outside_before_its_pull() {
        let mut port = Port::new('A');
        port.write(0x0C, 1 << 12);
        assert_eq!(port.read(0x10).map(|levels| levels >> 6 & 1), Some(1));
        port.outside[6] = Some(false);
        assert_eq!(port.read(0x10).map(|levels| levels >> 6 & 1), Some(0));
    }
}
