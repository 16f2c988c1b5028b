//! `trirrr-zenoh`: machines on Zenoh.

#![forbid(unsafe_code)]

use clap::Parser;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use trirrr_zenoh::FleetArgs;

fn main() -> ExitCode {
    let args = FleetArgs::parse();
    let stop = Arc::new(AtomicBool::new(false));
    let raised = stop.clone();
    if let Err(error) = ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed)) {
        eprintln!("Ctrl-C cannot be caught: {error}");
        return ExitCode::FAILURE;
    }
    match trirrr_zenoh::run(&args, &stop) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}
