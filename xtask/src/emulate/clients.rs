//! The programs that talk to a board: `board-test`, `trirrr stream`, the Python client.

use super::board::Board;
use crate::client::{self, rounding};
use crate::programs::Programs;
use crate::qemu::wait;
use crate::repository::{SceneFile, root, target_directory};
use anyhow::{Context, Result, bail, ensure};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::time::Duration;

/// Far beyond what any of them needs: a job of some seconds on a board that is several times slower
/// than silicon.
const TIME_LIMIT: Duration = Duration::from_secs(400);

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

/// The programs, built.
pub(super) struct Clients(Programs);

impl Clients {
    pub(super) fn build() -> Result<Self> {
        Programs::build().map(Self)
    }

    fn board_test(&self, test: &str, scene: &SceneFile, scalar: &str, board: &Board) -> Command {
        let mut command = Command::new(&self.0.board_test);
        command
            .arg(test)
            .arg(&scene.path)
            .args(["--port", board.address(), "--scalar", scalar]);
        command
    }

    /// Homing and job, every value of every sample compared.
    pub(super) fn play(
        &self,
        scene: &SceneFile,
        scalar: &str,
        board: &Board,
        inputs: Option<HomingInputs>,
    ) -> Result<Played> {
        let mut command = self.board_test("play", scene, scalar, board);
        if let Some(inputs) = inputs {
            command.args(["--inputs", inputs.name()]);
        }
        let said = output(&mut command)?;
        println!("{} in {scalar}: {}", scene.name, said.trim_end());
        played(&said)
    }

    /// Random jobs over a bad line.
    pub(super) fn torture(
        &self,
        scene: &SceneFile,
        scalar: &str,
        board: &Board,
        frames: u64,
        seed: u64,
    ) -> Result<()> {
        let mut command = self.board_test("torture", scene, scalar, board);
        command.args(["--frames", &frames.to_string(), "--seed", &seed.to_string()]);
        let said = output(&mut command)?;
        println!("{} in {scalar}: {}", scene.name, said.trim_end());
        Ok(())
    }

    /// A client that goes in the middle of the job.
    pub(super) fn abandon(&self, scene: &SceneFile, scalar: &str, board: &Board) -> Result<()> {
        let said = output(&mut self.board_test("abandon", scene, scalar, board))?;
        println!("{} in {scalar}: {}", scene.name, said.trim_end());
        Ok(())
    }

    /// The board's log in words; what is no frame of the image's log is an error.
    pub(super) fn read_log(&self, image: &Path, log: &Path) -> Result<String> {
        output(
            Command::new(&self.0.board_test)
                .arg("log")
                .arg(image)
                .arg(log),
        )
    }

    /// Returns what the board says of itself, once it has failed.
    pub(super) fn report(&self, scene: &SceneFile, scalar: &str, board: &Board) -> Result<String> {
        output(&mut self.board_test("report", scene, scalar, board))
    }

    /// The table that `trirrr run` writes.
    pub(super) fn run(&self, scene: &SceneFile, scalar: &str) -> Result<PathBuf> {
        let out = folder(scene, scalar, "run");
        let mut command = Command::new(&self.0.trirrr);
        command.arg("run").arg(&scene.path);
        command
            .args(["--fast", "--scalar", scalar, "--out"])
            .arg(&out);
        output(&mut command)?;
        Ok(out.join("ticks.csv"))
    }

    /// The job with `trirrr stream`, whose table has to be the expected one.
    pub(super) fn stream(
        &self,
        scene: &SceneFile,
        scalar: &str,
        board: &Board,
        expected: &Path,
    ) -> Result<()> {
        let (mut command, out) = self.stream_command(scene, scalar, board);
        output(&mut command)?;
        // What the board sends, and what the same core computes from it: all in the bits.
        client::compare(expected, &out.join("ticks.csv"), 0.0).context("trirrr stream")
    }

    /// The same with the Python client, whose own columns may be some roundings off.
    pub(super) fn python(
        &self,
        scene: &SceneFile,
        scalar: &str,
        board: &Board,
        expected: &Path,
    ) -> Result<()> {
        let (mut command, out) = python_command(scene, scalar, board);
        output(&mut command)?;
        client::compare(expected, &out.join("ticks.csv"), rounding(scalar))
            .context("the Python client")
    }

    /// `trirrr stream` on a board whose homing fails: it has to say so.
    pub(super) fn stream_in_vain(
        &self,
        scene: &SceneFile,
        scalar: &str,
        board: &Board,
    ) -> Result<()> {
        let (command, _) = self.stream_command(scene, scalar, board);
        in_vain(command)
    }

    /// The same of the Python client.
    pub(super) fn python_in_vain(
        &self,
        scene: &SceneFile,
        scalar: &str,
        board: &Board,
    ) -> Result<()> {
        in_vain(python_command(scene, scalar, board).0)
    }

    fn stream_command(&self, scene: &SceneFile, scalar: &str, board: &Board) -> (Command, PathBuf) {
        let out = folder(scene, scalar, "stream");
        let mut command = Command::new(&self.0.trirrr);
        command.arg("stream").arg(&scene.path);
        command.args(["--port", board.address(), "--scalar", scalar]);
        command.args(["--telemetry", "1", "--out"]).arg(&out);
        (command, out)
    }
}

fn python_command(scene: &SceneFile, scalar: &str, board: &Board) -> (Command, PathBuf) {
    let out = folder(scene, scalar, "python");
    let mut command = Command::new("python3");
    command.args(["-m", "trirrr"]).arg(&scene.path);
    command.args(["--port", board.address(), "--scalar", scalar]);
    command.args(["--quiet", "--out"]).arg(&out);
    command.current_dir(root().join("clients/python"));
    (command, out)
}

/// Runs a client whose machine does not find the switch of its first motor.
fn in_vain(mut command: Command) -> Result<()> {
    let Err(error) = output(&mut command) else {
        bail!("{command:?} says nothing of homing that fails");
    };
    let said = format!("{error:#}");
    ensure!(said.contains(NOT_FOUND), "{said}");
    Ok(())
}

fn folder(scene: &SceneFile, scalar: &str, client: &str) -> PathBuf {
    let folder = target_directory().join("emulate");
    folder.join(format!("{}-{scalar}", scene.name)).join(client)
}

/// Returns what a command prints; its failure, with what it said, is an error.
fn output(command: &mut Command) -> Result<String> {
    let child = command
        .stdin(Stdio::null())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .with_context(|| format!("{command:?} cannot be started"))?;
    wait(child, TIME_LIMIT).with_context(|| format!("{command:?}"))
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
