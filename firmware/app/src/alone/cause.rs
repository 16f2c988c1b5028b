//! Cause of a failure, kept over the reset that follows, of a board that tells nobody: its kind alone, in RAM that no start initialises.
#![allow(unsafe_code)]

use core::mem::MaybeUninit;
use core::ptr::{read_volatile, write_volatile};
use trirrr_protocol::message::{NAME_CAPACITY, Start};

/// "TRIR". RAM after power-on hardly holds this word, and a kind with its complement behind it.
const MARK: u32 = 0x5452_4952;

#[unsafe(link_section = ".uninit.cause")]
static mut KEPT: MaybeUninit<[u32; 3]> = MaybeUninit::uninit();

/// The program has failed, the crystal has stopped, the supply has sagged.
const PROGRAM: u32 = 1;
const CRYSTAL_STOPPED: u32 = 2;
const LOW_SUPPLY: u32 = 3;

/// Keeps the kind of a failure. Only for a panic or a fault, right before the reset.
#[inline(never)]
pub(crate) fn keep(start: &Start) {
    let kind = match start {
        // The chip's reset flags tell these.
        Start::Power | Start::Reset | Start::Watchdog => 0,
        Start::Panic { .. } | Start::HardFault(_) | Start::StackOverflow(_) => PROGRAM,
        Start::CrystalStopped => CRYSTAL_STOPPED,
        Start::LowSupply => LOW_SUPPLY,
    };
    write([MARK, kind, !kind]);
}

/// Takes the cause that the run before has kept, and forgets it. Any failure of the program is a panic without a place.
#[inline(never)]
pub fn take() -> Option<Start> {
    let [mark, kind, complement] = read();
    write([0; 3]);
    if mark != MARK || complement != !kind {
        return None;
    }
    match kind {
        PROGRAM => Some(Start::Panic {
            file: [0; NAME_CAPACITY],
            line: 0,
        }),
        CRYSTAL_STOPPED => Some(Start::CrystalStopped),
        LOW_SUPPLY => Some(Start::LowSupply),
        _ => None,
    }
}

fn write(words: [u32; 3]) {
    // SAFETY: only `read` and `write` touch the words: at the start before any interrupt is on, and at
    // the end when nothing else runs any more.
    unsafe { write_volatile(&raw mut KEPT, MaybeUninit::new(words)) };
}

fn read() -> [u32; 3] {
    // SAFETY: as in `write`. Any bits are valid words. Volatile: the compiler must not assume a value.
    unsafe { read_volatile((&raw const KEPT).cast::<[u32; 3]>()) }
}
