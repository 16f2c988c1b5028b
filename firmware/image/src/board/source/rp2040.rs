//! Pins of an RP2040 as types of its package.

use super::{declare, fields, line_entry};
use crate::board::file::BoardFile;
use crate::board::needs::Needs;
use crate::board::role::Role;

pub(super) fn source(board: &BoardFile, needs: &Needs) -> String {
    let fields = fields(board, needs);
    let declared = declare(
        &fields,
        |pin| format!("Direct<Gpio{}>", pin.place.1),
        |pin| format!("Direct(pins.gpio{})", pin.place.1),
    );
    let log = board.log.name.to_uppercase();
    let line = board.line.map(|port| port.name.to_uppercase());
    // Without a port for the line, that of the log: its interrupt is never switched on there.
    let port = line.as_ref().unwrap_or(&log);
    let usb = board.chip.usb.interrupt;
    let mut text = format!(
        "use rp2040_hal::gpio::bank0::*;\n\
         use rp2040_hal::gpio;\n\
         use rp2040_hal::pwm::{{FreeRunning, Pwm7, Slice, Slices}};\n\
         pub(crate) const CRYSTAL_MHZ: u8 = {};\n\
         pub(crate) type LogPort = rp2040_hal::pac::{log};\n\
         line_interrupt!({port}_IRQ, {usb});\n",
        // Whole, as the clock asks for.
        board.crystal_mhz as u8,
    );
    text += &line_entry(board, needs, &format!("{port}_IRQ"));
    text += &match line {
        Some(line) => format!("pub(crate) type LinePort = rp2040_hal::pac::{line};\n"),
        None => "pub(crate) type LinePort = crate::pins::UsbPort;\n".into(),
    };
    // Two pins have a slice: 0 and 1 slice 0, and again 16 and 17.
    let tool = board.pins(Role::Tool).and_then(<[_]>::first);
    let slice = tool
        .filter(|_| needs.has_tool())
        .map(|pin| pin.place.1 / 2 % 8);
    text += &match slice {
        Some(slice) => format!(
            "pub(crate) type ToolPwm = rp2040_hal::pwm::Pwm{slice};\n\
             pub(crate) type ToolSlice = Slice<ToolPwm, FreeRunning>;\n"
        ),
        None => "pub(crate) type ToolSlice = NoPin;\n".into(),
    };
    text += &declared.types;
    text += "pub(crate) struct Pins {\n";
    text += &declared.fields;
    // The slice that calls the slots of steppers.
    text += "    pub(crate) slots: Slice<Pwm7, FreeRunning>,\n";
    text += "    pub(crate) tool_slice: ToolSlice,\n    pub(crate) line_port: LinePort,\n    pub(crate) log: LogPort,\n}\n\nimpl Pins {\n    \
             pub(crate) fn take(pins: gpio::Pins, slices: Slices, ports: Ports) -> Self {\n        Self {\n";
    text += &declared.values;
    text += "            slots: slices.pwm7,\n";
    text += &match slice {
        Some(slice) => format!("            tool_slice: slices.pwm{slice},\n"),
        None => "            tool_slice: NoPin,\n".into(),
    };
    let port = board.line.map_or("usb", |port| port.name);
    text += &format!("            line_port: ports.{port},\n");
    text += &format!("            log: ports.{},\n", board.log.name);
    text + "        }\n    }\n}\n"
}
