//! Errors of a system of loops and of its solution.

use thiserror::Error;
use trirrr_core::number::Number;

/// A system of loops that is not well formed. Terms, loops, inputs and unknowns count from 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Error)]
pub enum ClosureError {
    /// A loop gives two equations, so the number of unknowns is even.
    #[error("{unknowns} unknowns: loops of two equations each need an even number")]
    OddUnknowns {
        /// The number of unknowns.
        unknowns: usize,
    },
    /// The term belongs to a loop beyond half the number of unknowns.
    #[error("term {term} is in loop {in_loop}, but there are half as many loops as unknowns")]
    NoSuchLoop {
        /// Number of the term.
        term: usize,
        /// The loop that it names.
        in_loop: usize,
    },
    /// The term names an unknown that does not exist.
    #[error("term {term} names unknown {unknown}, which does not exist")]
    NoSuchUnknown {
        /// Number of the term.
        term: usize,
        /// The unknown that it names.
        unknown: usize,
    },
    /// The term names an input that does not exist.
    #[error("term {term} names input {input}, which does not exist")]
    NoSuchInput {
        /// Number of the term.
        term: usize,
        /// The input that it names.
        input: usize,
    },
    /// The unknown is an angle in one term and a length in another.
    #[error("unknown {unknown} is an angle in one term and a length in another")]
    MixedUnknown {
        /// Number of the unknown.
        unknown: usize,
    },
    /// No term holds the unknown.
    #[error("no term holds unknown {unknown}")]
    UnusedUnknown {
        /// Number of the unknown.
        unknown: usize,
    },
    /// The constant length of the term is not finite.
    #[error("the length of term {term} is not finite")]
    NotFinite {
        /// Number of the term.
        term: usize,
    },
}

/// Reason why the loops were not closed.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
pub enum ClosureStatus<N: Number> {
    /// The Jacobian has no inverse at the place that the iteration came to.
    #[error("singular Jacobian after {iterations} iterations")]
    SingularJacobian {
        /// Newton steps taken before.
        iterations: u32,
    },
    /// The gaps did not become small: the guess is too far, or the loops cannot be closed.
    #[error("not converged after {iterations} iterations, relative gap {:e}", residual.to_f64())]
    NotConverged {
        /// Newton steps taken.
        iterations: u32,
        /// Largest gap of a loop, relative to the lengths of its vectors.
        residual: N,
    },
    /// A value exceeds the range of the number type, or an input is not a number.
    #[error("out of the number type's range after {iterations} iterations")]
    OutOfRange {
        /// Newton steps taken before.
        iterations: u32,
    },
}
