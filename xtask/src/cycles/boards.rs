//! Boards whose cycles are modelled: a core, its clock and its memory of code.

use super::flash::{CacheSize, Flash, UNCACHED};
use super::timing::{CORTEX_M0, CORTEX_M0_PLUS, CORTEX_M3, CORTEX_M4, Timing};

/// A microcontroller at its highest clock.
#[derive(Debug)]
pub(super) struct Board {
    /// Name of the core in rows.
    pub(super) core: &'static str,
    /// The core of the table of emulated ones whose images it executes.
    pub(super) emulated: &'static str,
    pub(super) name: &'static str,
    pub(super) mhz: f64,
    pub(super) timing: Timing,
    pub(super) flash: Flash,
}

pub(super) const BOARDS: [Board; 4] = [
    // RM0090, 3.5: at 168 MHz five wait states, reads of 128 bits, prefetch, 64 lines for instructions and 8
    // for constants, replaced by age of use.
    Board {
        core: "m4f",
        emulated: "m4f",
        name: "STM32F405",
        mhz: 168.0,
        timing: CORTEX_M4,
        flash: Flash {
            wait_states: 5,
            line: 16,
            prefetches: true,
            instructions: CacheSize { sets: 1, ways: 64 },
            constants: Some(CacheSize { sets: 1, ways: 8 }),
        },
    },
    // PM0075: at 72 MHz two wait states, reads of 64 bits, prefetch.
    Board {
        core: "m3",
        emulated: "m3",
        name: "STM32F103",
        mhz: 72.0,
        timing: CORTEX_M3,
        flash: Flash {
            wait_states: 2,
            line: 8,
            prefetches: true,
            instructions: UNCACHED,
            constants: Some(UNCACHED),
        },
    },
    // RM0091, 3.2: at 48 MHz one wait state, reads of 32 bits, prefetch.
    Board {
        core: "m0",
        emulated: "m0",
        name: "STM32F072",
        mhz: 48.0,
        timing: CORTEX_M0,
        flash: Flash {
            wait_states: 1,
            line: 4,
            prefetches: true,
            instructions: UNCACHED,
            constants: Some(UNCACHED),
        },
    },
    // RP2040 datasheet, 2.6.3: a cache of 16 KiB, two ways, hits without a wait. A miss takes some 400 ns.
    Board {
        core: "m0plus",
        emulated: "m0",
        name: "RP2040",
        mhz: 125.0,
        timing: CORTEX_M0_PLUS,
        flash: Flash {
            wait_states: 49,
            line: 8,
            prefetches: false,
            instructions: CacheSize {
                sets: 1024,
                ways: 2,
            },
            constants: None,
        },
    },
];

/// Memories that the code of a board is read from.
pub(super) const MEMORIES: [Memory; 3] = [Memory::Ram, Memory::Flash, Memory::ColdFlash];

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Memory {
    /// Without wait states.
    Ram,
    /// Caches hold what the same work left there before.
    Flash,
    /// Caches are empty at the start of each call.
    ColdFlash,
}

impl Memory {
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Ram => "ram",
            Self::Flash => "flash",
            Self::ColdFlash => "flash-cold",
        }
    }
}
