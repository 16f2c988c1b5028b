//! Arguments of `trirrr bridge`.

use crate::serve::ListenArgs;
use clap::Args;
use std::path::PathBuf;
use trirrr_line::Address;

/// `trirrr bridge`.
///
/// Carries the line of a board, frame by frame, to one TCP client at a time and to watchers. Frames that are damaged stay out. A client whose
/// first bytes are no frame, or who tries numbers, is cut off, as by `trirrr device`.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
`trirrr bridge --port /dev/ttyACM0 --listen tcp:0.0.0.0:7333 --beyond-loopback --key FILE` puts a board on the network, for those who have \
the key. `trirrr bridge --port tcp:HOST:7333 --far-key FILE` is the way to it for clients that know no keys. Ctrl-C ends the bridge.")]
pub struct BridgeArgs {
    /// The board: /dev/tty..., or tcp:HOST:PORT
    #[arg(long, value_name = "PORT")]
    pub port: Address,
    /// Rate of a serial port
    #[arg(long, value_name = "BAUD", default_value_t = 921_600)]
    pub baud: u32,
    /// Key file of the board's port, if it is a TCP port that expects a key
    #[arg(long, value_name = "FILE")]
    pub far_key: Option<PathBuf>,
    /// Ports that clients and watchers connect to.
    #[command(flatten)]
    pub listen: ListenArgs,
}
