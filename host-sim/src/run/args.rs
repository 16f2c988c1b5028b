//! Arguments of `trirrr run`.

use crate::arguments::{DEFAULT_SCENE, number_type};
use crate::job_file::JobFileArgs;
use crate::pictures::PictureArgs;
use clap::Args;
use std::path::PathBuf;
use trirrr_scene::NumberType;

/// `trirrr run`.
///
/// Plays the job through the machine's service, in real time against absolute deadlines, and reports
/// how well they were kept.
/// Writes ticks.csv (one row per tick, SI units), the figures as SVG, and animation.html. Plays scenes of redundant machines too, in
/// f64 and without a service.
#[derive(Args, Clone, Debug)]
#[command(after_help = "\
Ctrl-C ends the run cleanly: what was computed so far is written. So does a move that the machine \
refuses (unreachable, singular, beyond a limit); the move, the leg or motor and the time in it are \
named. `trirrr check SCENE.toml --figure refused.svg` draws a job that is refused.")]
pub struct RunArgs {
    /// The scene, a TOML file; or with --machine a job: G-code, a drawing (SVG, DXF), an image, a table of poses (CSV)
    #[arg(default_value = DEFAULT_SCENE)]
    pub scene: PathBuf,
    /// More of them, played one after the other; all are read and planned before the first is played
    pub then: Vec<PathBuf>,
    /// The job in a file of its own.
    #[command(flatten)]
    pub job: JobFileArgs,
    /// Compute as fast as it goes instead of in real time
    #[arg(long)]
    pub fast: bool,
    /// Folder for what is written, made if missing; results of an earlier run go with the first tick
    /// [default: out/NAME, after the scene's name]. Of several jobs each has a folder in it
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write the first of so many ticks into ticks.csv; figures, peaks and loads are of all
    #[arg(long, value_name = "TICKS", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..))]
    pub every: u32,
    /// Number type to compute in [default: the scene's]
    #[arg(long, value_parser = number_type())]
    pub scalar: Option<NumberType>,
    /// Print one JSON object instead of text
    #[arg(long)]
    pub json: bool,
    /// After the run, bound the error at the tool and the torques for every machine within the
    /// scene's `[tolerances]`: prints the worst, writes tolerances.csv, tolerance_budget.csv and figures
    #[arg(long)]
    pub tolerances: bool,
    /// Add the torques by Lagrange's equations to ticks.csv, in 31 digits, and the largest difference to the summary. Takes
    /// milliseconds a row
    #[arg(long)]
    pub lagrange: bool,
    /// Figures as PNG.
    #[command(flatten)]
    pub pictures: PictureArgs,
}

impl Default for RunArgs {
    /// Arguments of `trirrr run` where none is given.
    fn default() -> Self {
        Self {
            scene: DEFAULT_SCENE.into(),
            then: Vec::new(),
            every: 1,
            job: JobFileArgs::default(),
            fast: false,
            out: None,
            scalar: None,
            json: false,
            tolerances: false,
            lagrange: false,
            pictures: PictureArgs::default(),
        }
    }
}
