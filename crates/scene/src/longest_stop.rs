//! The longest stop of a job, known before the job starts.

use crate::words::{rounded_up, short};
use std::fmt;

/// Bounds of the time and of the way of a hold or a stop, wherever on a job it comes, at whatever pace: below normal speed by a
/// feed override, on the way there, or on the way up from a hold. They may belong to different places.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LongestStop {
    /// Seconds from the tick that begins to slow down until the machine stands, or has come to the end of the job.
    pub time_s: f64,
    /// Length of D's path until there, m, rounded up to three significant digits.
    pub way_m: f64,
}

impl LongestStop {
    /// Takes the greater time and the greater way.
    pub(crate) fn merge(&mut self, other: Self) {
        self.time_s = self.time_s.max(other.time_s);
        self.way_m = self.way_m.max(other.way_m);
    }
}

impl fmt::Display for LongestStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [time, way] = [self.time_s, self.way_m].map(|value| short(rounded_up(value, 4)));
        write!(
            f,
            "at rest within {time} s and {way} m, wherever it comes, at any pace"
        )
    }
}
