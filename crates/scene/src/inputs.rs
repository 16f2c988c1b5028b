//! `[inputs]`: emergency stop, door, probe and limit switches of a board.

use crate::homing::PlacedHoming;
use crate::read::{Bound, Section};
use trirrr_service::StopCategory;
use trirrr_service::features::{
    ButtonInput, Contact, Door, EmergencyStop, InterlockParameters, LimitInputs, ProbeInput,
};

/// Longest time for which a contact may bounce, s.
const DEBOUNCE_MAX_S: f64 = 0.1;

/// The same of a button where the scene gives none, and the least: a bounce is no second press, s.
const BUTTON_S: f64 = 0.02;
const BUTTON_MIN_S: f64 = 0.01;

/// Debounce time where the scene gives none, s.
const DEBOUNCE_S: f64 = 0.005;

/// Contacts to ground: of a person who stops the machine, of a probe, of limit switches. Each is pulled up by the board.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct InputPorts {
    /// Settings of the contacts, in ticks.
    pub interlocks: InterlockParameters,
    /// Position of the door's contact while the door is closed.
    pub door_normally: NormalContact,
    /// Position of the probe's contact while the probe touches nothing.
    pub probe_normally: NormalContact,
    /// Position of the limit switches while the motors are within their range.
    pub limits_normally: NormalContact,
    /// The limit switches are those of homing, at its pins.
    pub limits_share_homing: bool,
    /// Button that begins the job of a board without a host.
    pub button: Option<ButtonInput>,
}

/// Position of a contact while its input is clear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NormalContact {
    /// Closed: its input is low, and high where the wire breaks.
    #[default]
    Closed,
    /// Open: its input is high.
    Open,
}

impl InputPorts {
    /// Returns true if there are limit switches with pins of their own.
    pub fn has_limit_pins(&self) -> bool {
        self.interlocks.limits.is_some() && !self.limits_share_homing
    }

    /// Returns true if there is any contact, that of a button included.
    pub fn have_contacts(&self) -> bool {
        self.are_named() || self.button.is_some()
    }

    /// Returns true if there is any interlock.
    pub fn are_named(&self) -> bool {
        let InterlockParameters {
            emergency_stop,
            door,
            probe,
            limits,
        } = &self.interlocks;
        emergency_stop.is_some() || door.is_some() || probe.is_some() || limits.is_some()
    }
}

/// Inputs that a scene may name.
const NAMES: [&str; 5] = ["estop", "door", "probe", "limits", "button"];

/// Reads `[inputs]`; none without the table. Without a tick rate, no time is checked in ticks. `homing`: none where it was refused.
pub(crate) fn read_inputs(
    root: &Section,
    rate: Option<f64>,
    homing: Option<&Option<PlacedHoming>>,
) -> Option<InputPorts> {
    if !root.has("inputs") {
        return Some(InputPorts::default());
    }
    let section = root.section("inputs")?;
    if !NAMES.iter().any(|name| section.has(name)) {
        root.refuse(
            "inputs",
            "names no input: give [inputs.estop], [inputs.door], [inputs.probe], [inputs.limits] or [inputs.button], or leave [inputs] out",
        );
        return None;
    }
    let stop = read_one(&section, "estop", |section| read_stop(section, rate));
    let door = read_one(&section, "door", |section| read_door(section, rate));
    let probe = read_one(&section, "probe", |section| read_probe(section, rate));
    let has_switches = homing.is_none_or(|homing| {
        let contact = homing.as_ref().map(|placed| placed.homing.contact);
        contact == Some(Contact::Switch)
    });
    let limits = read_one(&section, "limits", |section| {
        read_limits(section, rate, has_switches)
    });
    let button = read_one(&section, "button", |section| read_button(section, rate));
    let (stop, door, probe, limits, button) = (stop?, door?, probe?, limits?, button?);
    Some(InputPorts {
        interlocks: InterlockParameters {
            emergency_stop: stop,
            door: door.map(|(door, _)| door),
            probe: probe.map(|(probe, _)| probe),
            limits: limits.map(|(limits, ..)| limits),
        },
        door_normally: door.map(|(_, normally)| normally).unwrap_or_default(),
        probe_normally: probe.map(|(_, normally)| normally).unwrap_or_default(),
        limits_normally: limits.map(|(_, normally, _)| normally).unwrap_or_default(),
        limits_share_homing: limits.is_some_and(|(.., shares)| shares),
        button,
    })
}

