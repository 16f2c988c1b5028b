//! The image's only function.
#![allow(unsafe_code)]

use core::hint::black_box;
use core::mem::MaybeUninit;
use core::panic::PanicInfo;
#[cfg(any(drive = "stepper", drive = "bldc"))]
use trirrr_insns::drives::{SceneSlots, slot};
use trirrr_insns::service::{Ticking, tick};

static mut TICKING: MaybeUninit<Ticking> = MaybeUninit::uninit();

#[cfg(any(drive = "stepper", drive = "bldc"))]
static mut SLOTS: MaybeUninit<SceneSlots> = MaybeUninit::uninit();

/// Entry point: what would be called once per tick, and between ticks.
// SAFETY: the name is this image's entry point and nothing else defines it.
#[unsafe(no_mangle)]
#[unsafe(link_section = ".start")]
extern "C" fn start() {
    let ticking = black_box((&raw mut TICKING).cast::<Ticking>());
    // SAFETY: the image is never run. Were it run, whoever starts it would have to fill it in
    // before; it is aligned, lives for ever, and nothing else refers to it.
    unsafe { tick(&mut *ticking) }
    #[cfg(any(drive = "stepper", drive = "bldc"))]
    {
        let slots = black_box((&raw mut SLOTS).cast::<SceneSlots>());
        // SAFETY: the same.
        unsafe { slot(&mut *slots) }
    }
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
