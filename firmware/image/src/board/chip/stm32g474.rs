//! STM32G474: alternate functions of ST's data sheet DS12288, table 13, as far as the firmware uses them.

use super::stm32f405::{ALL, BACKUP, JTAG, SWD, USB_PINS, signal};
use super::{Chip, Family, SerialDma, SerialPort, Signal, Usb};
use crate::board::role::Role;

const BOOT: &str = "is BOOT0: a level that is high in a reset, as a line at rest is, starts the loader of the chip";
const POWER_DELIVERY: &str = "is pulled down in a reset while PA9 is high, for USB Power Delivery: an output is not off then";

/// Any channel of the DMA takes any request (RM0440, table 91): the line has the first two of DMA1.
const SERIAL_PORTS: &[SerialPort] = &[
    SerialPort {
        name: "usart1",
        transmit: &["PA9", "PB6", "PC4"],
        receive: &["PA10", "PB7", "PC5"],
        dma: SerialDma::of(1, [1, 2], [24, 25]),
    },
    SerialPort {
        name: "usart2",
        transmit: &["PA2", "PA14", "PB3"],
        receive: &["PA3", "PA15", "PB4"],
        dma: SerialDma::of(1, [1, 2], [26, 27]),
    },
    SerialPort {
        name: "usart3",
        transmit: &["PB9", "PB10", "PC10"],
        receive: &["PB8", "PB11", "PC11"],
        dma: SerialDma::of(1, [1, 2], [28, 29]),
    },
];

const SIGNALS: &[Signal] = &[
    signal(Role::CanReceive, 0, "FDCAN1 RX", &["PA11", "PB8"]),
    signal(Role::CanTransmit, 0, "FDCAN1 TX", &["PA12", "PB9"]),
    signal(Role::Tool, 0, "TIM2 CH1", &["PA0", "PA5", "PA15"]),
];

/// 64 pins.
pub(super) const STM32G474RE: Chip = Chip {
    name: "stm32g474re",
    family: Family::Stm32g474,
    // PF0 and PF1 are the crystal's, PG10 is the reset.
    ports: &[("PA", ALL), ("PB", ALL), ("PC", ALL), ("PD", &[2])],
    withheld: &[
        ("PA13", SWD),
        ("PA14", SWD),
        ("PA15", JTAG),
        ("PB3", JTAG),
        ("PB4", JTAG),
        ("PB6", POWER_DELIVERY),
        ("PB8", BOOT),
        ("PC13", BACKUP),
        ("PC14", BACKUP),
        ("PC15", BACKUP),
    ],
    serial_ports: SERIAL_PORTS,
    usb: Usb {
        interrupt: "USB_LP",
        pins: USB_PINS,
    },
    signals: SIGNALS,
    without: &[(
        "amplifier",
        "the firmware for the STM32G474 drives steppers, drives on CAN or nothing",
    )],
};
