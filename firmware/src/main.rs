//! Image for a board: the scene's service between a serial line and the motors.
//!
//! The [`board`] owns pins, clocks and interrupts and calls, in the order of a tick: the line
//! brings bytes to a queue, the [`background`](background::Background) makes requests of them and
//! moves of the requests, the tick plays the moves and the [`outputs`] carry them to the drives. The
//! scene, its service and what it says are in the [station](trirrr_station).
//!
//! | priority | what | where |
//! |---|---|---|
//! | highest | a byte from the line into a queue | `board` |
//! | above the background | the tick: the station's foreground, then the outputs | `board` |
//! | lowest | requests, admission, telemetry, log | `background`, the station |
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod background;
#[cfg(target_os = "none")]
mod board;
#[cfg(target_os = "none")]
mod failure;
#[cfg(target_os = "none")]
mod inputs;
#[cfg(target_os = "none")]
mod memory;
#[cfg(target_os = "none")]
mod outputs;
#[cfg(all(target_os = "none", feature = "provoke"))]
mod provoke;
#[cfg(target_os = "none")]
mod pulse;
#[cfg(all(target_os = "none", drive = "stepper"))]
mod slots;
#[cfg(target_os = "none")]
mod systick;
#[cfg(target_os = "none")]
mod tick;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!(
        "this image of scene {} ({} ticks per second) is for a board: build it with `cargo fw` or `cargo fw-rp2040`",
        trirrr_station::scene::NAME,
        trirrr_station::scene::TICK_RATE_HZ
    );
    std::process::exit(2);
}
