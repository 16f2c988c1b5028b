//! Image for the STM32F405: builds the scene's machine and evaluates its job tick by tick, paced
//! by SysTick at the scene's rate, with a log over RTT.
//!
//! It drives nothing yet. The clock is the internal 16 MHz oscillator as it is after reset.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod application;
#[cfg(target_os = "none")]
mod clock;
mod scene;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "this image of scene {} ({} ticks per second) is for an STM32F405: build it with \
         `cargo firmware`",
        scene::NAME,
        scene::TICK_RATE_HZ
    );
    std::process::exit(2);
}
