//! Steps of CI and of the nightly checks, run in order up to the first failure.

use crate::packages::choose_host;
use crate::repository::{cargo, root};
use anyhow::{Context, Result, bail};
use std::env;
use std::io;
use std::iter;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::{Duration, Instant};

pub(crate) struct Step {
    pub(crate) name: String,
    pub(crate) command: Command,
}

impl Step {
    pub(crate) fn new(name: impl Into<String>, command: Command) -> Self {
        let name = name.into();
        Self { name, command }
    }

    /// Cargo with `arguments`.
    pub(crate) fn cargo(name: impl Into<String>, arguments: &[&str]) -> Self {
        let mut command = cargo();
        command.args(arguments);
        Self::new(name, command)
    }

    /// A chore of this program. What runs is this very file: cargo would build it again, with other features.
    pub(crate) fn chore(name: impl Into<String>, arguments: &[&str]) -> Result<Self> {
        let mut command = Command::new(env::current_exe().context("this program has no path")?);
        command.current_dir(root()).args(arguments);
        Ok(Self::new(name, command))
    }

    /// Cargo's `command` about every package that is for a host, with `arguments` behind.
    pub(crate) fn on_host(name: &str, command: &str, arguments: &[&str]) -> Self {
        let mut step = Self::cargo(name, &[command]);
        choose_host(&mut step.command);
        step.command.args(arguments);
        step
    }

    /// Runs the step; what it prints is seen at once.
    fn run(mut self) -> Result<()> {
        println!("== {}", self.name);
        let begin = Instant::now();
        let status = self.command.status();
        self.judge(status, begin)
    }

    /// Runs the step and prints what it printed when it ends.
    fn run_quietly(mut self) -> Result<()> {
        let begin = Instant::now();
        let output = self.command.stdin(Stdio::null()).output();
        let status = output.map(|output| {
            print!(
                "== {}\n{}{}",
                self.name,
                String::from_utf8_lossy(&output.stdout),
                String::from_utf8_lossy(&output.stderr)
            );
            output.status
        });
        self.judge(status, begin)
    }

    /// Prints the time of a step that passed; the error of one that did not.
    fn judge(&self, status: io::Result<ExitStatus>, begin: Instant) -> Result<()> {
        let name = &self.name;
        let status = status.with_context(|| format!("{name}: cannot be started"))?;
        let time = seconds(begin.elapsed());
        if !status.success() {
            bail!("{name} failed after {time} ({status}): {}", self.line());
        }
        println!("== {name}: passed, {time}");
        Ok(())
    }

    /// The command as it is typed in the root.
    fn line(&self) -> String {
        let program = Path::new(self.command.get_program());
        let is_chore = env::current_exe().is_ok_and(|this| this == program);
        // Cargo is called by its path.
        let name = program.file_name().unwrap_or_default().to_string_lossy();
        let name = if is_chore { "cargo xtask".into() } else { name };
        let arguments = self.command.get_args().map(|word| word.to_string_lossy());
        let words: Vec<_> = iter::once(name).chain(arguments).collect();
        format!("{} (in {})", words.join(" "), root().display())
    }
}

/// A part of the checks.
pub(crate) enum Stage {
    /// A step by itself: it needs both cores, or a machine that does nothing else.
    Alone(Step),
    /// Two sequences at a time, of steps that leave a core idle. Steps of the second print when they end.
    Beside([Vec<Step>; 2]),
}

impl Stage {
    pub(crate) fn steps_mut(&mut self) -> Vec<&mut Step> {
        match self {
            Self::Alone(step) => vec![step],
            Self::Beside(sequences) => sequences.iter_mut().flatten().collect(),
        }
    }
}

impl From<Step> for Stage {
    fn from(step: Step) -> Self {
        Self::Alone(step)
    }
}

/// Runs all stages and prints the time of each step.
pub(crate) fn run(stages: impl IntoIterator<Item = impl Into<Stage>>) -> Result<()> {
    let start = Instant::now();
    for stage in stages {
        match stage.into() {
            Stage::Alone(step) => step.run()?,
            Stage::Beside(sequences) => run_beside(sequences)?,
        }
    }
    println!("== everything passed, {}", seconds(start.elapsed()));
    Ok(())
}

/// Runs two sequences at a time. After a failure the other one ends with the step that it is at.
fn run_beside([first, second]: [Vec<Step>; 2]) -> Result<()> {
    let failed = AtomicBool::new(false);
    let sequence = |steps: Vec<Step>, run: fn(Step) -> Result<()>| {
        for step in steps {
            if failed.load(Ordering::Relaxed) {
                break;
            }
            run(step).inspect_err(|_| failed.store(true, Ordering::Relaxed))?;
        }
        Ok(())
    };
    thread::scope(|scope| {
        let beside = scope.spawn(|| sequence(second, Step::run_quietly));
        let first = sequence(first, Step::run);
        let second = beside.join().expect("steps do not panic");
        first.and(second)
    })
}

fn seconds(time: Duration) -> String {
    format!("{:.1} s", time.as_secs_f64())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_step_can_be_repeated_from_its_message() {
        let step = Step::cargo("tests", &["test", "-p", "xtask"]);
        assert!(step.line().starts_with("cargo test -p xtask (in "));
        let step = Step::chore("shape", &["house", "--check"]).expect("a path");
        assert!(step.line().starts_with("cargo xtask house --check (in "));
    }

    #[test]
    fn a_failure_names_its_step_and_ends_the_run() {
        let shell = |name: &str, script: &str| {
            let mut command = Command::new("sh");
            command.args(["-c", script]);
            Step::new(name, command)
        };
        let failure = run(vec![shell("good", "exit 0"), shell("bad", "exit 3")]);
        let text = failure.expect_err("exit status 3").to_string();
        assert!(text.starts_with("bad failed after"), "{text}");
        assert!(run(vec![shell("good", "exit 0")]).is_ok());
    }
}
