//! `[inputs]`: emergency stop and door of a board.

use crate::read::{Bound, Section};
use trirrr_service::{Door, EmergencyStop, InterlockParameters, StopCategory};

/// Longest time for which a contact may bounce, s.
const DEBOUNCE_MAX_S: f64 = 0.1;

/// Debounce time where the scene gives none, s.
const DEBOUNCE_S: f64 = 0.005;

/// Contacts to ground by which a person stops the machine. Each is pulled up by the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputPorts {
    /// Settings of the contacts, in ticks.
    pub interlocks: InterlockParameters,
    /// Position of the door's contact while the door is closed.
    pub door_normally: NormalContact,
}

/// Position of a contact while the machine may move.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalContact {
    /// Closed: its input is low, and high where the wire breaks.
    #[default]
    Closed,
    /// Open: its input is high.
    Open,
}

impl InputPorts {
    /// Returns true if there is any.
    pub fn are_named(&self) -> bool {
        self.interlocks.emergency_stop.is_some() || self.interlocks.door.is_some()
    }
}

/// Reads `[inputs]`; none without the table. Without a tick rate, no time is checked in ticks.
pub(crate) fn read_inputs(root: &Section, rate: Option<f64>) -> Option<InputPorts> {
    if !root.has("inputs") {
        return Some(InputPorts::default());
    }
    let section = root.section("inputs")?;
    if !section.has("estop") && !section.has("door") {
        root.refuse(
            "inputs",
            "names no input: give [inputs.estop], [inputs.door] or both, or leave [inputs] out",
        );
        return None;
    }
    let stop = match section.has("estop") {
        true => read_stop(&section.section("estop")?, rate).map(Some),
        false => Some(None),
    };
    let door = match section.has("door") {
        true => read_door(&section.section("door")?, rate).map(Some),
        false => Some(None),
    };
    let (stop, door) = (stop?, door?);
    Some(InputPorts {
        interlocks: InterlockParameters {
            emergency_stop: stop,
            door: door.map(|(door, _)| door),
        },
        door_normally: door.map(|(_, normally)| normally).unwrap_or_default(),
    })
}

fn read_stop(section: &Section, rate: Option<f64>) -> Option<EmergencyStop> {
    let category = match section.has("stop_category") {
        // Category 2 keeps the drives on: it is no emergency stop.
        true => section.integer("stop_category", 0, 1),
        false => Some(0),
    };
    let debounce = read_debounce(section, rate);
    let normally = read_normally(section);
    if normally? == NormalContact::Open {
        section.refuse(
            "normally",
            "must be \"closed\": a contact that closes does not stop the machine once its wire is broken",
        );
        return None;
    }
    Some(EmergencyStop {
        debounce_ticks: debounce?,
        category: match category? {
            0 => StopCategory::Off,
            _ => StopCategory::StopThenOff,
        },
    })
}

fn read_door(section: &Section, rate: Option<f64>) -> Option<(Door, NormalContact)> {
    let debounce = read_debounce(section, rate);
    let normally = read_normally(section);
    let door = Door {
        debounce_ticks: debounce?,
    };
    Some((door, normally?))
}

fn read_normally(section: &Section) -> Option<NormalContact> {
    let choices = [
        ("closed", NormalContact::Closed),
        ("open", NormalContact::Open),
    ];
    match section.has("normally") {
        true => section.choice("normally", &choices),
        false => Some(NormalContact::Closed),
    }
}

/// Ticks within the debounce time, the first in which the contact tells something new included: none later, and one at least.
fn read_debounce(section: &Section, rate: Option<f64>) -> Option<u16> {
    let bound = Bound::Within(0.0, DEBOUNCE_MAX_S);
    let seconds = section.number_or("debounce_s", bound, DEBOUNCE_S)?;
    // At most 10,000: 0.1 s at 100 kHz. A product just below a whole number is that number.
    Some((seconds * rate? + 1e-6).floor().max(1.0) as u16)
}
