//! Arguments.

use clap::Parser;
use foxglove::McapWriteOptions;
use std::path::{Path, PathBuf};
use trirrr_line::listening;

/// Watches a machine by the port for watchers of `trirrr device` or `trirrr bridge`, or reads ticks.csv of `trirrr run`, and gives its
/// values to Foxglove and to a file.
#[derive(Clone, Debug, Parser)]
#[command(
    version,
    after_help = "\
In Foxglove: Open connection, Foxglove WebSocket, ws://localhost:8765. Topics: /platform, /motors, /state, /drives, /log, /tf, /scene. \
Times are those of this computer, of a table those of its column t. Ctrl-C ends the command and completes the file."
)]
pub(crate) struct FoxgloveArgs {
    /// Scene of the machine, the one that it was built from
    #[arg(value_name = "SCENE.toml")]
    pub(crate) scene: PathBuf,
    /// Port for watchers: tcp:HOST:PORT
    #[arg(long, value_name = "PORT", default_value = "tcp:127.0.0.1:7334", value_parser = listening)]
    port: String,
    /// Key file of a port that expects a key
    #[arg(long, value_name = "FILE")]
    pub(crate) key: Option<PathBuf>,
    /// Table of `trirrr run` in place of a port
    #[arg(long, value_name = "ticks.csv", requires = "mcap")]
    ticks: Option<PathBuf>,
    /// Address of this computer that Foxglove connects to
    #[arg(long, value_name = "HOST", default_value = "127.0.0.1")]
    pub(crate) host: String,
    /// Port that Foxglove connects to; 0 for any that is free
    #[arg(long, value_name = "PORT", default_value_t = 8765)]
    listen: u16,
    /// Open no port for Foxglove: write a file alone
    #[arg(long, requires = "mcap")]
    no_listen: bool,
    /// File to record into; one that is there stays
    #[arg(long, value_name = "FILE.mcap")]
    pub(crate) mcap: Option<PathBuf>,
}

/// Origin of the values.
pub(crate) enum SampleOrigin<'a> {
    /// Port for watchers.
    Port(&'a str),
    /// Table of a run.
    Ticks(&'a Path),
}

impl FoxgloveArgs {
    pub(crate) fn source(&self) -> SampleOrigin<'_> {
        match &self.ticks {
            Some(ticks) => SampleOrigin::Ticks(ticks),
            None => SampleOrigin::Port(&self.port),
        }
    }

    /// Address for Foxglove, unless there is to be none.
    pub(crate) fn listen(&self) -> Option<(&str, u16)> {
        (!self.no_listen).then_some((&self.host, self.listen))
    }
}

/// Options of a file that every reader can read.
pub(crate) fn uncompressed() -> McapWriteOptions {
    McapWriteOptions::new().compression(None)
}
