//! Self-description of a board: its timer, its clock, the reason of its start, and the build of its program.

use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::to_source;

/// The hardware that carries the service.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Board {
    /// Counts per second of the timer that ticks are timed with.
    pub timer_hz: u32,
    /// Source of the clock.
    pub clock: Clock,
    /// Reason of the last start.
    pub start: Start,
}

/// Build of the program that a machine runs. Texts are ASCII, cut where they are longer, with zeros behind them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
// Hosts read it out of images.
#[repr(C)]
pub struct Firmware {
    /// Version of the program.
    pub version: [u8; SHORT_TEXT],
    /// Commit of its source, ten hexadecimal digits; `-dirty` behind them if files were changed since. Empty where the program was
    /// built without git.
    pub commit: [u8; SHORT_TEXT],
    /// Name of the board file, or `simulator`.
    pub board: [u8; NAME_CAPACITY],
    /// Chip of that board; empty for a simulator.
    pub chip: [u8; SHORT_TEXT],
}

/// Bytes for the name of a scene, a job or a board.
pub const NAME_CAPACITY: usize = 32;

/// Bytes of a version, a commit, and the name of a chip.
const SHORT_TEXT: usize = 16;

/// The way in which a machine knows where its motors are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum AngleReference {
    /// Nothing has told it: it counts from the start of the scene's job, where its user has to place it before the drives go on.
    Declared,
    /// Its homing turns the motors for as long as the way to their stops can take. Nothing has told that they have reached them.
    Blind,
    /// Its homing finds switches or stops by a signal.
    Homed,
    /// Its drives tell where their joints are.
    Measured,
}

to_source!(pub AngleReference in trirrr_protocol::message: Declared, Blind, Homed, Measured);

/// Source of a board's clock, and so the accuracy of its tick rate.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Clock {
    /// No board: the clock of a host.
    Host,
    /// A crystal. The normal case.
    Crystal,
    /// The crystal does not start: an internal oscillator, some 1 % off, at full speed.
    Internal,
    /// Nor does the PLL: the internal oscillator itself, and the board is slow.
    Slow,
    /// An emulator's.
    Emulated,
    /// The crystal runs at another frequency than that of the board file: the internal oscillator, some 1 % off, at
    /// full speed.
    WrongCrystal,
}

/// Reason why a board started.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum Start {
    /// Power was switched on.
    Power,
    /// The reset pin, or a programmer.
    Reset,
    /// The watchdog: ticks did not come, not in time, or far too slowly by its own oscillator.
    Watchdog,
    /// The program panicked.
    Panic {
        /// The source file, ASCII: the end of its path, zeros behind it.
        file: [u8; NAME_CAPACITY],
        /// The line.
        line: u32,
    },
    /// The processor met an instruction that it cannot execute or an address that is not there.
    HardFault(Registers),
    /// A hard fault because the stack had no room left.
    StackOverflow(Registers),
    /// The crystal stopped while the board ran.
    CrystalStopped,
    /// The supply of the chip fell below the level at which its outputs are still what the program says.
    LowSupply,
}

/// The processor at a fault.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Registers {
    /// The instruction; 0 where the stack was lost.
    pub pc: u32,
    /// The return address; 0 where the stack was lost.
    pub lr: u32,
    /// The stack pointer.
    pub sp: u32,
    /// The processor's fault status: on a Cortex-M4 the register CFSR, 0 where there is none.
    pub status: u32,
    /// The address of the failed access, 0 where unknown.
    pub address: u32,
}

impl Start {
    /// Returns true if the board started because it had failed.
    pub fn is_failure(&self) -> bool {
        !matches!(self, Self::Power | Self::Reset)
    }
}

impl Firmware {
    /// Program without a board: the simulator, of the version of this crate.
    pub const SIMULATOR: Self = Self::new(env!("CARGO_PKG_VERSION"), "", "simulator", "");

    /// Build of these texts.
    pub const fn new(version: &str, commit: &str, board: &str, chip: &str) -> Self {
        Self {
            version: padded(version),
            commit: padded(commit),
            board: padded(board),
            chip: padded(chip),
        }
    }

    /// Build that lies at the beginning of `bytes`, as in memory. `None` if there are too few.
    pub fn of_bytes(bytes: &[u8]) -> Option<Self> {
        let (version, rest) = bytes.split_first_chunk()?;
        let (commit, rest) = rest.split_first_chunk()?;
        let (board, rest) = rest.split_first_chunk()?;
        let (chip, _) = rest.split_first_chunk()?;
        Some(Self {
            version: *version,
            commit: *commit,
            board: *board,
            chip: *chip,
        })
    }
}

/// `text`, cut where it is longer, zeros behind it.
const fn padded<const BYTES: usize>(text: &str) -> [u8; BYTES] {
    let mut bytes = [0; BYTES];
    let mut index = 0;
    while index < BYTES && index < text.len() {
        bytes[index] = text.as_bytes()[index];
        index += 1;
    }
    bytes
}

impl Board {
    /// No board but a host, which times its ticks in ns.
    pub const HOST: Self = Self {
        timer_hz: 1_000_000_000,
        clock: Clock::Host,
        start: Start::Power,
    };
}
