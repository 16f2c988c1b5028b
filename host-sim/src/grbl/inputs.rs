//! Spare inputs that the program of a sender waits for.

use trirrr_grbl::InputsView;
use trirrr_protocol::message::DigitalStates;

/// Levels of the inputs, and how they have changed since the program looked.
#[derive(Default)]
pub(super) struct ProgramInputs {
    /// Newest states that the machine has told.
    states: Option<DigitalStates>,
    risen: u8,
    fallen: u8,
}

impl ProgramInputs {
    /// Takes the states that the machine has now.
    pub(super) fn take_status(&mut self, states: DigitalStates) {
        let before = self.states.replace(states).unwrap_or(states).inputs;
        self.risen |= states.inputs & !before;
        self.fallen |= before & !states.inputs;
    }

    /// Takes the states of an event, which may have been under way for longer than those that are known.
    pub(super) fn take_event(&mut self, states: DigitalStates) {
        let is_old = |known: DigitalStates| (states.tick.wrapping_sub(known.tick) as i32) < 0;
        if !self.states.is_some_and(is_old) {
            self.take_status(states);
        }
    }

    /// Returns the levels and the changes since the view before.
    pub(super) fn view(&mut self) -> Option<InputsView> {
        let (risen, fallen) = (
            std::mem::take(&mut self.risen),
            std::mem::take(&mut self.fallen),
        );
        self.states.map(|states| InputsView {
            on: states.inputs,
            risen,
            fallen,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn states(inputs: u8, tick: u32) -> DigitalStates {
        DigitalStates {
            inputs,
            outputs: 0,
            tick,
        }
    }

    #[test]
    fn changes_are_seen_once_and_those_of_before_are_none() {
        let mut inputs = ProgramInputs::default();
        assert_eq!(inputs.view(), None);
        // An input that is on from the beginning has not gone on.
        inputs.take_status(states(0b01, 0));
        let view = |on, risen, fallen| Some(InputsView { on, risen, fallen });
        assert_eq!(inputs.view(), view(0b01, 0, 0));
        // A pulse between two views.
        inputs.take_event(states(0b11, 8));
        inputs.take_event(states(0b01, 9));
        assert_eq!(inputs.view(), view(0b01, 0b10, 0b10));
        assert_eq!(inputs.view(), view(0b01, 0, 0));
        inputs.take_status(states(0b00, 20));
        // An event that a status has overtaken.
        inputs.take_event(states(0b01, 19));
        assert_eq!(inputs.view(), view(0b00, 0, 0b01));
        // A board that has started anew counts from 0.
        inputs.take_status(states(0b10, 3));
        assert_eq!(inputs.view(), view(0b10, 0b10, 0));
    }
}
