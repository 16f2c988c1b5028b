//! Chips: the pins of a package, and the functions that each pin can take.

mod rp2040;
mod stm32f405;
mod stm32g474;

use super::clock::{ClockSettings, RP2040_CLOCK, STM32F405_CLOCK, STM32G474_CLOCK};
use super::role::Role;

/// Family of chips with a firmware of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// STM32F405.
    Stm32f405,
    /// STM32G474.
    Stm32g474,
    /// RP2040.
    Rp2040,
}

impl Family {
    const ALL: [Self; 3] = [Self::Stm32f405, Self::Stm32g474, Self::Rp2040];

    /// The family of this name in small letters.
    pub fn of(name: &str) -> Option<Self> {
        Self::ALL
            .into_iter()
            .find(|family| family.name().eq_ignore_ascii_case(name))
    }

    /// Name of the family.
    pub fn name(self) -> &'static str {
        match self {
            Self::Stm32f405 => "STM32F405",
            Self::Stm32g474 => "STM32G474",
            Self::Rp2040 => "RP2040",
        }
    }

    /// Cargo's alias that builds the firmware.
    pub(super) fn command(self) -> &'static str {
        match self {
            Self::Stm32f405 => "cargo fw",
            Self::Stm32g474 => "cargo fw-g474",
            Self::Rp2040 => "cargo fw-rp2040",
        }
    }

    /// Board of an image for which neither `BOARD` nor the scene names one.
    pub(super) fn default_board(self) -> &'static str {
        match self {
            Self::Stm32f405 => "generic-f405",
            Self::Stm32g474 => "nucleo-g474re",
            Self::Rp2040 => "pico",
        }
    }

    /// Clock of the family.
    pub(super) fn clock(self) -> &'static ClockSettings {
        match self {
            Self::Stm32f405 => &STM32F405_CLOCK,
            Self::Stm32g474 => &STM32G474_CLOCK,
            Self::Rp2040 => &RP2040_CLOCK,
        }
    }
}

/// Serial port of a chip, with its pins.
pub(super) struct SerialPort {
    /// Name in board files, in small letters.
    pub(super) name: &'static str,
    pub(super) transmit: &'static [&'static str],
    pub(super) receive: &'static [&'static str],
    /// None where the firmware moves the bytes itself.
    pub(super) dma: Option<SerialDma>,
}

/// Ways of a serial port's bytes by DMA: of the receiver, then of the transmitter.
pub(super) struct SerialDma {
    pub(super) controller: u8,
    /// Streams, or channels, of the controller, by their numbers in the manual.
    pub(super) streams: [u8; 2],
    /// Requests that the streams obey.
    pub(super) requests: [u8; 2],
}

impl SerialDma {
    const fn of(controller: u8, streams: [u8; 2], requests: [u8; 2]) -> Option<Self> {
        Some(Self {
            controller,
            streams,
            requests,
        })
    }
}

/// USB controller of a chip, as a device at full speed.
pub(super) struct Usb {
    /// Name of its interrupt.
    pub(super) interrupt: &'static str,
    /// Pins of a port that it has, D- and D+; none where the chip has pins for USB alone.
    pub(super) pins: &'static [&'static str],
}

/// Signal of a peripheral that a role takes, with its pins.
pub(super) struct Signal {
    pub(super) role: Role,
    /// Pin of the role: motor 1 is 0.
    pub(super) index: usize,
    /// Name in messages: `TIM2 CH1`.
    pub(super) name: &'static str,
    pub(super) pins: &'static [&'static str],
}

/// Chip in a package.
pub struct Chip {
    /// Name in board files.
    pub name: &'static str,
    /// Firmware that it runs.
    pub family: Family,
    /// Ports: the text before the number, and the number of pins, from 0.
    ports: &'static [(&'static str, &'static [u8])],
    /// Pins that no function may have, and why.
    withheld: &'static [(&'static str, &'static str)],
    pub(super) serial_ports: &'static [SerialPort],
    pub(super) usb: Usb,
    signals: &'static [Signal],
    /// Tables of drives that the firmware has no code for, and why.
    pub(super) without: &'static [(&'static str, &'static str)],
}

