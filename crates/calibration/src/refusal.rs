//! Reasons for which measurements are refused.

use crate::columns::ColumnFault;

/// Part of the expected error that a calibration may leave over the workspace.
pub(crate) const MOST_LEFT: f64 = 0.5;

/// Reason for which measurements calibrate nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum CalibrationRefusal {
    /// The machine itself has no pose at the start.
    #[error("the scene's machine has no pose at the start of its job")]
    Machine,
    /// Rows that fit no pose of the machine, or the wrong unit.
    #[error("{}", lines(.0))]
    Rows(Vec<ColumnFault>),
    /// Nothing is free.
    #[error("no parameter is free: hold fewer groups")]
    NothingFree,
    /// No direction is seen.
    #[error("the measurements see none of the free parameters better than they are known: {0}")]
    Blind(String),
    /// There are as many unknowns as values.
    #[error(
        "{values} measured values for {seen} unknowns that they see: nothing is left to check the fit by; measure at least {needed} values, or hold some parameters"
    )]
    TooFew {
        /// Measured values.
        values: usize,
        /// Directions that they see.
        seen: usize,
        /// Values that would do.
        needed: usize,
    },
    /// The measurements are in another frame or unit, or of another machine.
    #[error(
        "the measured places are {median_m:.4} m from those of the scene's machine at these angles (median), and {expected_m} m is expected of its parts: {hint}"
    )]
    OtherFrame {
        /// Median distance, m.
        median_m: f64,
        /// Expected deviation of a length, m.
        expected_m: f64,
        /// Likely cause.
        hint: &'static str,
    },
    /// The iteration ended nowhere.
    #[error(
        "no machine near that of the scene fits the measurements: are they of this machine, in these units and in this frame?"
    )]
    NoFit,
    /// Too much of the error would stay.
    #[error(
        "the measurements would leave {left_percent:.0} % of the error that is expected over the workspace, {MOST_LEFT_PERCENT} % at most is useful: {words}; measure poses that are farther apart (--propose), or more than the device told"
    )]
    Useless {
        /// Part of the expected error that is left, percent.
        left_percent: f64,
        /// Directions that are not seen.
        words: String,
    },
}

const MOST_LEFT_PERCENT: f64 = 100.0 * MOST_LEFT;

fn lines(faults: &[ColumnFault]) -> String {
    let lines: Vec<String> = faults.iter().map(ColumnFault::to_string).collect();
    lines.join("\n")
}
