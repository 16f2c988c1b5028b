//! Counts the instructions of a plan along a straight path of 100 cells, proven in each of them: measuring, and two passes.
//!
//! Prints `STAGE TOTAL LONGEST` for each stage, in the counter's units (see `count/counter.rs`). `cargo xtask planning` reads that.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "count/counter.rs"]
mod counter;
#[cfg(target_os = "none")]
#[path = "plan/run.rs"]
mod run;
#[cfg(target_os = "none")]
#[path = "count/start.rs"]
mod start;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image runs under QEMU: use `cargo xtask planning`");
    std::process::exit(2);
}
