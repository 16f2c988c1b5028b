//! Limit switches of the motors.

use super::debounce::StopContact;

/// Switches beyond which the motors may not go, one for each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct LimitSwitches {
    contacts: [StopContact; 3],
    /// Motors that stand on their switches, and for which a fault was latched or none was due. A switch that opens is due again.
    heeded: [bool; 3],
}

impl LimitSwitches {
    pub(super) fn new(debounce_ticks: u16) -> Self {
        Self {
            contacts: [StopContact::new(debounce_ticks); 3],
            heeded: [false; 3],
        }
    }

    /// Takes the readings of a tick. Returns true if a switch has changed.
    #[inline]
    pub(super) fn read(&mut self, readings: [bool; 3]) -> bool {
        let mut changes = false;
        for (contact, reading) in self.contacts.iter_mut().zip(readings) {
            // All are read in each tick: no shortcut.
            changes |= contact.read(reading);
        }
        changes
    }

    /// Returns the motor that has come onto its switch. Where switches are not `watched`, those that motors stand on count as known.
    #[inline]
    pub(super) fn take_new(&mut self, watched: bool) -> Option<u8> {
        let mut new = None;
        for (motor, (contact, heeded)) in (0..).zip(self.contacts.iter().zip(&mut self.heeded)) {
            let is_active = contact.is_active();
            if watched && is_active && !*heeded && new.is_none() {
                new = Some(motor);
            }
            *heeded = is_active;
        }
        new
    }

    /// Returns the states, true on a switch.
    #[inline]
    pub(super) fn states(&self) -> [bool; 3] {
        self.contacts.map(|contact| contact.is_active())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_motor_is_new_on_its_switch_once_until_it_has_left() {
        let mut switches = LimitSwitches::new(1);
        let mut tick = |readings, watched| {
            switches.read(readings);
            switches.take_new(watched)
        };
        assert_eq!(tick([false, true, true], true), Some(1));
        assert_eq!(tick([false, true, true], true), None);
        assert_eq!(tick([true, false, true], true), Some(0));
        assert_eq!(tick([true, true, true], false), None);
        assert_eq!(tick([true, true, true], true), None);
        assert_eq!(tick([false, false, true], true), None);
        assert_eq!(tick([false, true, true], true), Some(1));
    }
}
