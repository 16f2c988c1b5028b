//! The boards: their targets and memories.

use crate::elf::Memory;

/// Scenes whose boards play them without a host.
pub(crate) const AUTONOMOUS: [&str; 2] = [
    "scenes/autonomous/thesis-alone.toml",
    "scenes/autonomous/pick-alone.toml",
];

/// The target of the firmware for the STM32F405, which is emulated and measured for every scene.
pub(crate) const FIRMWARE_TARGET: &str = "thumbv7em-none-eabihf";

/// The STM32F405's memory, as in its `regions.x`.
pub(crate) const FIRMWARE_MEMORY: Memory = Memory {
    vectors: 0x0800_0000,
    flash: (0x0800_0000, 1024 * 1024),
    ram: (0x2000_0000, 128 * 1024),
};

/// The STM32G474's memory, as in its `regions.x`.
pub(crate) const G474_MEMORY: Memory = Memory {
    flash: (0x0800_0000, 512 * 1024),
    ..FIRMWARE_MEMORY
};

/// The scene that takes a board with CAN FD.
pub(crate) const G474_SCENE: &str = "scenes/plant-moteus.toml";

/// The target of the firmware for the RP2040.
pub(crate) const RP2040_TARGET: &str = "thumbv6m-none-eabi";

/// The scene that is made for a core like the RP2040's.
pub(crate) const RP2040_SCENE: &str = "scenes/pick-stepper.toml";

/// The RP2040's memory, as in its linker script `rp2040.x`; the boot ROM goes to the vector table behind the
/// second stage.
pub(crate) const RP2040_MEMORY: Memory = Memory {
    vectors: 0x1000_0100,
    flash: (0x1000_0000, 2 * 1024 * 1024),
    ram: (0x2000_0000, 256 * 1024),
};
