//! `trirrr-zenoh-router`: a router of Zenoh, for those who have none.

#![forbid(unsafe_code)]

use clap::Parser;
use std::process::ExitCode;
use std::sync::mpsc::channel;
use trirrr_zenoh::session::{self, SessionMode};
use trirrr_zenoh::{RouterArgs, ZenohError};

fn main() -> ExitCode {
    match run(&RouterArgs::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(error.exit_code())
        }
    }
}

fn run(args: &RouterArgs) -> Result<(), ZenohError> {
    let (raise, raised) = channel();
    // A second Ctrl-C finds nobody who listens.
    ctrlc::set_handler(move || raise.send(()).unwrap_or_default())
        .map_err(|error| ZenohError::Failed(format!("Ctrl-C cannot be caught: {error}")))?;
    let endpoints = args.listen();
    let session = session::open(SessionMode::Router, args.config.as_deref(), &endpoints)?;
    println!("router {}: {}", session.zid(), endpoints.join(", "));
    // An end of the channel is an end of the program, too.
    let _ = raised.recv();
    Ok(())
}
