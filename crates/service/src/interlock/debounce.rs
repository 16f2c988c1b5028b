//! One contact, its bounces taken out.

/// Contact with a counter: up in a tick that tells active, down in any other. The contact is active once the counter is at its
/// top, and clear once it is at 0. A wire that breaks and chatters stops the machine, too, if it tells active most of the time: readings
/// in a row, as [homing](crate::homing) takes them for the time of a switch, may never come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct DebouncedInput {
    is_active: bool,
    count: u16,
    /// Counter at which the contact is active: ticks of a change without bounces.
    top: u16,
}

impl DebouncedInput {
    /// Clear contact, which is active in the tick `debounce_ticks` of those that tell so; at least the first.
    pub(crate) fn new(debounce_ticks: u16) -> Self {
        Self {
            is_active: false,
            count: 0,
            top: debounce_ticks.max(1),
        }
    }

    /// Takes what the contact tells in this tick. Returns true if it has changed with that.
    #[inline]
    pub(crate) fn read(&mut self, is_active: bool) -> bool {
        self.count = match is_active {
            true => self.count.saturating_add(1).min(self.top),
            false => self.count.saturating_sub(1),
        };
        let end = match self.is_active {
            true => 0,
            false => self.top,
        };
        let changes = self.count == end;
        self.is_active ^= changes;
        changes
    }

    #[inline(always)]
    pub(crate) fn is_active(&self) -> bool {
        self.is_active
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_change_counts_in_the_last_tick_of_the_debounce_time() {
        for ticks in [1, 2, 5, u16::MAX] {
            let mut contact = DebouncedInput::new(ticks);
            for wanted in [true, false, true] {
                for tick in 1..=ticks {
                    assert_eq!(contact.read(wanted), tick == ticks, "{tick} of {ticks}");
                    assert_eq!(contact.is_active(), wanted == (tick == ticks));
                }
                assert!(!contact.read(wanted));
            }
        }
    }

    #[test]
    fn a_spike_does_not_count_and_a_wire_that_chatters_does() {
        let mut contact = DebouncedInput::new(3);
        for told in [true, true, false, false, true, false, false, false] {
            assert!(!contact.read(told));
            assert!(!contact.is_active());
        }
        // Never three in a row.
        let chatter = [true, true, false, true];
        let changes = chatter.map(|told| contact.read(told));
        assert_eq!(changes, [false, false, false, false]);
        assert!(contact.read(true), "two of three ticks are active");
    }
}