/// Reads the table of one input, if there is one.
fn read_one<'d, 't, T>(
    section: &Section<'d, 't>,
    name: &'d str,
    read: impl FnOnce(&Section<'d, 't>) -> Option<T>,
) -> Option<Option<T>> {
    match section.has(name) {
        true => read(&section.section(name)?).map(Some),
        false => Some(None),
    }
}

fn read_stop(section: &Section, rate: Option<f64>) -> Option<EmergencyStop> {
    let category = match section.has("stop_category") {
        // Category 2 keeps the drives on: it is no emergency stop.
        true => section.integer("stop_category", 0, 1),
        false => Some(0),
    };
    let debounce = read_contact_ticks(section, rate);
    let normally = read_normal_contact(section);
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
    let debounce = read_contact_ticks(section, rate);
    let normally = read_normal_contact(section);
    let door = Door {
        debounce_ticks: debounce?,
    };
    Some((door, normally?))
}

/// Reads a button. One that closes begins nothing once its wire is broken.
fn read_button(section: &Section, rate: Option<f64>) -> Option<ButtonInput> {
    let bound = Bound::Within(BUTTON_MIN_S, DEBOUNCE_MAX_S);
    let seconds = section.number_or("debounce_s", bound, BUTTON_S);
    // A tick alone may be noise.
    let debounce = seconds
        .zip(rate)
        .map(|(seconds, rate)| contact_ticks(seconds, rate).max(2));
    let normally = match section.has("normally") {
        true => read_normal_contact(section),
        false => Some(NormalContact::Open),
    };
    if normally? == NormalContact::Closed {
        section.refuse(
            "normally",
            "must be \"open\": a contact that opens would begin the job once its wire is broken",
        );
        return None;
    }
    Some(ButtonInput {
        debounce_ticks: debounce?,
    })
}

/// Reads a probe. Most are open until they touch.
fn read_probe(section: &Section, rate: Option<f64>) -> Option<(ProbeInput, NormalContact)> {
    let debounce = read_contact_ticks(section, rate);
    let normally = match section.has("normally") {
        true => read_normal_contact(section),
        false => Some(NormalContact::Open),
    };
    let probe = ProbeInput {
        debounce_ticks: debounce?,
    };
    Some((probe, normally?))
}

/// Reads limit switches: with contacts and pins of their own, or those of homing.
fn read_limits(
    section: &Section,
    rate: Option<f64>,
    has_switches: bool,
) -> Option<(LimitInputs, NormalContact, bool)> {
    let debounce = read_contact_ticks(section, rate);
    let shares = match section.has("share_homing") {
        true => section.boolean("share_homing"),
        false => Some(false),
    };
    let normally = read_normal_contact(section);
    let shares = shares?;
    if shares && !has_switches {
        section.refuse(
            "share_homing",
            "needs [homing] to switches: without it the board reads none",
        );
        return None;
    }
    if shares && section.has("normally") {
        section.refuse(
            "normally",
            "belongs to limit switches of their own: those of homing are as [homing] says",
        );
        return None;
    }
    let limits = LimitInputs {
        debounce_ticks: debounce?,
    };
    Some((limits, normally?, shares))
}

/// Reads `normally`; closed where it is left out.
pub(crate) fn read_normal_contact(section: &Section) -> Option<NormalContact> {
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
pub(crate) fn read_contact_ticks(section: &Section, rate: Option<f64>) -> Option<u16> {
    let bound = Bound::Within(0.0, DEBOUNCE_MAX_S);
    let seconds = section.number_or("debounce_s", bound, DEBOUNCE_S)?;
    Some(contact_ticks(seconds, rate?))
}

fn contact_ticks(seconds: f64, rate: f64) -> u16 {
    // At most 10,000: 0.1 s at 100 kHz. A product just below a whole number is that number.
    (seconds * rate + 1e-6).floor().max(1.0) as u16
}
