//! The line that switches all power stages on.

use embedded_hal::digital::OutputPin;

/// The level at which a power stage is on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Active {
    /// Low: A4988, DRV8825 and TMC22xx call it `EN` with a bar.
    Low,
    /// High.
    High,
}

/// The enable line. It knows what it said last, so that saying it again costs nothing.
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
    /// The pin's.
    pub fn new(pin: E, active: Active) -> Result<Self, E::Error> {
        let mut enable = Self {
            pin,
            active,
            on: true,
        };
        enable.switch(false)?;
        Ok(enable)
    }

    /// Switches; whether that was a change.
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
