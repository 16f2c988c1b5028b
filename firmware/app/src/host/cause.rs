//! Cause of a failure, kept over the reset that follows: words in RAM that no start initialises. They count
//! only with their mark and their checksum.
#![allow(unsafe_code)]

use core::mem::MaybeUninit;
use core::ptr::{read_volatile, write_volatile};
use trirrr_protocol::message::{NAME_CAPACITY, Registers, Start};

/// "TRIR". RAM after power-on hardly holds this word and a right checksum.
const MARK: u32 = 0x5452_4952;

/// Words of a file name.
const NAME: usize = NAME_CAPACITY / 4;

/// Mark, kind, the line and the name or the registers, checksum.
const WORDS: usize = 2 + 1 + NAME + 1;

type Words = [u32; WORDS];

#[unsafe(link_section = ".uninit.cause")]
static mut KEPT: MaybeUninit<Words> = MaybeUninit::uninit();

/// Keeps the cause of a failure. Only for a panic or a fault, right before the reset.
#[inline(never)]
pub(crate) fn keep(start: &Start) {
    write(words(start));
}

/// Takes the cause that the run before has kept, and forgets it.
#[inline(never)]
pub fn take() -> Option<Start> {
    let kept = read();
    write([0; WORDS]);
    start(&kept)
}

fn words(start: &Start) -> Words {
    let mut words = [0; WORDS];
    let mut put = |kind, content: &[u32]| {
        for (word, content) in words.iter_mut().zip([MARK, kind].iter().chain(content)) {
            *word = *content;
        }
    };
    match start {
        Start::Panic { file, line } => {
            let mut content = [*line; 1 + NAME];
            for (word, bytes) in content.iter_mut().skip(1).zip(file.as_chunks().0) {
                *word = u32::from_le_bytes(*bytes);
            }
            put(PANIC, &content);
        }
        Start::HardFault(at) => put(HARD_FAULT, &registers(at)),
        Start::StackOverflow(at) => put(STACK_OVERFLOW, &registers(at)),
        Start::CrystalStopped => put(CRYSTAL_STOPPED, &[]),
        Start::LowSupply => put(LOW_SUPPLY, &[]),
        // The chip's reset flags tell these.
        Start::Power | Start::Reset | Start::Watchdog => {}
    }
    if let Some((sum, content)) = words.split_last_mut() {
        *sum = checksum(content);
    }
    words
}

const PANIC: u32 = 1;
const HARD_FAULT: u32 = 2;
const STACK_OVERFLOW: u32 = 3;
const CRYSTAL_STOPPED: u32 = 4;
const LOW_SUPPLY: u32 = 5;

fn registers(at: &Registers) -> [u32; 5] {
    [at.pc, at.lr, at.sp, at.status, at.address]
}

fn start(kept: &Words) -> Option<Start> {
    let (sum, content) = kept.split_last()?;
    let [mark, kind, a, b, c, d, e, ..] = *kept;
    if *sum != checksum(content) || mark != MARK {
        return None;
    }
    let registers = Registers {
        pc: a,
        lr: b,
        sp: c,
        status: d,
        address: e,
    };
    match kind {
        PANIC => {
            let mut file = [0; NAME_CAPACITY];
            for (bytes, word) in file.as_chunks_mut().0.iter_mut().zip(kept.iter().skip(3)) {
                *bytes = word.to_le_bytes();
            }
            Some(Start::Panic { file, line: a })
        }
        HARD_FAULT => Some(Start::HardFault(registers)),
        STACK_OVERFLOW => Some(Start::StackOverflow(registers)),
        CRYSTAL_STOPPED => Some(Start::CrystalStopped),
        LOW_SUPPLY => Some(Start::LowSupply),
        _ => None,
    }
}

/// FNV-1a, word by word.
fn checksum(content: &[u32]) -> u32 {
    content.iter().fold(0x811c_9dc5, |sum: u32, word| {
        (sum ^ word).wrapping_mul(0x0100_0193)
    })
}

fn write(words: Words) {
    // SAFETY: only `read` and `write` touch the words: at the start before any interrupt is on, and at
    // the end when nothing else runs any more.
    unsafe { write_volatile(&raw mut KEPT, MaybeUninit::new(words)) };
}

fn read() -> Words {
    // SAFETY: as in `write`. Any bits are valid words. Volatile: the compiler must not assume a value.
    unsafe { read_volatile((&raw const KEPT).cast::<Words>()) }
}
