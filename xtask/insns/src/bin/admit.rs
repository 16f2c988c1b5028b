//! Counts the instructions of the admission of every move of the scene's job.
//!
//! Prints `move INTERVALS TOTAL LONGEST VERDICT` for each move, first against the limits of the scene,
//! then with every limit there is; TOTAL and LONGEST are the counter's units (see `count/counter.rs`)
//! of all intervals and of the longest. `cargo xtask admission` reads that.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "count/counter.rs"]
mod counter;
#[cfg(target_os = "none")]
#[path = "admit/run.rs"]
mod run;
#[cfg(target_os = "none")]
#[path = "count/start.rs"]
mod start;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image runs under QEMU: use `cargo xtask admission`");
    std::process::exit(2);
}
