//! `trirrr watch`: what a machine does, as a watcher sees it.

mod view;

use crate::failure::CliError;
use crate::serve::read_key;
use clap::Args;
use std::io::{self, Write};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use trirrr_line::{
    Address, Frames, KeyRefusal, Link, OpenError, RawMessage, SharedKey, listening, open_watched,
};
use trirrr_scene::visible_lines;
use view::WatchView;

/// Longest wait for the machine before Ctrl-C is looked at.
const LOOK: Duration = Duration::from_millis(20);

/// Time from one line with the values to the next, and from one attempt to open the port to the next.
const SECOND: Duration = Duration::from_secs(1);

/// Bytes taken from the link at a time.
const CHUNK: usize = 4096;

/// `trirrr watch`.
///
/// Connects to the port for watchers of `trirrr device` or `trirrr bridge`. Prints a line for each event of the machine, and one a second with its
/// pose, its state and the moves that are done. Disturbs nobody.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Times count from the start of the command. The pose is that of the samples that the machine's client has asked for, or of \
the status of a machine that stands. Ctrl-C ends the command.")]
pub struct WatchArgs {
    /// The port for watchers: tcp:HOST:PORT
    #[arg(long, value_name = "PORT", default_value = "tcp:127.0.0.1:7334", value_parser = listening)]
    pub port: String,
    /// Key file of a port that expects a key
    #[arg(long, value_name = "FILE")]
    pub key: Option<PathBuf>,
    /// Print each line as a JSON object
    #[arg(long)]
    pub json: bool,
}

/// Watches until `stop` is raised, or nobody reads what is printed.
///
/// # Errors
/// Refused: the key file. Failed: the port, when it is opened first, or its key.
pub fn command(args: &WatchArgs, stop: &AtomicBool) -> Result<(), CliError> {
    let key = args.key.as_deref().map(read_key).transpose()?;
    let line = WatchedLine {
        address: Address::Tcp(args.port.clone()),
        key,
    };
    let failed = |error: OpenError| CliError::Failed(error.to_string());
    let mut link = line.open().map_err(failed)?;
    let mut frames = Frames::default();
    let mut view = WatchView::new(args.json);
    let mut due = Instant::now() + SECOND;
    while !stop.load(Ordering::Relaxed) {
        let mut bytes = [0; CHUNK];
        match link.receive(&mut bytes, LOOK) {
            Ok(length) => {
                let mut messages: Vec<RawMessage> = Vec::new();
                frames.receive(&bytes[..length], |message| messages.push(message));
                messages.iter().for_each(|message| view.take(message));
            }
            Err(error) if KeyRefusal::of(&error).is_some() => {
                return Err(CliError::Failed(format!("{}: {error}", line.address)));
            }
            Err(error) => {
                view.note(&format!("{}: {error}; opening it anew", line.address));
                if !written(view.take_lines())? {
                    return Ok(());
                }
                match line.reopen(stop)? {
                    Some(opened) => (link, frames) = (opened, Frames::default()),
                    None => return Ok(()),
                }
                view.note(&format!("{}: open again", line.address));
            }
        }
        if Instant::now() >= due {
            due += SECOND;
            view.values();
        }
        if !written(view.take_lines())? {
            return Ok(());
        }
    }
    Ok(())
}

/// Port for watchers.
struct WatchedLine {
    address: Address,
    key: Option<SharedKey>,
}

impl WatchedLine {
    fn open(&self) -> Result<Box<dyn Link>, OpenError> {
        open_watched(&self.address, self.key.as_ref())
    }

    /// Tries until it is open. `None`: `stop` was raised.
    fn reopen(&self, stop: &AtomicBool) -> Result<Option<Box<dyn Link>>, CliError> {
        while !stop.load(Ordering::Relaxed) {
            std::thread::sleep(SECOND);
            match self.open() {
                Ok(link) => return Ok(Some(link)),
                Err(error) if error.may_pass() => {}
                Err(error) => return Err(CliError::Failed(error.to_string())),
            }
        }
        Ok(None)
    }
}

/// Prints lines. Returns false if nobody reads them.
fn written(lines: Vec<String>) -> Result<bool, CliError> {
    let mut out = io::stdout().lock();
    for line in lines {
        match writeln!(out, "{}", visible_lines(&line)).and_then(|()| out.flush()) {
            Ok(()) => {}
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => return Ok(false),
            Err(error) => return Err(CliError::Failed(format!("standard output: {error}"))),
        }
    }
    Ok(true)
}
