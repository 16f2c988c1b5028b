//! Enable line: switches all power stages on and off.

use embedded_hal::digital::OutputPin;

/// Level at which a power stage is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Active {
    /// Low: A4988, DRV8825 and TMC22xx call it `EN` with a bar.
    Low,
    /// High.
    High,
}

impl Active {
    /// The level that is high if `is_high`.
    pub const fn at(is_high: bool) -> Self {
        match is_high {
            true => Self::High,
            false => Self::Low,
        }
    }

    /// Level of the pin while the stage is off; true is high.
    pub const fn off(self) -> bool {
        matches!(self, Self::Low)
    }
}

/// Enable line with its last state: setting the same state again writes no pin.
#[derive(Debug)]
pub struct Enable<E> {
    pin: E,
    active: Active,
    on: bool,
}

impl<E: OutputPin> Enable<E> {
    /// Takes the line and switches off.
    ///
    /// # Errors
    /// Those of the pin.
    pub fn new(pin: E, active: Active) -> Result<Self, E::Error> {
        let mut enable = Self {
            pin,
            active,
            on: true,
        };
        enable.switch(false)?;
        Ok(enable)
    }

    /// Switches. Returns `true` if that was a change.
    #[inline(always)]
    pub(crate) fn switch(&mut self, on: bool) -> Result<bool, E::Error> {
        if on == self.on {
            return Ok(false);
        }
        match on == (self.active == Active::High) {
            true => self.pin.set_high()?,
            false => self.pin.set_low()?,
        }
        self.on = on;
        Ok(true)
    }
}
