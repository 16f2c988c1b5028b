//! Program that every board runs: the service of one scene between a serial line and the motors.
//!
//! A board package owns pins, clocks, interrupts and priorities. It calls, in the order of a tick: the
//! line's interrupt or DMA puts bytes into memory, the [`Background`] makes requests of the bytes and moves of the
//! requests, the [`Tick`] plays the moves and hands its outputs to the drives.
//!
//! | priority | task | code |
//! |---|---|---|
//! | highest | step pulses, then bytes from the line | board |
//! | above the background | the tick: inputs, service, drives, time | [`Tick`] |
//! | lowest | requests, admission, telemetry, log, watchdog | [`Background`] |
//!
//! # Optimisation
//! The profile `device` compiles this crate for size and the board's crate for speed. Generic code is
//! compiled in the crate that names its types. So [`Tick`] is generic over inputs and outputs and becomes
//! fast in the board's crate. The work of the [`Background`] is a function without parameters and stays small
//! here.
#![cfg_attr(target_os = "none", no_std)]
// A feature that the scene lacks is a unit.
#![allow(clippy::unit_arg, clippy::let_unit_value)]

#[cfg(all(target_os = "none", autonomous))]
mod alone;
#[cfg(all(target_os = "none", not(autonomous)))]
mod background;
#[cfg(all(target_os = "none", not(autonomous)))]
pub mod cause;
#[cfg(target_os = "none")]
pub mod digital;
#[cfg(target_os = "none")]
pub mod failure;
#[cfg(all(target_os = "none", feature = "fault-injection"))]
mod fault_injection;
#[cfg(target_os = "none")]
mod heartbeat;
#[cfg(all(target_os = "none", update))]
mod image_flash;
#[cfg(target_os = "none")]
pub mod inputs;
#[cfg(target_os = "none")]
mod lamp;
#[cfg(all(target_os = "none", not(autonomous)))]
mod line;
#[cfg(all(target_os = "none", not(autonomous)))]
mod log;
#[cfg(all(target_os = "none", not(autonomous)))]
mod log_start;
#[cfg(target_os = "none")]
mod memory;
#[cfg(all(target_os = "none", autonomous))]
mod no_log;
#[cfg(target_os = "none")]
pub mod outputs;
#[cfg(target_os = "none")]
pub mod pins;
#[cfg(all(target_os = "none", feature = "ruled-switches"))]
mod ruled_switches;
pub mod scene;
#[cfg(all(target_os = "none", not(autonomous)))]
mod service;
#[cfg(all(target_os = "none", autonomous))]
pub mod short_cause;
#[cfg(all(target_os = "none", drive = "stepper"))]
pub mod slots;
#[cfg(all(target_os = "none", scene_over_line))]
mod stored_scene;
#[cfg(target_os = "none")]
mod tick;
#[cfg(target_os = "none")]
mod tick_clock;
#[cfg(all(target_os = "none", update))]
mod update;
#[cfg(all(target_os = "none", not(autonomous)))]
pub mod usb;
#[cfg(target_os = "none")]
mod wired;

#[cfg(all(target_os = "none", autonomous))]
use alone as service;
#[cfg(all(target_os = "none", autonomous))]
pub use alone::Background;
#[cfg(all(target_os = "none", update, feature = "stm32g474"))]
pub use image_flash::is_lost_expected;
#[cfg(all(target_os = "none", autonomous))]
pub use short_cause as cause;
#[cfg(all(target_os = "none", update))]
pub use update::ImageLabel;
#[cfg(all(target_os = "none", not(autonomous)))]
pub use {
    background::Background,
    line::{BAUD, IN_FLIGHT, IS_FIXED, ReceivedBytes},
    log::LOG_BAUD,
};
#[cfg(target_os = "none")]
pub use {
    heartbeat::WATCHDOG_MS,
    lamp::LampPin,
    outputs::{Output, Readings},
    service::{Channels, build},
    tick::Tick,
    tick_clock::{TickClock, period},
};

/// Defines the program of a board's package: its library, or on a host a refusal.
#[macro_export]
macro_rules! image {
    ($library:ident, $command:literal) => {
        #[cfg(target_os = "none")]
        use $library as _;

        #[cfg(not(target_os = "none"))]
        fn main() {
            $crate::refuse_host($command)
        }
    };
}

/// Ends a board's program that was started on a host, and tells how to build the image: with `command`.
#[cfg(not(target_os = "none"))]
pub fn refuse_host(command: &str) -> ! {
    eprintln!(
        "this image of scene {} ({} ticks per second) is for a board: build it with `{command}`",
        scene::NAME,
        scene::TICK_RATE_HZ
    );
    std::process::exit(2);
}
