//! Oscillator of 48 MHz of the STM32G474, and the clock recovery system that trims it by the frames of a host (RM0440, 7.2.8 and chapter 8).

use crate::time::{MICROSECOND, Time};

/// Its register in the clocks, behind those of the recovery system.
pub(super) const CRRCR: u32 = 0x400;

/// Part by which the oscillator is fast as it starts.
const OFF_AT_START: f64 = 0.01;

/// Part of a step of its trimming.
const STEP: f64 = 0.0014;

/// Time until it is ready: the data sheet's longest.
const START: Time = 6 * MICROSECOND;

/// Bits of the control register: counter, automatic trimming.
const COUNTS: u32 = 1 << 5;
const TRIMS: u32 = 1 << 6;

/// Frames of USB as the source of synchronisation.
const OF_USB: u32 = 2;

/// Oscillator with its trimming.
#[derive(Clone, Debug)]
pub(crate) struct Hsi48 {
    on_since: Option<Time>,
    error: f64,
    control: u32,
    settings: u32,
}

impl Hsi48 {
    pub(crate) fn new() -> Self {
        Self {
            on_since: None,
            error: OFF_AT_START,
            control: 0x4000,
            settings: 0x2022_BB7F,
        }
    }

    fn is_ready(&self, now: Time) -> bool {
        self.on_since.is_some_and(|since| now >= since + START)
    }

    /// Returns the part by which the clock is off; none while it does not run.
    pub(super) fn error(&self, now: Time) -> Option<f64> {
        self.is_ready(now).then_some(self.error)
    }

    /// Counts a frame of the host, and trims.
    pub(super) fn follow(&mut self) {
        let is_of_usb = self.settings >> 28 & 3 == OF_USB;
        if self.on_since.is_none()
            || self.control & (COUNTS | TRIMS) != COUNTS | TRIMS
            || !is_of_usb
        {
            return;
        }
        let counts = f64::from((self.settings & 0xFFFF) + 1) * self.error;
        let limit = f64::from(self.settings >> 16 & 0xFF);
        let steps = match counts.abs() {
            off if off < limit => 0.0,
            off if off < 3.0 * limit => 1.0,
            off if off < 128.0 * limit => 2.0,
            _ => 0.0,
        };
        self.error -= steps * STEP * counts.signum();
    }

    pub(crate) fn read(&self, offset: u32, now: Time) -> Option<u32> {
        Some(match offset {
            0x00 => self.control,
            0x04 => self.settings,
            CRRCR => u32::from(self.on_since.is_some()) | u32::from(self.is_ready(now)) << 1,
            _ => return None,
        })
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> bool {
        match offset {
            0x00 => self.control = value,
            0x04 => self.settings = value,
            CRRCR => {
                let is_on = value & 1 != 0;
                self.on_since = is_on.then(|| self.on_since.unwrap_or(now));
            }
            _ => return false,
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_of_the_host_trim_the_oscillator_once_it_is_told_so() {
        let mut oscillator = Hsi48::new();
        assert_eq!(oscillator.error(START), None);
        oscillator.write(CRRCR, 1, 0);
        assert_eq!(oscillator.read(CRRCR, START), Some(3));
        for _ in 0..10 {
            oscillator.follow();
        }
        assert_eq!(oscillator.error(START), Some(OFF_AT_START));
        oscillator.write(0x00, 0x4000 | COUNTS | TRIMS, 0);
        for _ in 0..10 {
            oscillator.follow();
        }
        assert!(
            oscillator
                .error(START)
                .is_some_and(|error| error.abs() < 0.0015)
        );
    }
}
