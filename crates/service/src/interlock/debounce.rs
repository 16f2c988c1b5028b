//! One contact, its bounces taken out.

/// Contact of which neither state is the safe one, with a counter: up in a tick that tells active, down in any other. The contact is
/// active once the counter is at its top, and clear once it is at 0. Readings in a row, as [homing](crate::homing) takes them for the
/// time of a switch, may never come.
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

    /// Active contact, which has to be clear before it can become active.
    pub(crate) fn active(debounce_ticks: u16) -> Self {
        let clear = Self::new(debounce_ticks);
        Self {
            is_active: true,
            count: clear.top,
            ..clear
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

/// Debounce times for which a contact has to be clear without a break before its earlier active ticks are forgotten.
const STEADY: u16 = 10;

/// Contact that stops the machine, for which active is the safe state. Every tick that tells active counts, however many clear
/// ones are between: a wire that chatters is a wire that is broken. The count is forgotten once the contact was clear for ten
/// debounce times without a break. Active, the contact is clear again after one debounce time of clear ticks in a row.
///
/// With a debounce time of n ticks, a contact that is active in at least one of 10 n ticks is active after at most 10 n^2 ticks;
/// one that is active half of the time, after 2 n.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct StopContact {
    is_active: bool,
    /// Active ticks that are not forgotten.
    active: u16,
    /// Clear ticks in a row.
    clear: u16,
    debounce_ticks: u16,
}

impl StopContact {
    /// Clear contact, which is active in the tick `debounce_ticks` of those that tell so; at least the first.
    pub(crate) fn new(debounce_ticks: u16) -> Self {
        Self {
            is_active: false,
            active: 0,
            clear: 0,
            debounce_ticks: debounce_ticks.max(1),
        }
    }

    /// Takes what the contact tells in this tick. Returns true if it has changed with that.
    #[inline]
    pub(crate) fn read(&mut self, is_active: bool) -> bool {
        let ticks = self.debounce_ticks;
        match is_active {
            true => (self.active, self.clear) = (self.active.saturating_add(1), 0),
            false => self.clear = self.clear.saturating_add(1),
        }
        if !self.is_active && self.clear >= ticks.saturating_mul(STEADY) {
            self.active = 0;
        }
        let changes = match self.is_active {
            true => self.clear >= ticks,
            false => self.active >= ticks,
        };
        if changes {
            (self.active, self.clear) = (0, 0);
            self.is_active ^= true;
        }
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
            let mut input = DebouncedInput::new(ticks);
            let mut stop = StopContact::new(ticks);
            for wanted in [true, false, true] {
                for tick in 1..=ticks {
                    assert_eq!(input.read(wanted), tick == ticks, "{tick} of {ticks}");
                    assert_eq!(input.is_active(), wanted == (tick == ticks));
                    assert_eq!(stop.read(wanted), tick == ticks, "{tick} of {ticks}");
                    assert_eq!(stop.is_active(), wanted == (tick == ticks));
                }
                assert!(!input.read(wanted) && !stop.read(wanted));
            }
        }
    }

    #[test]
    fn a_spike_of_an_input_does_not_count_and_most_of_the_time_does() {
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

    /// Every chatter with a break below the steady time, however short its active part.
    #[test]
    fn a_contact_that_chatters_stops_within_its_bound() {
        for ticks in [1, 2, 5, 20] {
            for open in 1..=2 * ticks {
                for closed in 1..ticks * STEADY {
                    let mut contact = StopContact::new(ticks);
                    let told = |tick: u32| tick % u32::from(open + closed) < u32::from(open);
                    let within = (0..).position(|tick| contact.read(told(tick))).unwrap() + 1;
                    // All active ticks but the last part, each part with its break.
                    let parts = usize::from(ticks.div_ceil(open)) - 1;
                    assert_eq!(within, usize::from(ticks) + parts * usize::from(closed));
                    assert!(within <= usize::from(STEADY * ticks * ticks));
                    if open == closed {
                        assert!(within <= 2 * usize::from(ticks), "{open} of {ticks}");
                    }
                }
            }
        }
    }

    #[test]
    fn spikes_of_a_steady_contact_are_forgotten_one_by_one() {
        for ticks in [2, 5] {
            let mut contact = StopContact::new(ticks);
            for _ in 0..100 {
                for _ in 1..ticks {
                    assert!(!contact.read(true));
                }
                for _ in 0..ticks * STEADY {
                    assert!(!contact.read(false));
                }
            }
        }
    }

    #[test]
    fn a_contact_is_clear_only_once_it_is_steady() {
        let mut contact = StopContact::new(3);
        for _ in 0..3 {
            contact.read(true);
        }
        for _ in 0..100 {
            assert!(
                ![false, false, true]
                    .map(|told| contact.read(told))
                    .contains(&true)
            );
        }
        assert_eq!(
            [false; 3].map(|told| contact.read(told)),
            [false, false, true]
        );
        // Earlier active ticks count no more.
        assert_eq!(
            [true; 3].map(|told| contact.read(told)),
            [false, false, true]
        );
    }
}
