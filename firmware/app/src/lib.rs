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
pub mod digital;
#[cfg(target_os = "none")]
pub mod failure;
#[cfg(all(target_os = "none", not(autonomous)))]
mod host;
pub mod inputs;
mod label;
mod lamp;
#[cfg(target_os = "none")]
mod memory;
pub mod outputs;
pub mod pins;
pub mod scene;
#[cfg(all(target_os = "none", drive = "stepper"))]
pub mod slots;
#[cfg(target_os = "none")]
mod tick;
#[cfg(not(tool = "none"))]
pub mod tool;

#[cfg(all(target_os = "none", autonomous))]
use alone as service;
#[cfg(all(target_os = "none", not(autonomous)))]
use host as service;
#[cfg(all(target_os = "none", not(autonomous)))]
pub use host::{BAUD, IN_FLIGHT, IS_FIXED, LOG_BAUD, ReceivedBytes, is_lost_expected, usb};
pub use label::ImageLabel;
pub use lamp::LampPin;
pub use outputs::{Output, Readings};
#[cfg(target_os = "none")]
pub use {
    service::{Background, Channels, build, cause, played_steps},
    tick::{Tick, TickClock, WATCHDOG_MS, period},
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
