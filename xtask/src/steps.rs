//! Steps of CI and of the nightly checks, run in order up to the first failure.

use crate::packages::choose_host;
use crate::repository::{cargo, root};
use anyhow::{Context, Result, bail};
use std::env;
use std::iter;
use std::path::Path;
use std::process::Command;
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

/// Runs all steps and prints the time of each.
pub(crate) fn run(steps: Vec<Step>) -> Result<()> {
    let start = Instant::now();
    for mut step in steps {
        println!("== {}", step.name);
        let begin = Instant::now();
        let status = step
            .command
            .status()
            .with_context(|| format!("{}: cannot be started", step.name))?;
        let time = seconds(begin.elapsed());
        if !status.success() {
            bail!(
                "{} failed after {time} ({status}): {}",
                step.name,
                step.line()
            );
        }
        println!("== {}: passed, {time}", step.name);
    }
    println!("== everything passed, {}", seconds(start.elapsed()));
    Ok(())
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
