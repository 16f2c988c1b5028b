//! Tests of a board over its line, whatever is behind it: hardware, an emulator, `trirrr device`.
//!
//! ```sh
//! cargo run --release -p trirrr-board-tests -- play scenes/thesis.toml --port tcp:127.0.0.1:7333
//! ```
//! The board has to be freshly reset, and the one that has the line to it.
#![forbid(unsafe_code)]

mod conversation;
mod cuts;
mod expected;
mod log;
mod play;
mod port;
mod raster;
mod report;
mod torture;

use anyhow::{Context, Result};
use clap::{Args, Parser, Subcommand};
use expected::{Expected, HomingInputs};
use std::path::PathBuf;
use std::time::Duration;
use trirrr_client::local::HostNumber;
use trirrr_line::Address;
use trirrr_scene::{NumberType, Scene, in_number_type};

#[derive(Parser)]
#[command(about = "Tests of a board over its line")]
struct Cli {
    #[command(subcommand)]
    test: Test,
}

#[derive(Subcommand)]
enum Test {
    /// Home the board where the scene has homing and play the scene's job, with a sample of every
    /// tick, and compare all that the samples say
    Play {
        #[command(flatten)]
        board: Board,
        /// What its inputs of homing do
        #[arg(long, value_enum, default_value_t = HomingInputs::Switches)]
        inputs: HomingInputs,
        /// Give the platform this mass first, kg: the scene has to be adjustable
        #[arg(long)]
        mass_kg: Option<f64>,
    },
    /// Play random jobs over a line that damages frames in both directions
    Torture {
        #[command(flatten)]
        board: Board,
        /// Frames until the last job begins
        #[arg(long, default_value_t = 20_000)]
        frames: u64,
        /// Of 100 frames, how many are damaged
        #[arg(long, default_value_t = 20)]
        percent: u64,
        /// Seed of jobs and damage
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Leave the board at random places of the job, which is played over and over, and go on with another client: at once, or once
    /// the board has waited
    Cuts {
        #[command(flatten)]
        board: Board,
        /// Times that the board is left
        #[arg(long, default_value_t = 10)]
        cuts: u32,
        /// Least duration of the job, s
        #[arg(long, default_value_t = 30.0)]
        seconds: f64,
        /// Seed of the places
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Burn a raster image of 0.1 mm pixels at 100 mm/s, each with another power than the one before, with a sample of every tick,
    /// and compare the power at each place
    Raster {
        #[command(flatten)]
        board: Board,
        /// Duration of the job, s
        #[arg(long, default_value_t = 6.0)]
        seconds: f64,
        /// Seed of the powers
        #[arg(long, default_value_t = 1)]
        seed: u64,
    },
    /// Print why the board started and which fault it has latched, once it has failed
    Report(Board),
    /// Print the log that came out of the board's second serial port
    Log {
        /// The image
        elf: PathBuf,
        /// What came out
        log: PathBuf,
    },
}

#[derive(Args)]
struct Board {
    /// The scene that the board's image was built from
    scene: PathBuf,
    /// /dev/tty... or tcp:HOST:PORT
    #[arg(long)]
    port: Address,
    /// Rate of a serial port
    #[arg(long, default_value_t = 921_600)]
    baud: u32,
    /// Number type of the image [default: the scene's]
    #[arg(long)]
    scalar: Option<NumberType>,
    /// Seconds that a freshly reset board may take to answer
    #[arg(long, default_value_t = 20.0)]
    patience: f64,
}

fn main() -> Result<()> {
    let Cli { test } = Cli::parse();
    let board = match &test {
        Test::Play { board, .. }
        | Test::Torture { board, .. }
        | Test::Raster { board, .. }
        | Test::Cuts { board, .. }
        | Test::Report(board) => board,
        Test::Log { elf, log } => return log::print(elf, log),
    };
    let scene = Scene::read(&board.scene).context("the scene")?;
    let number = board.scalar.unwrap_or(scene.number);
    in_number_type!(number, N => run::<N>(&test, board, &scene))
}

fn run<N: HostNumber>(test: &Test, board: &Board, scene: &Scene) -> Result<()> {
    let expected = || Expected::<N>::of(scene);
    let port = port::Port::open(
        &board.port,
        board.baud,
        Duration::from_secs_f64(board.patience),
    )?;
    match test {
        Test::Play {
            inputs, mass_kg, ..
        } => play::run(expected()?, port, *inputs, *mass_kg),
        Test::Cuts {
            cuts,
            seconds,
            seed,
            ..
        } => cuts::run::<N>(scene, port, *cuts, *seconds, *seed),
        Test::Report(_) => report::run(&expected()?, port, Duration::from_secs_f64(board.patience)),
        Test::Torture {
            frames,
            percent,
            seed,
            ..
        } => torture::run(&expected()?, port, *frames, *percent, *seed),
        Test::Raster { seconds, seed, .. } => raster::run(&expected()?, port, *seconds, *seed),
        // Needs no board.
        Test::Log { .. } => Ok(()),
    }
}
