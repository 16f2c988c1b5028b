//! `trirrr-foxglove`: what a machine does, for Foxglove's panels and for MCAP files.

#![forbid(unsafe_code)]

mod args;
mod drawing;
mod error;
mod recording;
mod topics;
mod watched;

use args::{FoxgloveArgs, SampleOrigin};
use clap::Parser;
use error::FoxgloveError;
use foxglove::{Context, WebSocketServerHandle};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use topics::Topics;
use trirrr_scene::Scene;

fn main() -> ExitCode {
    let args = FoxgloveArgs::parse();
    let stop = Arc::new(AtomicBool::new(false));
    let raised = stop.clone();
    if let Err(error) = ctrlc::set_handler(move || raised.store(true, Ordering::Relaxed)) {
        eprintln!("Ctrl-C cannot be caught: {error}");
        return ExitCode::FAILURE;
    }
    match run(&args, &stop) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            ExitCode::from(failure.exit_code())
        }
    }
}

fn run(args: &FoxgloveArgs, stop: &AtomicBool) -> Result<(), FoxgloveError> {
    let scene =
        Scene::read(&args.scene).map_err(|error| FoxgloveError::Refused(error.to_string()))?;
    let context = Context::new();
    let mut topics = Topics::new(&context)?;
    let file = args.mcap.as_ref().map(|path| {
        let made = context.mcap_writer_with_options(args::uncompressed());
        let made = made.create_new_buffered_file(path);
        made.map_err(|error| FoxgloveError::file(path, &error))
    });
    let file = file.transpose()?;
    let done = match args.source() {
        SampleOrigin::Ticks(table) => recording::play(table, &scene, &mut topics),
        SampleOrigin::Port(port) => {
            let server = args.listen().map(|at| listen(&context, at)).transpose()?;
            if let Some(server) = &server {
                println!("Foxglove connects to ws://{}:{}", args.host, server.port());
            }
            let done = watched::watch(port, args.key.as_deref(), &scene, &mut topics, stop);
            if let Some(server) = server {
                // Whoever listens is told that it ends; nobody is waited for.
                let _ = server.stop();
            }
            done
        }
    };
    // What has come stays readable, however it ended.
    if let (Some(file), Some(path)) = (file, &args.mcap) {
        let closed = file.close();
        closed.map_err(|error| FoxgloveError::Failed(format!("{}: {error}", path.display())))?;
        println!("wrote {}: {} samples", path.display(), topics.samples());
    }
    done
}

fn listen(
    context: &Arc<Context>,
    (host, port): (&str, u16),
) -> Result<WebSocketServerHandle, FoxgloveError> {
    let server = context.websocket_server().name("trirrr").bind(host, port);
    let started = server.start_blocking();
    started.map_err(|error| FoxgloveError::Failed(format!("{host}:{port}: {error}")))
}
