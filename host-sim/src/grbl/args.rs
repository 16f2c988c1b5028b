//! Arguments of `trirrr grbl`.

use crate::arguments::{DEFAULT_SCENE, SetArgs, number_type};
use crate::job_file::ZArgs;
use clap::Args;
use std::path::PathBuf;
use trirrr_line::{Address, listening};
use trirrr_scene::NumberType;

/// `trirrr grbl`.
///
/// Speaks the line protocol of GRBL 1.1 to a sender of G-code, and plays what it sends on a board, or on a simulated machine
/// that the command brings along.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
The machine plans the path itself while lines still come: the scene needs `plans_paths = true` in [service] for a board. Nothing moves before \
the sender has unlocked the machine with $X or $H. A sender that goes away stops the machine on its path, with the tool off. Senders know no key, so \
the port is on this computer only.")]
pub struct GrblArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Address for the sender: tcp:HOST:PORT on this computer; port 0 takes one that is free and prints it
    #[arg(long, value_name = "ADDRESS", default_value = "tcp:127.0.0.1:7336", value_parser = listening)]
    pub listen: String,
    /// Make a pseudo terminal for the sender in place of a TCP port, and print its name
    #[cfg(unix)]
    #[arg(long, conflicts_with = "listen")]
    pub pty: bool,
    /// The board: /dev/tty..., or tcp:HOST:PORT [default: a simulated machine]
    #[arg(long, value_name = "PORT")]
    pub port: Option<Address>,
    /// Rate of a serial port to the board
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    pub baud: u32,
    /// Key file of a board's TCP port that expects a key
    #[arg(long, value_name = "FILE", requires = "port")]
    pub key: Option<PathBuf>,
    /// Number type of the machine [default: the scene's]
    #[arg(long, value_parser = number_type())]
    pub scalar: Option<NumberType>,
    /// Distance by which a corner may be rounded, mm; 0: the machine stops at each
    #[arg(long, value_name = "MM", default_value_t = 0.01, value_parser = crate::arguments::distance)]
    pub corner: f64,
    /// Sense of words of Z.
    #[command(flatten)]
    pub z: ZArgs,
}
