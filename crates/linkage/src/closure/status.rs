//! Errors of a system of loops and of its solution.

use core::fmt;
use trirrr_core::number::Number;

/// A system of loops that is not well formed. Terms, loops, inputs and unknowns count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ClosureError {
    /// A loop gives two equations, so the number of unknowns is even.
    OddUnknowns {
        /// The number of unknowns.
        unknowns: usize,
    },
    /// The term belongs to a loop beyond half the number of unknowns.
    NoSuchLoop {
        /// Number of the term.
        term: usize,
        /// The loop that it names.
        in_loop: usize,
    },
    /// The term names an unknown that does not exist.
    NoSuchUnknown {
        /// Number of the term.
        term: usize,
        /// The unknown that it names.
        unknown: usize,
    },
    /// The term names an input that does not exist.
    NoSuchInput {
        /// Number of the term.
        term: usize,
        /// The input that it names.
        input: usize,
    },
    /// The unknown is an angle in one term and a length in another.
    MixedUnknown {
        /// Number of the unknown.
        unknown: usize,
    },
    /// No term holds the unknown.
    UnusedUnknown {
        /// Number of the unknown.
        unknown: usize,
    },
    /// The constant length of the term is not finite.
    NotFinite {
        /// Number of the term.
        term: usize,
    },
}

impl fmt::Display for ClosureError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::OddUnknowns { unknowns } => write!(
                f,
                "{unknowns} unknowns: loops of two equations each need an even number"
            ),
            Self::NoSuchLoop { term, in_loop } => write!(
                f,
                "term {term} is in loop {in_loop}, but there are half as many loops as unknowns"
            ),
            Self::NoSuchUnknown { term, unknown } => {
                write!(
                    f,
                    "term {term} names unknown {unknown}, which does not exist"
                )
            }
            Self::NoSuchInput { term, input } => {
                write!(f, "term {term} names input {input}, which does not exist")
            }
            Self::MixedUnknown { unknown } => write!(
                f,
                "unknown {unknown} is an angle in one term and a length in another"
            ),
            Self::UnusedUnknown { unknown } => write!(f, "no term holds unknown {unknown}"),
            Self::NotFinite { term } => write!(f, "the length of term {term} is not finite"),
        }
    }
}

impl core::error::Error for ClosureError {}

/// Reason why the loops were not closed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosureStatus<N> {
    /// The Jacobian has no inverse at the place that the iteration came to.
    SingularJacobian {
        /// Newton steps taken before.
        iterations: u32,
    },
    /// The gaps did not become small: the guess is too far, or the loops cannot be closed.
    NotConverged {
        /// Newton steps taken.
        iterations: u32,
        /// Largest gap of a loop, relative to the lengths of its vectors.
        residual: N,
    },
    /// A value exceeds the range of the number type, or an input is not a number.
    OutOfRange {
        /// Newton steps taken before.
        iterations: u32,
    },
}

impl<N: Number> fmt::Display for ClosureStatus<N> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::SingularJacobian { iterations } => {
                write!(f, "singular Jacobian after {iterations} iterations")
            }
            Self::NotConverged {
                iterations,
                residual,
            } => write!(
                f,
                "not converged after {iterations} iterations, relative gap {:e}",
                residual.to_f64()
            ),
            Self::OutOfRange { iterations } => {
                write!(
                    f,
                    "out of the number type's range after {iterations} iterations"
                )
            }
        }
    }
}

impl<N: Number> core::error::Error for ClosureStatus<N> {}
