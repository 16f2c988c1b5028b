//! The programs that talk to a board: `board-test`, `trirrr stream`, the Python client.

use super::Built;
use super::board::Board;
use crate::client::{self, cleared, planned_moves, rounding};
use crate::programs::Programs;
use crate::qemu;
use crate::repository::{root, target_directory};
use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Duration;

/// Far beyond what any of them needs: a job of some seconds on a board that is several times slower
/// than silicon.
const TIME_LIMIT: Duration = Duration::from_secs(400);

fn output(command: &mut Command) -> Result<String> {
    qemu::output(command, TIME_LIMIT)
}

/// Message of a client about the first motor's switch, which is never found.
const NOT_FOUND: &str = "homing: motor 1 has not found its switch or stop within";

/// Figures that `board-test play` saw.
pub(super) struct Played {
    pub(super) ticks: u64,
    pub(super) samples: u64,
    pub(super) lost: u64,
    /// The longest tick without an interrupt of the line, counts of the board's timer.
    pub(super) longest: u32,
}

/// Behaviour of the board's inputs of homing.
#[derive(Clone, Copy)]
pub(super) enum HomingInputs {
    /// They never close: in an emulator they are low, and a switch that is closed when low is in no
    /// scene that ships.
    Open,
    /// They close by rule, in images that are built with them.
    Switches,
}

impl HomingInputs {
    /// As `board-test` calls them.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Open => "open",
            Self::Switches => "switches",
        }
    }
}

/// Client of a board that plays the scene's job and writes a table.
#[derive(Clone, Copy, PartialEq)]
pub(super) enum JobClient {
    Stream,
    Python,
}

/// The programs, built.
pub(super) struct Clients(Programs);

impl Clients {
    pub(super) fn build() -> Result<Self> {
        Programs::build().map(Self)
    }

    /// Runs a part of `board-test` and returns what it says.
    pub(super) fn test(
        &self,
        part: &str,
        built: &Built,
        board: &Board,
        arguments: &[&str],
    ) -> Result<String> {
        let mut command = Command::new(&self.0.board_test);
        command.arg(part).arg(&built.scene.path);
        command.args(["--port", board.address(), "--scalar", built.scalar]);
        output(command.args(arguments))
    }

    /// The same, printed with the name of the scene.
    pub(super) fn show(
        &self,
        part: &str,
        built: &Built,
        board: &Board,
        arguments: &[&str],
    ) -> Result<String> {
        let said = self.test(part, built, board, arguments)?;
        println!("{built}: {}", said.trim_end());
        Ok(said)
    }

    /// A raster image of so many seconds, the power of every sample compared; printed with the name of the scene.
    pub(super) fn burn(&self, built: &Built, board: &Board, seconds: u32) -> Result<()> {
        self.show_long("raster", built, board, seconds, &[])
    }

    /// A job of so many seconds that is cut off again and again, every sample compared; printed with the name of the scene.
    pub(super) fn cut(&self, built: &Built, board: &Board, cuts: u32, seconds: u32) -> Result<()> {
        let cuts = cuts.to_string();
        self.show_long("cuts", built, board, seconds, &["--cuts", &cuts])
    }

    fn show_long(
        &self,
        part: &str,
        built: &Built,
        board: &Board,
        seconds: u32,
        arguments: &[&str],
    ) -> Result<()> {
        let mut command = Command::new(&self.0.board_test);
        command.arg(part).arg(&built.scene.path);
        command.args(["--port", board.address(), "--scalar", built.scalar]);
        command.args(["--seconds", &seconds.to_string()]);
        // An emulator on a busy host is slower than silicon.
        let limit = TIME_LIMIT + 4 * Duration::from_secs(seconds.into());
        let said = qemu::output(command.args(arguments), limit)?;
        println!("{built}: {}", said.trim_end());
        Ok(())
    }

    /// Homing and job, every value of every sample compared.
    pub(super) fn play(&self, built: &Built, board: &Board) -> Result<Played> {
        let inputs = built.inputs.map(|inputs| ["--inputs", inputs.name()]);
        played(&self.show("play", built, board, inputs.as_slice().as_flattened())?)
    }

