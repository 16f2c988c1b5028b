//! Counts the instructions of every tick of the scene's job.
//!
//! Prints `empty TICK SETPOINT`, what counting costs by itself, one `tick TICK SETPOINT` per tick,
//! both in the unit of the counter (see `counter`), and `bits CHECKSUM` over all results.
//! `cargo xtask insns` reads that.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "count/counter.rs"]
mod counter;
#[cfg(target_os = "none")]
#[path = "count/run.rs"]
mod run;
#[cfg(target_os = "none")]
#[path = "count/start.rs"]
mod start;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image runs under QEMU: use `cargo xtask insns`");
    std::process::exit(2);
}
