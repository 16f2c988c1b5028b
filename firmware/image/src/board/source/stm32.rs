//! Pins of an STM32 as types of its package.

use super::{declare, fields, line_entry};
use crate::board::chip::{Family, SerialPort};
use crate::board::file::{BoardFile, WiredPin};
use crate::board::needs::Needs;
use crate::board::role::Role;
use std::collections::BTreeSet;

/// Pins of three motors that the firmware keeps in an array: role, type of the element, of one port and of several.
const GROUPS: [(Role, &str, [&str; 2]); 3] = [
    (Role::Step, "StepOutput", OUTPUTS),
    (Role::Direction, "DirectionOutput", OUTPUTS),
    (Role::Failure, "FailureInput", INPUTS),
];

const OUTPUTS: [&str; 2] = ["PortOutput", "AnyOutput"];
const INPUTS: [&str; 2] = ["PortInput", "AnyInput"];

/// The letter of a pin's port.
fn port(pin: &WiredPin) -> char {
    pin.place.0.chars().last().unwrap_or_default()
}

/// The line's interrupt: that at the end of the receiver's stream, or channel.
fn line_interrupt(board: &BoardFile) -> String {
    match board.line.and_then(|port| port.dma.as_ref()) {
        Some(dma) => {
            let stream = match board.chip.family {
                Family::Stm32f405 => "STREAM",
                _ => "CHANNEL",
            };
            format!("DMA{}_{stream}{}", dma.controller, dma.streams[0])
        }
        // Over USB there is none: that of the log's port is never switched on.
        None => board.log.name.to_uppercase(),
    }
}

/// A serial port, and the alternate function of its pins: 7, and 8 of those that came later.
fn port_source(name: &str, port: &SerialPort) -> String {
    let function = if port.name == "usart6" { 8 } else { 7 };
    format!(
        "pub(crate) const {name}_PORT: stm32_metapac::usart::Usart = stm32_metapac::{};\n\
         pub(crate) const {name}_FUNCTION: u8 = {function};\n",
        port.name.to_uppercase()
    )
}

/// The line's DMA. Over USB there is none.
fn line_dma(board: &BoardFile) -> String {
    let Some(dma) = board.line.and_then(|port| port.dma.as_ref()) else {
        return String::new();
    };
    let registers = match board.chip.family {
        Family::Stm32f405 => "dma",
        _ => "bdma",
    };
    let (controller, [receive, transmit]) = (dma.controller, dma.streams);
    let mut text = format!(
        "pub(crate) const LINE_CONTROLLER: stm32_metapac::{registers}::Dma = stm32_metapac::DMA{controller};\n"
    );
    for (name, stream, request) in [
        ("RECEIVE", receive, dma.requests[0]),
        ("TRANSMIT", transmit, dma.requests[1]),
    ] {
        text += &format!(
            "pub(crate) const LINE_{name}_STREAM: usize = {stream};\n\
             pub(crate) const LINE_{name}_REQUEST: u8 = {request};\n"
        );
    }
    text
}

pub(super) fn source(board: &BoardFile, needs: &Needs) -> String {
    let fields = fields(board, needs);
    let declared = declare(
        &fields,
        |pin| format!("Pin<'{}', {}>", port(pin), pin.place.1),
        |_| "Pin::of_its_port()".into(),
    );
    let interrupt = line_interrupt(board);
    let mut text = format!(
        "use crate::gpio::Pin;\n\
         pub(crate) const PLL: crate::clock::Pll = crate::clock::Pll {{ divider: {}, factor: {} }};\n\
         line_interrupt!({}, {});\n",
        board.pll.divider, board.pll.factor, interrupt, board.chip.usb.interrupt,
    );
    text += &line_entry(board, needs, &interrupt);
    // The interrupt of the slots has another name there.
    if board.chip.family == Family::Stm32g474 && needs.drive == "stepper" {
        text += "trirrr_boards::entry!(TIM7_DAC, TIM7);\n";
    }
    text += &line_dma(board);
    text += &port_source("LOG", board.log);
    text += &board
        .line
        .map_or_else(String::new, |port| port_source("LINE", port));
    let needed = needs.roles();
    for (role, name, [of_port, of_any]) in GROUPS {
        if let Some(pins) = board.pins(role).filter(|_| needed.contains_key(&role)) {
            let ports: BTreeSet<char> = pins.iter().map(port).collect();
            let is_inverted = pins.iter().any(|pin| pin.inverted);
            let of = match (ports.first(), ports.len(), is_inverted) {
                (Some(port), 1, false) => format!("{of_port}<'{port}'>"),
                _ => of_any.into(),
            };
            text += &format!("pub(crate) type {name} = {of};\n");
        }
    }
    text += &declared.types;
    // Only these ports are switched on.
    let ports = fields.iter().filter_map(|field| field.pin).map(port);
    let ports: String = ports.collect::<BTreeSet<char>>().into_iter().collect();
    text += &format!(
        "pub(crate) struct Pins {{\n{}}}\n\nimpl Pins {{\n    pub(crate) fn take() -> Self {{\n        crate::gpio::switch_on(b\"{ports}\");\n        Self {{\n{}        }}\n    }}\n}}\n",
        declared.fields, declared.values
    );
    text
}
