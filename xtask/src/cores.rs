//! The processor cores that instructions are counted on.

/// One core and the emulated machine that has it.
#[derive(Debug)]
pub(crate) struct Core {
    /// Name in tables and budgets.
    pub(crate) name: &'static str,
    /// Rust target.
    pub(crate) target: &'static str,
    /// Emulator.
    pub(crate) emulator: Emulator,
    /// QEMU's name of the machine, and its arguments beyond that.
    pub(crate) machine: &'static [&'static str],
    /// Units per instruction on the counter of the `count` image. Under `-icount shift=8` they are
    /// 256 ns times the machine's clock. The value is 1 where the counter counts instructions.
    pub(crate) units_per_instruction: f64,
}

/// A QEMU system emulator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Emulator {
    /// The command.
    pub(crate) command: &'static str,
    /// The Debian package that brings it.
    pub(crate) package: &'static str,
}

const ARM: Emulator = Emulator {
    command: "qemu-system-arm",
    package: "qemu-system-arm",
};
const RISCV: Emulator = Emulator {
    command: "qemu-system-riscv32",
    package: "qemu-system-misc",
};

/// All cores, the firmware's own first.
pub(crate) const CORES: &[Core] = &[
    Core {
        name: "m4f",
        target: "thumbv7em-none-eabihf",
        emulator: ARM,
        machine: &["mps2-an386", "-icount", "shift=8,sleep=off"],
        units_per_instruction: 6.4,
    },
    Core {
        name: "m3",
        target: "thumbv7m-none-eabi",
        emulator: ARM,
        machine: &["mps2-an385", "-icount", "shift=8,sleep=off"],
        units_per_instruction: 6.4,
    },
    Core {
        name: "m0",
        target: "thumbv6m-none-eabi",
        emulator: ARM,
        machine: &["microbit", "-icount", "shift=8,sleep=off"],
        units_per_instruction: 4.096,
    },
    Core {
        name: "rv32imc",
        target: "riscv32imc-unknown-none-elf",
        emulator: RISCV,
        machine: &["virt", "-bios", "none", "-icount", "shift=0,sleep=off"],
        units_per_instruction: 1.0,
    },
];

/// The core called `name`.
pub(crate) fn named(name: &str) -> Option<&'static Core> {
    CORES.iter().find(|core| core.name == name)
}