/// All chips.
pub(super) const CHIPS: [&Chip; 4] = [
    &stm32f405::STM32F405RG,
    &stm32f405::STM32F405VG,
    &stm32g474::STM32G474RE,
    &rp2040::RP2040,
];

impl Chip {
    /// Splits the name of a pin of this package into port and number. Returns `None` for any other text.
    pub(super) fn pin(&self, name: &str) -> Option<(&'static str, u8)> {
        self.ports.iter().find_map(|(port, numbers)| {
            let digits = name.strip_prefix(port)?;
            let number = numbers.iter().find(|number| number.to_string() == digits)?;
            Some((*port, *number))
        })
    }

    /// The reason for which no function, or no output, may have the pin, if there is one.
    pub(super) fn withheld(&self, name: &str, is_output: bool) -> Option<&'static str> {
        let is_withheld = |reason: &str| is_output || reason != stm32f405::BACKUP;
        let mut withheld = self.withheld.iter();
        let found = withheld.find(|(pin, reason)| *pin == name && is_withheld(reason));
        found.map(|(_, reason)| *reason)
    }

    /// The signal that pin `index` of a role takes; none if any pin does.
    pub(super) fn signal(&self, role: Role, index: usize) -> Option<&'static Signal> {
        let is_it = |signal: &&Signal| signal.role == role && signal.index == index;
        self.signals.iter().find(is_it)
    }

    /// The pins of `list` that the package has and a function may have, as text.
    pub(super) fn usable(&self, list: &[&str]) -> String {
        let usable = list
            .iter()
            .filter(|pin| self.pin(pin).is_some() && self.withheld(pin, true).is_none());
        let usable: Vec<&str> = usable.copied().collect();
        usable.join(", ")
    }

    /// Examples of pins, for messages.
    pub(super) fn pins_in_words(&self) -> String {
        let ports = self.ports.iter().map(|(port, numbers)| match numbers {
            [only] => format!("{port}{only}"),
            [first, .., last] => format!("{port}{first} to {port}{last}"),
            [] => String::new(),
        });
        ports.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pin_is_one_of_its_package() {
        let small = &stm32f405::STM32F405RG;
        assert_eq!(small.pin("PA13"), Some(("PA", 13)));
        assert_eq!(small.pin("PD2"), Some(("PD", 2)));
        for no_pin in ["PD3", "PA16", "PA01", "PA", "pa1", "A1", "GP1", ""] {
            assert_eq!(small.pin(no_pin), None, "{no_pin}");
        }
        assert_eq!(stm32f405::STM32F405VG.pin("PD3"), Some(("PD", 3)));
        assert_eq!(rp2040::RP2040.pin("GP29"), Some(("GP", 29)));
        assert_eq!(rp2040::RP2040.pin("GP30"), None);
        assert_eq!(
            small.pins_in_words(),
            "PA0 to PA15, PB0 to PB15, PC0 to PC15, PD2"
        );
    }

    #[test]
    fn each_signal_has_a_pin_in_every_package() {
        for chip in CHIPS {
            for signal in chip.signals {
                assert!(!chip.usable(signal.pins).is_empty(), "{}", signal.name);
                // A misspelt pin would never be found.
                for pin in signal.pins {
                    assert!(CHIPS.iter().any(|any| any.pin(pin).is_some()), "{pin}");
                }
            }
            for (pin, _) in chip.withheld {
                assert!(chip.pin(pin).is_some(), "{pin}");
            }
            for port in chip.serial_ports {
                assert!(!chip.usable(port.transmit).is_empty(), "{}", port.name);
                assert!(!chip.usable(port.receive).is_empty(), "{}", port.name);
                // Both directions at a time.
                let is_apart = |dma: &SerialDma| dma.streams[0] != dma.streams[1];
                let has_own = chip.family != Family::Rp2040;
                assert_eq!(port.dma.as_ref().map(is_apart), has_own.then_some(true));
            }
        }
    }

    #[test]
    fn a_family_is_found_by_its_name() {
        for family in Family::ALL {
            assert_eq!(Family::of(&family.name().to_lowercase()), Some(family));
        }
        assert_eq!(Family::of("stm32"), None);
    }
}
