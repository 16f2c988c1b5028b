//! STM32F405: alternate functions of ST's data sheet DS8626, table 9, as far as the firmware uses them.

use super::{Chip, Family, SerialDma, SerialPort, Signal, Usb};
use crate::board::role::Role;

pub(super) const ALL: &[u8] = &[0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15];

pub(super) const SWD: &str = "is the debug port, by which the chip is flashed";
pub(super) const JTAG: &str =
    "is pulled up or down by the chip in a reset, for JTAG: an output is not off then";
pub(super) const BACKUP: &str =
    "is supplied by the backup switch: it carries 3 mA, and no fast edges";

pub(super) const USB_PINS: &[&str] = &["PA11", "PA12"];

const WITHHELD: &[(&str, &str)] = &[
    ("PA13", SWD),
    ("PA14", SWD),
    ("PA15", JTAG),
    ("PB3", JTAG),
    ("PB4", JTAG),
    ("PC13", BACKUP),
    ("PC14", BACKUP),
    ("PC15", BACKUP),
];

/// The ports whose registers are alike. UART4 and UART5 have others. Streams and channels of the DMA are those of RM0090, tables 42 and 43.
const SERIAL_PORTS: &[SerialPort] = &[
    SerialPort {
        name: "usart1",
        transmit: &["PA9", "PB6"],
        receive: &["PA10", "PB7"],
        dma: SerialDma::of(2, [2, 7], [4, 4]),
    },
    SerialPort {
        name: "usart2",
        transmit: &["PA2", "PD5"],
        receive: &["PA3", "PD6"],
        dma: SerialDma::of(1, [5, 6], [4, 4]),
    },
    SerialPort {
        name: "usart3",
        transmit: &["PB10", "PC10", "PD8"],
        receive: &["PB11", "PC11", "PD9"],
        dma: SerialDma::of(1, [1, 3], [4, 4]),
    },
    SerialPort {
        name: "usart6",
        transmit: &["PC6"],
        receive: &["PC7"],
        dma: SerialDma::of(2, [1, 6], [5, 5]),
    },
];

pub(super) const fn signal(
    role: Role,
    index: usize,
    name: &'static str,
    pins: &'static [&'static str],
) -> Signal {
    Signal {
        role,
        index,
        name,
        pins,
    }
}

const SIGNALS: &[Signal] = &[
    signal(Role::SetValue, 0, "TIM3 CH1", &["PA6", "PB4", "PC6"]),
    signal(Role::SetValue, 1, "TIM3 CH2", &["PA7", "PB5", "PC7"]),
    signal(Role::SetValue, 2, "TIM3 CH3", &["PB0", "PC8"]),
    signal(Role::EncoderA, 0, "TIM1 CH1", &["PA8", "PE9"]),
    signal(Role::EncoderB, 0, "TIM1 CH2", &["PA9", "PE11"]),
    signal(Role::EncoderA, 1, "TIM4 CH1", &["PB6", "PD12"]),
    signal(Role::EncoderB, 1, "TIM4 CH2", &["PB7", "PD13"]),
    signal(Role::EncoderA, 2, "TIM5 CH1", &["PA0"]),
    signal(Role::EncoderB, 2, "TIM5 CH2", &["PA1"]),
    signal(Role::CanReceive, 0, "CAN1 RX", &["PA11", "PB8", "PD0"]),
    signal(Role::CanTransmit, 0, "CAN1 TX", &["PA12", "PB9", "PD1"]),
    signal(Role::Tool, 0, "TIM2 CH1", &["PA0", "PA5", "PA15"]),
];

/// 64 pins.
pub(super) const STM32F405RG: Chip = Chip {
    name: "stm32f405rg",
    family: Family::Stm32f405,
    // PH0 and PH1 are the crystal's.
    ports: &[("PA", ALL), ("PB", ALL), ("PC", ALL), ("PD", &[2])],
    withheld: WITHHELD,
    serial_ports: SERIAL_PORTS,
    usb: Usb {
        interrupt: "OTG_FS",
        pins: USB_PINS,
    },
    signals: SIGNALS,
    without: &[],
};

/// 100 pins. Larger packages have ports that a failure of the firmware would not switch off.
pub(super) const STM32F405VG: Chip = Chip {
    name: "stm32f405vg",
    ports: &[
        ("PA", ALL),
        ("PB", ALL),
        ("PC", ALL),
        ("PD", ALL),
        ("PE", ALL),
    ],
    ..STM32F405RG
};
