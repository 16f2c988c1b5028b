//! The independent watchdog, which has an oscillator of its own (RM0090, chapter 21).

use crate::time::{Time, period};

#[derive(Clone, Debug)]
pub(crate) struct Watchdog {
    /// Clock of its oscillator, Hz: 32 kHz, and from 17 to 47 kHz by the data sheet.
    pub(crate) oscillator_hz: u64,
    unlocked: bool,
    prescaler: u32,
    reload: u32,
    /// Time of the last reload of one that runs, and its value: one that is written later counts from the next reload on.
    fed: Option<Time>,
    counts: u32,
}

impl Watchdog {
    pub(crate) fn new(oscillator_hz: u64) -> Self {
        Self {
            oscillator_hz,
            unlocked: false,
            prescaler: 0,
            reload: 0xFFF,
            fed: None,
            counts: 0xFFF,
        }
    }

    pub(crate) fn reset(&mut self) {
        *self = Self::new(self.oscillator_hz);
    }

    /// Returns the time from a reload until the watchdog bites.
    pub(crate) fn timeout(&self) -> Time {
        self.time(self.reload)
    }

    fn time(&self, counts: u32) -> Time {
        // 7 divides by as much as 6.
        let divider = 4 << self.prescaler.min(6);
        period(self.oscillator_hz) * divider * (Time::from(counts) + 1)
    }

    /// Returns the time at which the watchdog bites unless it is fed.
    pub(crate) fn bite(&self) -> Option<Time> {
        self.fed.map(|fed| fed + self.time(self.counts))
    }

    pub(crate) fn read(&self, offset: u32) -> Option<u32> {
        match offset {
            0x04 => Some(self.prescaler),
            0x08 => Some(self.reload),
            // No update is under way.
            0x00 | 0x0C => Some(0),
            _ => None,
        }
    }

    pub(crate) fn write(&mut self, offset: u32, value: u32, now: Time) -> bool {
        match (offset, value) {
            (0x00, 0xCCCC) if self.fed.is_none() => {
                (self.fed, self.counts) = (Some(now), self.reload)
            }
            (0x00, 0xAAAA) => {
                self.fed = self.fed.map(|_| now);
                self.counts = self.reload;
            }
            (0x00, 0x5555) => self.unlocked = true,
            (0x00, _) => {}
            (0x04, value) if self.unlocked => self.prescaler = value & 7,
            (0x08, value) if self.unlocked => self.reload = value & 0xFFF,
            (0x04 | 0x08, _) => {}
            _ => return false,
        }
        if offset == 0x00 && value != 0x5555 {
            self.unlocked = false;
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::time::MS;

    #[test]
    fn it_bites_unless_it_is_fed_and_never_stops() {
        let mut watchdog = Watchdog::new(32_000);
        assert_eq!(watchdog.bite(), None);
        for (offset, value) in [(0, 0x5555), (4, 6), (8, 24), (0, 0xCCCC)] {
            assert!(watchdog.write(offset, value, 0));
        }
        assert_eq!(watchdog.bite(), Some(200 * MS));
        watchdog.write(0, 0xAAAA, 50 * MS);
        assert_eq!(watchdog.bite(), Some(250 * MS));
        // A shorter one counts from the next reload on.
        for (offset, value) in [(0, 0x5555), (8, 9)] {
            assert!(watchdog.write(offset, value, 50 * MS));
        }
        assert_eq!(watchdog.bite(), Some(250 * MS));
        watchdog.write(0, 0xAAAA, 60 * MS);
        assert_eq!(watchdog.bite(), Some(140 * MS));
        for (offset, value) in [(0, 0x5555), (8, 24), (0, 0xAAAA)] {
            assert!(watchdog.write(offset, value, 50 * MS));
        }
        // Locked again.
        watchdog.write(4, 0, 50 * MS);
        assert_eq!(watchdog.timeout(), 200 * MS);
    }
}
