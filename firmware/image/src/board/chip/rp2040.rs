//! RP2040: functions of the pins of Raspberry Pi's data sheet, sections 1.4.3 and 4.5.2, as far as the firmware uses them.

use super::{Chip, Family, SerialPort, Signal, Usb};
use crate::board::role::Role;

const ALL: &[u8] = &[
    0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23, 24, 25,
    26, 27, 28, 29,
];

/// 56 pins, of which 30 are for functions.
pub(super) const RP2040: Chip = Chip {
    name: "rp2040",
    family: Family::Rp2040,
    ports: &[("GP", ALL)],
    withheld: &[],
    serial_ports: &[
        SerialPort {
            name: "uart0",
            transmit: &["GP0", "GP12", "GP16", "GP28"],
            receive: &["GP1", "GP13", "GP17", "GP29"],
            dma: None,
        },
        SerialPort {
            name: "uart1",
            transmit: &["GP4", "GP8", "GP20", "GP24"],
            receive: &["GP5", "GP9", "GP21", "GP25"],
            dma: None,
        },
    ],
    usb: Usb {
        interrupt: "USBCTRL_IRQ",
        pins: &[],
    },
    // Slice 7, of GP14 and GP15, calls the slots of steppers.
    signals: &[Signal {
        role: Role::Tool,
        index: 0,
        name: "channel A of a PWM slice",
        pins: &[
            "GP0", "GP2", "GP4", "GP6", "GP8", "GP10", "GP12", "GP16", "GP18", "GP20", "GP22",
            "GP24", "GP26", "GP28",
        ],
    }],
    without: &[
        (
            "amplifier",
            "the firmware for the RP2040 drives steppers or nothing",
        ),
        ("can", "the RP2040 has no CAN controller"),
    ],
};