    /// The job with another mass of the platform, on an adjustable board.
    pub(super) fn play_with_mass(&self, built: &Built, board: &Board, mass: &str) -> Result<()> {
        self.show("play", built, board, &["--mass-kg", mass])?;
        Ok(())
    }

    /// The board's log in words; what is no frame of the image's log is an error.
    pub(super) fn read_log(&self, image: &Path, log: &Path) -> Result<String> {
        output(
            Command::new(&self.0.board_test)
                .arg("log")
                .args([image, log]),
        )
    }

    /// The table that `trirrr run` writes.
    pub(super) fn run(&self, built: &Built) -> Result<PathBuf> {
        let out = cleared(folder(built, "run"))?;
        let mut command = Command::new(&self.0.trirrr);
        command.arg("run").arg(&built.scene.path);
        command.args(["--fast", "--scalar", built.scalar, "--out"]);
        output(command.arg(&out))?;
        Ok(out.join("ticks.csv"))
    }

    /// The job with `client`, whose table has to be the `expected` one. Without one the board's homing
    /// fails, and the client has to say so.
    pub(super) fn follow(
        &self,
        client: JobClient,
        built: &Built,
        board: &Board,
        expected: Option<&Path>,
    ) -> Result<()> {
        let (name, mut command, tolerance) = match client {
            // What the board sends, and what the same core computes from it: all in the bits.
            JobClient::Stream => ("stream", Command::new(&self.0.trirrr), 0.0),
            // Its own columns may be some roundings off.
            JobClient::Python => ("python", Command::new("python3"), rounding(built.scalar)),
        };
        match client {
            JobClient::Stream => command.args(["stream", "--telemetry", "1"]),
            JobClient::Python => command
                .args(["-m", "trirrr", "--quiet"])
                .current_dir(root().join("clients/python")),
        };
        let out = cleared(folder(built, name))?;
        command.arg(&built.scene.path);
        if client == JobClient::Python {
            let scene = &built.scene.path;
            if let Some(moves) =
                planned_moves(&self.0.trirrr, scene, &cleared(folder(built, "plan"))?)?
            {
                command.arg("--moves").arg(moves);
            }
        }
        command.args(["--port", board.address(), "--scalar", built.scalar, "--out"]);
        let ended = output(command.arg(&out));
        match (expected, ended) {
            (Some(expected), ended) => {
                ended?;
                client::compare(expected, &out.join("ticks.csv"), tolerance).context(name)
            }
            (None, Ok(_)) => bail!("{command:?} says nothing of homing that fails"),
            (None, Err(error)) => {
                let said = format!("{error:#}");
                ensure!(said.contains(NOT_FOUND), "{said}");
                Ok(())
            }
        }
    }
}

fn folder(built: &Built, client: &str) -> PathBuf {
    let folder = target_directory().join("emulate");
    let name = format!("{}-{}", built.scene.name, built.scalar);
    folder.join(name).join(client)
}

/// Reads the line that `board-test play` prints.
fn played(said: &str) -> Result<Played> {
    let before = |what: &str| {
        let (left, _) = said.split_once(what)?;
        left.split_whitespace().next_back()?.parse::<u64>().ok()
    };
    let read = || {
        Some(Played {
            ticks: before(" ticks,")?,
            samples: before(" samples identical")?,
            longest: u32::try_from(before(" counts,")?).ok()?,
            lost: before(" lost;")?,
        })
    };
    read().with_context(|| format!("board-test says: {said}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_figures_of_a_job_are_read() {
        let said = "100 ticks, 102 samples identical in 27 values, 12 at rest before them, 0 lost; of \
                    90 ticks without an interrupt of the line the longest took 4301 counts, of all \
                    5000\n";
        let played = played(said).expect("well formed");
        assert_eq!((played.ticks, played.samples), (100, 102));
        assert_eq!((played.longest, played.lost), (4301, 0));
        assert!(super::played("").is_err());
    }
}
