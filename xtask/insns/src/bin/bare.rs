//! The tick alone, to be measured and never run: coefficients, one setpoint in, one outcome out.
//!
//! Besides sizes it proves that no panic is left in the tick: the panic handler calls a function
//! that does not exist, so that an image with a path to it does not link.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "bare/image.rs"]
mod image;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is measured, not run: use `cargo xtask size`");
    std::process::exit(2);
}
