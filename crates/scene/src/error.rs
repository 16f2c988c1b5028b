//! Reasons for which a scene is refused.

use crate::visible;
use std::fmt;
use std::path::PathBuf;

/// One thing that is wrong with a scene: where, what, and why.
///
/// Displayed as `12: machine.leg[1].distal_m = -0.2: must be greater than 0 (m)`. Legs, moves and
/// drives are counted from 1, in keys as in reasons. What the file says is [visible](visible()): it commands no terminal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Problem {
    /// Name of another file or of the argument, if the problem is not in the file of the scene.
    pub source: Option<String>,
    /// Line in the file, from 1; 0 in an argument. For a missing key, the line of the table it is missing from.
    pub line: usize,
    /// Column of the value in the line, in characters from 1; for a missing key, that of its table.
    pub column: usize,
    /// Path of the key, such as `job.move[2].duration_s`; empty where a line is no TOML at all.
    pub key: String,
    /// The offending value as the file has it, shortened to one line; `None` where there is none.
    pub value: Option<String>,
    /// Description of what is wrong with it, and where it helps, of what would be right.
    pub reason: String,
}

impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.line {
            0 => write!(f, " ")?,
            line => write!(f, "{line}: ")?,
        }
        if !self.key.is_empty() {
            write!(f, "{}", visible(&self.key))?;
            if let Some(value) = &self.value {
                write!(f, " = {}", visible(value))?;
            }
            write!(f, ": ")?;
        }
        write!(f, "{}", visible(&self.reason))
    }
}

/// A scene that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum SceneError {
    /// The file cannot be read.
    #[error("{}: cannot be read: {reason}", visible(&file.display().to_string()))]
    Unreadable {
        /// The file.
        file: PathBuf,
        /// The reason. It is part of the message, so it is not repeated as the error's source.
        reason: std::io::Error,
    },
    /// The file was read and something in it is wrong.
    #[error("{}", list(file, problems))]
    Refused {
        /// The file's name as it was given.
        file: String,
        /// Everything found wrong, in the order of the file; at least one.
        problems: Vec<Problem>,
    },
}

/// One line per problem, each with the file's name in the form that editors can jump to.
fn list(file: &str, problems: &[Problem]) -> String {
    let lines = problems.iter().map(|problem| {
        let file = problem.source.as_deref().unwrap_or(file);
        format!("{}:{problem}", visible(file))
    });
    let lines: Vec<String> = lines.collect();
    lines.join("\n")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_problem_has_a_line_of_its_own_with_the_file_name() {
        let problem = |line, value: Option<&str>| Problem {
            source: None,
            line,
            column: 1,
            key: "platform.mass_kg".into(),
            value: value.map(Into::into),
            reason: "must not be negative (kg)".into(),
        };
        let error = SceneError::Refused {
            file: "a.toml".into(),
            problems: vec![problem(3, Some("-1")), problem(7, None)],
        };
        assert_eq!(
            error.to_string(),
            "a.toml:3: platform.mass_kg = -1: must not be negative (kg)\n\
             a.toml:7: platform.mass_kg: must not be negative (kg)"
        );
    }

    #[test]
    fn a_file_commands_no_terminal() {
        let hostile = || "\u{1b}[31m\u{9b}\n\u{7f}".to_owned();
        let problem = Problem {
            source: None,
            line: 3,
            column: 1,
            key: hostile(),
            value: Some(hostile()),
            reason: hostile(),
        };
        let error = SceneError::Refused {
            file: hostile(),
            problems: vec![problem],
        };
        let unreadable = SceneError::Unreadable {
            file: hostile().into(),
            reason: std::io::ErrorKind::NotFound.into(),
        };
        for (said, times) in [(error.to_string(), 4), (unreadable.to_string(), 1)] {
            assert!(!said.contains(char::is_control), "{said:?}");
            assert_eq!(
                said.matches(r"\u{1b}[31m\u{9b}\u{a}\u{7f}").count(),
                times,
                "{said}"
            );
        }
    }

    #[test]
    fn a_problem_without_a_key_is_just_line_and_reason() {
        let problem = Problem {
            source: None,
            line: 9,
            column: 1,
            key: String::new(),
            value: None,
            reason: "not TOML".into(),
        };
        assert_eq!(problem.to_string(), "9: not TOML");
    }
}
