//! Counts the instructions of every tick of the service while it homes the machine, if the scene has
//! homing, and plays the scene's job: once as it is, once with a hold and a resume every so many
//! ticks.
//!
//! Prints `empty TICK`, what counting costs by itself, `homing TICK` per tick of homing, `tick TICK` per tick of the job and `held TICK` per tick
//! with holds, in the unit of the counter (see `counter`), and `bits CHECKSUM` over the results of
//! the job as it is. `cargo xtask insns` reads that.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "count/counter.rs"]
mod counter;
#[cfg(target_os = "none")]
#[path = "serve/run.rs"]
mod run;
#[cfg(target_os = "none")]
#[path = "count/start.rs"]
mod start;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image runs under QEMU: use `cargo xtask insns`");
    std::process::exit(2);
}
