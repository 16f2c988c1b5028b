//! Parts of the nightly checks that have run: commit, seconds and result, kept in a file, so that a run that was cut off goes on.

use crate::repository::{root, target_directory, text};
use crate::steps::Step;
use anyhow::{Context, Result};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{self, File};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::Mutex;
use std::time::Instant;

/// End of a part.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Ended {
    /// Commit, with `+` where files were changed since.
    commit: String,
    seconds: f64,
    passed: bool,
}

/// Ends of all parts, by name.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(super) struct Record(BTreeMap<String, Ended>);

/// Folder of the record and of what the parts print.
fn folder() -> PathBuf {
    target_directory().join("nightly")
}

impl Record {
    /// Reads what earlier runs have written.
    pub(super) fn read() -> Result<Self> {
        match fs::read_to_string(folder().join("record.json")) {
            Ok(text) => serde_json::from_str(&text)
                .context("target/nightly/record.json: damaged; delete it"),
            Err(_) => Ok(Self::default()),
        }
    }

    fn write(&self) -> Result<()> {
        let file = folder().join("record.json");
        let text = serde_json::to_string_pretty(self)?;
        fs::write(&file, text).with_context(|| file.display().to_string())
    }

    /// Returns true if the part has passed on `commit`, of which every file is as it was.
    pub(super) fn has_passed(&self, part: &str, commit: &str) -> bool {
        let ended = self.0.get(part);
        ended.is_some_and(|ended| ended.passed && ended.commit == commit && !commit.ends_with('+'))
    }

    /// Names of `parts` that have failed in their last run, or were never run.
    pub(super) fn not_passed<'a>(&self, parts: &[&'a str]) -> Vec<&'a str> {
        let passed = |part: &str| self.0.get(part).is_some_and(|ended| ended.passed);
        parts.iter().copied().filter(|part| !passed(part)).collect()
    }

    /// Table of `parts`, as Markdown.
    pub(super) fn table(&self, parts: &[&str]) -> String {
        let row = |part: &&str| match self.0.get(*part) {
            Some(Ended {
                commit,
                seconds,
                passed,
            }) => {
                let result = if *passed { "passed" } else { "**failed**" };
                format!("| {part} | {commit} | {seconds:.0} | {result} |\n")
            }
            None => format!("| {part} | | | not run |\n"),
        };
        let rows: String = parts.iter().map(row).collect();
        format!("| part | commit | seconds | result |\n|---|---|---|---|\n{rows}")
    }
}

/// Commit of the sources, with `+` where files were changed since.
pub(super) fn commit() -> Result<String> {
    let git = |arguments: &[&str]| text(Command::new("git").current_dir(root()).args(arguments));
    let commit = git(&["rev-parse", "--short=8", "HEAD"])?;
    let is_changed = !git(&["status", "--porcelain"])?.trim().is_empty();
    Ok(format!(
        "{}{}",
        commit.trim(),
        if is_changed { "+" } else { "" }
    ))
}

/// Runs `steps`, `lanes` at a time, to the last one whatever fails. Each end is written at once.
pub(super) fn run(steps: Vec<Step>, lanes: usize, record: Record, commit: &str) -> Result<Record> {
    fs::create_dir_all(folder())?;
    let (waiting, record) = (Mutex::new(steps.into_iter()), Mutex::new(record));
    let lane = || -> Result<()> {
        loop {
            let next = waiting.lock().expect("no lane panics").next();
            let Some(step) = next else {
                return Ok(());
            };
            let (name, ended) = end_of(step, commit)?;
            let result = if ended.passed { "passed" } else { "FAILED" };
            println!("== {name}: {result}, {:.0} s", ended.seconds);
            let mut record = record.lock().expect("no lane panics");
            record.0.insert(name, ended);
            record.write()?;
        }
    };
    std::thread::scope(|scope| {
        let lanes: Vec<_> = (0..lanes).map(|_| scope.spawn(lane)).collect();
        lanes
            .into_iter()
            .try_for_each(|lane| lane.join().expect("no lane panics"))
    })?;
    Ok(record.into_inner().expect("no lane panics"))
}

/// Runs a part. What it prints goes into a file.
fn end_of(step: Step, commit: &str) -> Result<(String, Ended)> {
    let Step { name, mut command } = step;
    let log = folder().join(format!("{}.log", file_name(&name)));
    println!("== {name}: begins, {}", log.display());
    let file = File::create(&log).with_context(|| log.display().to_string())?;
    command
        .stdin(Stdio::null())
        .stdout(file.try_clone()?)
        .stderr(file);
    let begin = Instant::now();
    let status = command.status();
    let status = status.with_context(|| format!("{name}: cannot be started"))?;
    let ended = Ended {
        commit: commit.into(),
        seconds: begin.elapsed().as_secs_f64(),
        passed: status.success(),
    };
    Ok((name, ended))
}

/// Name of a part as that of a file.
fn file_name(part: &str) -> String {
    let kept = |letter: char| {
        if letter.is_ascii_alphanumeric() {
            letter
        } else {
            '-'
        }
    };
    part.chars().map(kept).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ended(commit: &str, passed: bool) -> Ended {
        Ended {
            commit: commit.into(),
            seconds: 61.4,
            passed,
        }
    }

    #[test]
    fn a_part_that_has_passed_on_the_same_sources_is_not_run_again() {
        let ends = [
            ("good", ended("0123abcd", true)),
            ("bad", ended("0123abcd", false)),
            ("changed", ended("0123abcd+", true)),
        ];
        let record = Record(ends.map(|(name, ended)| (name.into(), ended)).into());
        assert!(record.has_passed("good", "0123abcd"));
        assert!(!record.has_passed("good", "ffffffff"));
        assert!(!record.has_passed("bad", "0123abcd"));
        // Nobody knows whether the files are still those.
        assert!(!record.has_passed("changed", "0123abcd+"));
        assert!(!record.has_passed("never", "0123abcd"));
        assert_eq!(
            record.not_passed(&["good", "bad", "never"]),
            ["bad", "never"]
        );
    }

    #[test]
    fn the_table_has_every_part() {
        let record = Record([("one".into(), ended("0123abcd", true))].into());
        assert_eq!(
            record.table(&["one", "two"]),
            "| part | commit | seconds | result |\n|---|---|---|---|\n\
             | one | 0123abcd | 61 | passed |\n| two | | | not run |\n"
        );
    }

    #[test]
    fn a_part_ends_with_its_result_and_what_it_printed() {
        let mut command = Command::new("sh");
        command.args(["-c", "echo said; exit 3"]);
        fs::create_dir_all(folder()).expect("a folder");
        let step = Step::new("a part of the test: fails", command);
        let (name, ended) = end_of(step, "0123abcd").expect("started");
        assert_eq!(
            (name.as_str(), ended.passed),
            ("a part of the test: fails", false)
        );
        let log = folder().join("a-part-of-the-test--fails.log");
        assert_eq!(fs::read_to_string(&log).expect("a log"), "said\n");
        fs::remove_file(log).expect("removed");
    }
}
