//! The image's only function.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
use trirrr_core::setpoint::Setpoint;
use trirrr_insns::scene::Scalar;
use trirrr_insns::tick::{SceneTick, TickOutcome, evaluate};

static mut TICK: MaybeUninit<SceneTick> = MaybeUninit::uninit();
static mut SETPOINT: MaybeUninit<Setpoint<Scalar>> = MaybeUninit::uninit();
static mut OUTCOME: MaybeUninit<TickOutcome> = MaybeUninit::uninit();

/// Entry point: what would be called once per tick.
// SAFETY: the name is this image's entry point and nothing else defines it.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".start")]
extern "C" fn start() {
    let (tick, setpoint, outcome) = black_box((
        (&raw const TICK).cast::<SceneTick>(),
        (&raw const SETPOINT).cast::<Setpoint<Scalar>>(),
        (&raw mut OUTCOME).cast::<TickOutcome>(),
    ));
    // SAFETY: the image is never run. Were it run, whoever starts it would have to fill the three
    // in before; they are aligned, live for ever, and nothing else refers to them.
    unsafe { evaluate(&*tick, &*setpoint, &mut *outcome) }
}

unsafe extern "C" {
    /// Does not exist.
    fn a_panic_is_left_in_the_tick() -> !;
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    // SAFETY: never linked, hence never called.
    unsafe { a_panic_is_left_in_the_tick() }
}
