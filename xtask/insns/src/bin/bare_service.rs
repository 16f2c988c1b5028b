//! The service's tick alone, to be linked and never run: it links only if no panic is left in it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "bare/service.rs"]
mod image;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("this image is linked, not run: use `cargo xtask insns`");
    std::process::exit(2);
}
