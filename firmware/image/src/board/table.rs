//! Pins of a board as a table of a document.

use super::file::{BoardFile, WiredPin};
use super::role::{ROLES, Role};

/// Rows of the pins in Markdown, with their functions and what is at the other end of the wire.
pub fn table(board: &BoardFile) -> String {
    let mut text =
        String::from("| pin | function | key | direction | to |\n|---|---|---|---|---|\n");
    for entry in &ROLES {
        let Some(pins) = board.pins(entry.role) else {
            continue;
        };
        let names: Vec<String> = pins.iter().map(in_words).collect();
        let direction = match entry.is_output {
            true => "out",
            false => "in",
        };
        text += &format!(
            "| {} | {}{} | `{}` | {direction} | {} |\n",
            names.join(", "),
            entry.function,
            peripherals(board, entry.role),
            entry.role.path(),
            entry.other_end,
        );
    }
    for (pin, what) in &board.taken {
        text += &format!("| {pin} | taken by the board: {what} | `taken.{pin}` | | |\n");
    }
    text
}

fn in_words(pin: &WiredPin) -> String {
    match pin.inverted {
        true => format!("{}, inverted", pin.name),
        false => pin.name.clone(),
    }
}

/// The peripherals of a role's pins, in brackets.
fn peripherals(board: &BoardFile, role: Role) -> String {
    let port = match role {
        Role::LineTransmit | Role::LineReceive => board.line.map(|port| port.name),
        Role::LogTransmit => Some(board.log.name),
        _ => None,
    };
    let mut names: Vec<String> = port.map(str::to_uppercase).into_iter().collect();
    let pins = board.pins(role).unwrap_or_default();
    let signals = (0..pins.len()).filter_map(|index| board.chip.signal(role, index));
    names.extend(signals.map(|signal| signal.name.to_owned()));
    match names.is_empty() {
        true => String::new(),
        false => format!(" ({})", names.join(", ")),
    }
}
