//! Tool paths of the files that users have: G-code, drawings, raster images, tables of poses.
//!
//! A tool path is a chain of [`Element`]s: motions of the tool point, and stands between them. Nothing here knows a
//! machine: limits, reach and durations come when the path is planned.
// The example of the README is a test.
#![cfg_attr(doctest, doc = include_str!("../README.md"))]
#![forbid(unsafe_code)]

pub mod drawing;
pub mod gcode;
#[cfg(feature = "raster")]
pub mod raster;
pub mod table;

use std::fmt;

/// Place of the platform: x and y of the tool point in the fixed frame, m, and alpha, rad, counter-clockwise positive.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ToolPlace {
    /// x and y, m.
    pub position_m: [f64; 2],
    /// Angle of the platform, rad.
    pub alpha_rad: f64,
}

/// One element of a tool path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Element {
    /// Line of the file, from 1, or number of the shape, of the row in a table, of the run of an image.
    pub line: u32,
    /// Work of the tool in it. None: it is off.
    pub tool: Option<ToolWork>,
    /// Motion, or a stand.
    pub act: Act,
}

/// Act of an element.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Act {
    /// The tool point moves.
    Motion(ToolMotion),
    /// The machine stands for so many seconds, positive.
    Dwell {
        /// Duration, s.
        seconds: f64,
    },
    /// The machine stands until the user goes on (M0).
    Pause,
    /// An output of the machine goes on or off.
    Output(OutputAct),
    /// The machine stands until one of its inputs is as the program wants it (M66).
    Input(InputAct),
}

/// Wait for an input.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InputAct {
    /// Number of the input, from 0, below 8.
    pub index: u8,
    /// End of the wait.
    pub until: InputChange,
    /// Longest wait, s, positive.
    pub timeout_s: f64,
}

/// Change or level of an input that ends a wait.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputChange {
    /// It goes on (L1).
    Rise,
    /// It goes off (L2).
    Fall,
    /// It is on (L3).
    High,
    /// It is off (L4).
    Low,
}

/// Change of an output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputAct {
    /// Number of the output, from 0, below 8.
    pub index: u8,
    /// True: it goes on.
    pub on: bool,
    /// True: as the next motion begins (M62, M63). False: where the path stands, at rest (M64, M65).
    pub with_motion: bool,
}

/// Motion of the tool point from where the path stands. Alpha goes evenly with the way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolMotion {
    /// Curve in the plane.
    pub curve: ToolCurve,
    /// End of the motion.
    pub to: ToolPlace,
    /// Greatest speed of the tool point, m/s, positive. None: as fast as the machine may (a rapid).
    pub feed_m_s: Option<f64>,
    /// The motion ends at rest, even where the next one goes on in its direction.
    pub stops: bool,
}

/// Curve of a motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToolCurve {
    /// Straight line. The tool point may stand while alpha turns.
    Line,
    /// Arc of a circle.
    Arc {
        /// Centre, m.
        centre_m: [f64; 2],
        /// Angle of the arc, rad, counter-clockwise positive, beyond a whole turn if it goes round more than once.
        turn_rad: f64,
    },
    /// Cubic Bezier curve.
    Bezier {
        /// Inner control points, m.
        controls_m: [[f64; 2]; 2],
    },
}

/// Work of the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToolWork {
    /// Power, 0 to 1 of what the tool can give.
    pub power: f64,
    /// The power follows the true speed in proportion, and is `power` at the feed of the motion (M4 of GRBL).
    pub follows_speed: bool,
}

/// Refusal of a file: the place in it, and the reason.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{}", list(*line, word, reason))]
pub struct PathFault {
    /// Line of the file, from 1; 0 where the file has no lines.
    pub line: u32,
    /// Word, element or key that is refused, as the file has it. Empty: the whole line.
    pub word: String,
    /// Reason, and what would do.
    pub reason: String,
}

/// Remark about a file that is played as it stands, and was hardly meant so.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PathRemark {
    /// Line of the file, from 1; 0 where the remark is about the whole file.
    pub line: u32,
    /// One sentence: fact, and what would do.
    pub text: String,
}

impl PathRemark {
    /// Remark about a line; 0: about the whole file.
    pub fn new(line: u32, text: impl Into<String>) -> Self {
        let text = text.into();
        Self { line, text }
    }
}

impl fmt::Display for PathRemark {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.line > 0 {
            write!(f, "line {}: ", self.line)?;
        }
        f.write_str(&self.text)
    }
}

fn list(line: u32, word: &str, reason: &str) -> impl fmt::Display {
    let place = match line {
        0 => String::new(),
        line => format!("{line}: "),
    };
    let word = match word {
        "" => String::new(),
        word => format!("{word}: "),
    };
    format!("{place}{word}{reason}")
}

/// Text of at most 40 characters. A control character would disturb the terminal.
pub(crate) fn short(text: &str) -> String {
    const MOST: usize = 40;
    let more = if text.chars().nth(MOST).is_some() {
        "..."
    } else {
        ""
    };
    let seen = |c: char| if c.is_control() { '\u{fffd}' } else { c };
    text.chars()
        .take(MOST)
        .map(seen)
        .chain(more.chars())
        .collect()
}

/// A number in six significant digits at most.
pub(crate) fn six(value: f64) -> String {
    let rounded: f64 = format!("{value:.5e}").parse().unwrap_or(value);
    format!("{rounded}")
}
