//! Supply of the chip, with the detector of its voltage and its line of external interrupts (RM0090, chapters 5 and 12).

/// Interrupt of the detector.
pub(super) const PVD: u16 = 1;

/// Line of the detector.
const LINE: u32 = 1 << 16;

/// Levels of the detector, mV.
const LEVELS: [u32; 8] = [2000, 2100, 2300, 2500, 2600, 2700, 2800, 2900];

#[derive(Clone, Debug)]
pub(crate) struct Supply {
    millivolts: u32,
    control: u32,
    mask: u32,
    rising: u32,
    pending: u32,
}

impl Supply {
    pub(crate) fn new() -> Self {
        Self {
            millivolts: 3300,
            control: 0x4000,
            mask: 0,
            rising: 0,
            pending: 0,
        }
    }

    /// Registers as after a reset; the voltage is that of the world outside.
    pub(crate) fn reset(&mut self) {
        *self = Self {
            millivolts: self.millivolts,
            ..Self::new()
        };
    }

    /// The detector tells that the supply is below its level.
    fn is_low(&self) -> bool {
        let level = LEVELS[(self.control >> 5 & 7) as usize];
        self.control & 1 << 4 != 0 && self.millivolts < level
    }

    /// Changes something that may be an edge of the detector.
    fn change(&mut self, by: impl FnOnce(&mut Self)) {
        let was_low = self.is_low();
        by(self);
        if !was_low && self.is_low() {
            self.pending |= self.rising & LINE;
        }
    }

    pub(crate) fn set_millivolts(&mut self, millivolts: u32) {
        self.change(|supply| supply.millivolts = millivolts);
    }

    pub(crate) fn interrupts(&self) -> bool {
        self.pending & self.mask & LINE != 0
    }

    /// Reads PWR_CR or PWR_CSR.
    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.control,
            0x04 => u32::from(self.is_low()) << 2,
            _ => return None,
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32) -> bool {
        if offset != 0 {
            return false;
        }
        self.change(|supply| supply.control = value);
        true
    }

    /// Reads a register of EXTI.
    pub(crate) fn read_line(&self, offset: u32) -> Option<u32> {
        Some(match offset {
            0x00 => self.mask,
            0x08 => self.rising,
            0x14 => self.pending,
            _ => return None,
        })
    }

    /// Writes a register of EXTI. Lines other than that of the detector are not modelled.
    pub(crate) fn write_line(&mut self, offset: u32, value: u32) -> bool {
        match offset {
            0x00 => self.mask = value,
            0x08 => self.rising = value,
            0x14 => self.pending &= !value,
            _ => return false,
        }
        (self.mask | self.rising) & !LINE == 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_supply_that_falls_below_the_level_is_an_edge_once() {
        let mut supply = Supply::new();
        supply.write_line(0x08, LINE);
        supply.write_line(0x00, LINE);
        supply.set_millivolts(2600);
        // Off: no edge.
        assert!(!supply.interrupts());
        supply.set_millivolts(3300);
        supply.write(0x00, 5 << 5 | 1 << 4);
        supply.set_millivolts(2700);
        assert!(!supply.interrupts());
        supply.set_millivolts(2690);
        assert!(supply.interrupts());
        assert_eq!(supply.read(0x04), Some(4));
        supply.write_line(0x14, LINE);
        assert!(!supply.interrupts());
        supply.reset();
        assert_eq!(supply.read(0x04), Some(0));
    }

    #[test]
    fn another_line_is_not_modelled() {
        assert!(!Supply::new().write_line(0x00, LINE | 1));
    }
}
