//! Failures on purpose, for the tests of what happens then. In no image that is shipped: only with
//! the feature `provoke`, in tick [`TICK`] after a start that was none of these failures.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::sync::atomic::{AtomicBool, Ordering};
use trirrr_protocol::message::Start;

/// What is provoked: `PROVOKE` when the image is built.
const WHAT: &str = match option_env!("PROVOKE") {
    Some(what) => what,
    None => "panic",
};

/// When.
const TICK: u32 = 50;

static ARMED: AtomicBool = AtomicBool::new(false);

/// Not a second time, or nobody could ask for the cause.
pub(crate) fn arm(start: &Start) {
    ARMED.store(*start == Start::Power, Ordering::Relaxed);
}

pub(crate) fn at(tick: u32) {
    if tick != TICK || !ARMED.load(Ordering::Relaxed) {
        return;
    }
    match WHAT {
        "panic" => panic!("provoked"),
        "hard-fault" => hard_fault(),
        "stack-overflow" => {
            black_box(overflow(black_box(0)));
        }
        "overrun" => {
            ARMED.store(false, Ordering::Relaxed);
            // 1.2 periods at the full clock, more at any other.
            let period =
                (crate::board::CORE_HZ as f64 / trirrr_station::scene::TICK_RATE_HZ) as u32;
            cortex_m::asm::delay(period + period / 5);
        }
        _ => {}
    }
}

fn hard_fault() {
    // SAFETY: nothing is at this address, on purpose: the read faults.
    black_box(unsafe { (0x6000_0000 as *const u32).read_volatile() });
}

#[allow(unconditional_recursion)]
fn overflow(depth: u32) -> u32 {
    let frame = black_box([depth; 64]);
    overflow(depth + 1) + frame[(depth % 64) as usize]
}
