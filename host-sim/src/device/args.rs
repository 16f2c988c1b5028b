//! Arguments of `trirrr device`.

use super::inputs::{Press, Wall};
use crate::arguments::{DEFAULT_SCENE, SetArgs, factor, number_type};
use crate::serve::ListenArgs;
use clap::Args;
use std::path::PathBuf;
use trirrr_scene::NumberType;

/// `trirrr device`.
///
/// Listens for one client at a time and answers it as a board with the scene's image would: same
/// service, same wire, same bits. Says on standard output where it listens, who comes and goes, what
/// the machine does and what it refuses.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Ctrl-C ends the device. A client that is lost leaves the machine to the scene's host timeout: it \
comes to rest on its path. The client may come back and go on. Without a key every program on this computer may command the machine.")]
pub struct DeviceArgs {
    /// The scene, a TOML file
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// Values in place of those of the scene.
    #[command(flatten)]
    pub set: SetArgs,
    /// Ports that clients and watchers connect to.
    #[command(flatten)]
    pub listen: ListenArgs,
    /// Number type to compute in [default: the scene's]
    #[arg(long, value_parser = number_type())]
    pub scalar: Option<NumberType>,
    /// The machine's seconds per second of real time: 10 for ten times as fast. The scene's host timeout stays in real time
    #[arg(long, value_name = "FACTOR", default_value = "1", value_parser = factor)]
    pub speed: f64,
    /// In a scene with homing, how far the motors are from where the machine counts from when it is
    /// switched on, rad [default: one of its own for each scene]; in one with feedback, from the start of the job [default: 0]
    #[arg(
        long,
        value_names = ["A", "B", "C"],
        num_args = 3
    )]
    pub offset_rad: Option<Vec<f64>>,
    /// Press an input of the scene: `estop@1.5` from 1.5 s on, `door@2..4` from 2 s to 4 s of the machine's time; also `probe` and
    /// `limit1` to `limit3`; repeat for more
    #[arg(long, value_name = "INPUT@FROM[..TO]")]
    pub press: Vec<Press>,
    /// Wall that the probe of the scene touches: from `x=0.25` on, seen from the start of the job, the probe at D touches, m
    #[arg(long, value_name = "AXIS=METRES")]
    pub touch: Option<Wall>,
    /// Press inputs by lines on standard input: estop (e), door (d), probe (p) and limit1 to limit3 change what they name
    #[arg(long)]
    pub keys: bool,
}
