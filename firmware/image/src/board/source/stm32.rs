//! Pins of an STM32 as types of its package.

use super::{declare, fields};
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

/// The line's interrupt: that at the end of the receiver's stream.
fn line_interrupt(board: &BoardFile, has_hal: bool) -> String {
    match board.line.and_then(|port| port.dma.as_ref()) {
        Some(dma) => {
            let stream = if has_hal { "STREAM" } else { "CHANNEL" };
            format!("DMA{}_{stream}{}", dma.controller, dma.streams[0])
        }
        // Over USB there is none: that of the log's port is never switched on.
        None => board.log.name.to_uppercase(),
    }
}

/// The line's DMA. Over USB there is none.
fn line_dma(port: Option<&SerialPort>, has_hal: bool) -> String {
    let Some(dma) = port.and_then(|port| port.dma.as_ref()) else {
        return String::new();
    };
    let (controller, [receive, transmit]) = (dma.controller, dma.streams);
    let mut text = match has_hal {
        true => format!("pub(crate) type LineController = stm32f4xx_hal::pac::DMA{controller};\n"),
        false => format!(
            "pub(crate) const LINE_CONTROLLER: stm32_metapac::bdma::Dma = stm32_metapac::DMA{controller};\n"
        ),
    };
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

/// The port of an STM32F405 on APB2, which is twice as fast as the bus of the others.
fn is_on_fast_bus(port: &SerialPort) -> bool {
    matches!(port.name, "usart1" | "usart6")
}

pub(super) fn source(board: &BoardFile, needs: &Needs) -> String {
    let has_hal = board.chip.family == Family::Stm32f405;
    let fields = fields(board, needs);
    let declared = declare(
        &fields,
        |pin| format!("Pin<'{}', {}>", port(pin), pin.place.1),
        |pin| {
            let letter = port(pin).to_ascii_lowercase();
            match has_hal {
                true => format!("{letter}.p{letter}{}", pin.place.1),
                false => "Pin::of_its_port()".into(),
            }
        },
    );
    let log = board.log.name.to_uppercase();
    let line = board.line.map(|port| port.name.to_uppercase());
    let mut text = format!(
        "use crate::gpio::Pin;\n\
         use crate::parts::Rcc;\n\
         pub(crate) const PLL: crate::clock::Pll = crate::clock::Pll {{ divider: {}, factor: {} }};\n\
         line_interrupt!({}, {});\n",
        board.pll.divider,
        board.pll.factor,
        line_interrupt(board, has_hal),
        board.chip.usb.interrupt,
    );
    text += &line_dma(board.line, has_hal);
    text += &match has_hal {
        true => format!(
            "use stm32f4xx_hal::gpio::GpioExt as _;\n\
             pub(crate) type LogPort = stm32f4xx_hal::pac::{log};\n\
             pub(crate) const LOG_IS_ON_APB2: bool = {};\n",
            is_on_fast_bus(board.log),
        ),
        // Every port has the same type there, and the same clock.
        false => "pub(crate) type LogPort = stm32_metapac::usart::Usart;\n".into(),
    };
    if let (Some(port), Some(line)) = (board.line, &line) {
        text += &match has_hal {
            true => format!(
                "pub(crate) type LinePort = stm32f4xx_hal::pac::{line};\n\
                 pub(crate) const LINE_IS_ON_APB2: bool = {};\n",
                is_on_fast_bus(port),
            ),
            false => "pub(crate) type LinePort = LogPort;\n".into(),
        };
    }
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
    let line_field = match line {
        Some(_) => "    pub(crate) line: LinePort,\n",
        None => "",
    };
    text += &format!(
        "pub(crate) struct Pins {{\n{}{line_field}    pub(crate) log: LogPort,\n}}\n\nimpl Pins {{\n    pub(crate) fn take(ports: Ports, rcc: &mut Rcc) -> Self {{\n",
        declared.fields
    );
    // Only these ports are switched on.
    let ports = fields.iter().filter_map(|field| field.pin).map(port);
    for port in ports.collect::<BTreeSet<char>>() {
        text += &match has_hal {
            true => {
                let port = port.to_ascii_lowercase();
                format!("        let {port} = ports.{port}.split(rcc);\n")
            }
            false => format!("        ports.switch_on('{port}', rcc);\n"),
        };
    }
    let value = |port: &SerialPort| match has_hal {
        true => format!("ports.{}", port.name),
        false => format!("stm32_metapac::{}", port.name.to_uppercase()),
    };
    text += &format!("        Self {{\n{}", declared.values);
    if let Some(port) = board.line {
        text += &format!("            line: {},\n", value(port));
    }
    text += &format!("            log: {},\n", value(board.log));
    text + "        }\n    }\n}\n"
}
