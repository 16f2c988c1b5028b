//! Closure equations: n independent vector loops in 2 n unknowns, by Newton-Raphson.
//!
//! Every loop is a sum of vectors z e^(i phi) that has to vanish. A length z and an angle phi are
//! each constant, driven or unknown. With x the unknowns, q the inputs and F the 2 n components
//! of the sums:
//!
//! ```text
//! position       F(x, q) = 0            x <- x - J^-1 F,   J = dF/dx
//! velocity       J x'  = -dF/dq q'
//! acceleration   J x'' = -(what of F'' is left with x'' = 0)
//! ```
//!
//! The derivatives are those of the vectors themselves: with z', phi' the rates,
//!
//! ```text
//! d/dt   z e^(i phi) = (z' + i z phi') e^(i phi)
//! d2/dt2 z e^(i phi) = (z'' - z phi'^2 + i (2 z' phi' + z phi'')) e^(i phi)
//! ```
//!
//! The iteration may find another branch than was meant, or none, when the guess is far. How it
//! went is part of the result. An angle counts times the longest constant length, so that every
//! column of the Jacobian, and with it the condition number, is free of units.
//!
//! ```
//! use trirrr_linkage::closure::{Closure, ClosureInput, Length, Reference, Term};
//!
//! // Crank 0.1 m at 60 degrees, ground 0.4 m; a block on the second link, 0.17 m off at 84 degrees.
//! let terms = [
//!     Term::new(0, Length::Constant(0.1), Reference::Driven(0), 0.0),
//!     Term::new(0, Length::Unknown(1), Reference::Unknown(0), 0.0),
//!     Term::new(0, Length::Constant(0.17), Reference::Unknown(0), -84f64.to_radians()),
//!     Term::new(0, Length::Constant(0.4), Reference::Fixed, 0.0).reversed(),
//! ];
//! let closure = Closure::<f64, 2, 1>::new(&terms)?;
//! let crank = ClosureInput { value: 60f64.to_radians(), rate: 1.0, acceleration: 0.0 };
//! let at = closure.position(&[crank], [0.2, 0.3])?;
//! let rates = closure.rates(&[crank], &at)?;
//! assert!(at.iterations < 8 && at.condition < 10.0);
//! assert!(rates[0].abs() > 0.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod directions;
mod lu;
mod status;
mod term;

pub use status::{ClosureError, ClosureStatus};
pub use term::{ClosureInput, Length, Reference, Term};

use directions::Directions;
use lu::{Lu, Matrix};
use nalgebra::Vector2;
use trirrr_core::number::{Number, perpendicular};

/// Newton steps after which a search is given up.
pub const MAX_ITERATIONS: u32 = 32;

/// Loops with their numbers of unknowns and of inputs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closure<'a, N, const UNKNOWNS: usize, const INPUTS: usize> {
    terms: &'a [Term<N>],
    /// Size of one unit of each scaled unknown: 1 for lengths, 1 / longest length for angles.
    worth: [N; UNKNOWNS],
    /// Relative gap below which one more step is the last.
    tolerance: N,
}

/// A position that closes the loops.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClosurePosition<N, const UNKNOWNS: usize> {
    /// The unknowns; angles are the guess's plus the steps, so they are not wrapped.
    pub unknowns: [N; UNKNOWNS],
    /// Newton steps taken.
    pub iterations: u32,
    /// Largest gap of a loop, relative to the lengths of its vectors.
    pub residual: N,
    /// Condition number of the Jacobian in the 1-norm, angles counted times the longest length.
    pub condition: N,
    factors: Lu<N, UNKNOWNS>,
}

/// The loops at one place.
struct Linearisation<N, const UNKNOWNS: usize> {
    gaps: [N; UNKNOWNS],
    jacobian: Matrix<N, UNKNOWNS>,
    residual: N,
    /// Every sum of vectors and of their lengths is finite.
    finite: bool,
}

impl<'a, N: Number, const UNKNOWNS: usize, const INPUTS: usize> Closure<'a, N, UNKNOWNS, INPUTS> {
    /// The loops that consist of `terms`.
    ///
    /// # Errors
    /// [`ClosureError`].
    pub fn new(terms: &'a [Term<N>]) -> Result<Self, ClosureError> {
        if !UNKNOWNS.is_multiple_of(2) {
            return Err(ClosureError::OddUnknowns { unknowns: UNKNOWNS });
        }
        let (mut is_angle, mut is_length) = ([false; UNKNOWNS], [false; UNKNOWNS]);
        let mut longest = N::ZERO;
        for (number, term) in terms.iter().enumerate() {
            term.check(number, UNKNOWNS, INPUTS)?;
            match term.length {
                Length::Unknown(unknown) => is_length[unknown] = true,
                Length::Constant(_) if term.factor.abs() > longest => longest = term.factor.abs(),
                Length::Constant(_) | Length::Driven(_) => {}
            }
            if let Reference::Unknown(unknown) = term.reference {
                is_angle[unknown] = true;
            }
        }
        let longest = if longest > N::ZERO { longest } else { N::ONE };
        let mut worth = [N::ONE; UNKNOWNS];
        for unknown in 0..UNKNOWNS {
            match (is_angle[unknown], is_length[unknown]) {
                (true, true) => return Err(ClosureError::MixedUnknown { unknown }),
                (false, false) => return Err(ClosureError::UnusedUnknown { unknown }),
                (true, false) => worth[unknown] = N::ONE.div(longest),
                (false, true) => {}
            }
        }
        Ok(Self {
            terms,
            worth,
            tolerance: N::from_f64(16.0) * N::UNIT_ROUNDOFF,
        })
    }

    /// Closes the loops at the values of `inputs`, starting from `guess`.
    ///
    /// # Errors
    /// [`ClosureStatus`]; what is returned is finite.
    pub fn position(
        &self,
        inputs: &[ClosureInput<N>; INPUTS],
        guess: [N; UNKNOWNS],
    ) -> Result<ClosurePosition<N, UNKNOWNS>, ClosureStatus<N>> {
        let mut unknowns = guess;
        let mut iterations = 0;
        let mut last = false;
        loop {
            let state = self.linearise(inputs, &unknowns);
            if !all_finite(&unknowns) || !state.finite {
                return Err(ClosureStatus::OutOfRange { iterations });
            }
            let factors =
                Lu::new(&state.jacobian).ok_or(ClosureStatus::SingularJacobian { iterations })?;
            if last && state.residual <= self.tolerance {
                let condition = factors.condition(&state.jacobian);
                if !(condition * N::UNIT_ROUNDOFF < N::ONE) {
                    return Err(ClosureStatus::SingularJacobian { iterations });
                }
                return Ok(ClosurePosition {
                    unknowns,
                    iterations,
                    residual: state.residual,
                    condition,
                    factors,
                });
            }
            if iterations == MAX_ITERATIONS {
                return Err(ClosureStatus::NotConverged {
                    iterations,
                    residual: state.residual,
                });
            }
            // Below the tolerance the gaps are nearly rounding; one step more takes what is left
            // of the convergence, which is quadratic.
            last = state.residual <= self.tolerance;
            let step = self.solve(&factors, &state.gaps);
            for (unknown, step) in unknowns.iter_mut().zip(step) {
                *unknown += step;
            }
            iterations += 1;
        }
    }

    /// The rates of the unknowns for those of the inputs.
    ///
    /// # Errors
    /// [`ClosureStatus::OutOfRange`].
    pub fn rates(
        &self,
        inputs: &[ClosureInput<N>; INPUTS],
        at: &ClosurePosition<N, UNKNOWNS>,
    ) -> Result<[N; UNKNOWNS], ClosureStatus<N>> {
        let directions = Directions::new(inputs, &at.unknowns);
        let mut driven = [N::ZERO; UNKNOWNS];
        for term in self.terms {
            let z = term.signed_length(inputs, &at.unknowns);
            let (z1, phi1) = term.derivative(|i| inputs[i].rate, |_| N::ZERO);
            directions.add(&mut driven, term, Vector2::new(z1, z * phi1));
        }
        self.finite(self.solve(&at.factors, &driven))
    }

    /// The accelerations of the unknowns for those of the inputs.
    ///
    /// # Errors
    /// [`ClosureStatus::OutOfRange`].
    pub fn accelerations(
        &self,
        inputs: &[ClosureInput<N>; INPUTS],
        at: &ClosurePosition<N, UNKNOWNS>,
        rates: &[N; UNKNOWNS],
    ) -> Result<[N; UNKNOWNS], ClosureStatus<N>> {
        let directions = Directions::new(inputs, &at.unknowns);
        let mut rest = [N::ZERO; UNKNOWNS];
        for term in self.terms {
            let z = term.signed_length(inputs, &at.unknowns);
            let (z1, phi1) = term.derivative(|i| inputs[i].rate, |unknown| rates[unknown]);
            let (z2, phi2) = term.derivative(|i| inputs[i].acceleration, |_| N::ZERO);
            let value = Vector2::new(
                z2 - z * (phi1 * phi1),
                N::ab_plus_cd(z1 + z1, phi1, z, phi2),
            );
            directions.add(&mut rest, term, value);
        }
        self.finite(self.solve(&at.factors, &rest))
    }

    /// -J^-1 `b`, in the units of the unknowns.
    fn solve(&self, factors: &Lu<N, UNKNOWNS>, b: &[N; UNKNOWNS]) -> [N; UNKNOWNS] {
        let scaled = factors.solve(b);
        core::array::from_fn(|unknown| -(scaled[unknown] * self.worth[unknown]))
    }

    fn finite(&self, values: [N; UNKNOWNS]) -> Result<[N; UNKNOWNS], ClosureStatus<N>> {
        if all_finite(&values) {
            Ok(values)
        } else {
            Err(ClosureStatus::OutOfRange { iterations: 0 })
        }
    }

    /// The gaps of all loops and their derivatives.
    fn linearise(
        &self,
        inputs: &[ClosureInput<N>; INPUTS],
        unknowns: &[N; UNKNOWNS],
    ) -> Linearisation<N, UNKNOWNS> {
        let directions = Directions::new(inputs, unknowns);
        let mut gaps = [N::ZERO; UNKNOWNS];
        let mut jacobian = [[N::ZERO; UNKNOWNS]; UNKNOWNS];
        let mut sizes = [N::ZERO; UNKNOWNS];
        for term in self.terms {
            let row = 2 * term.in_loop;
            let z = term.signed_length(inputs, unknowns);
            let along = directions.of(term);
            gaps[row] += z * along.x;
            gaps[row + 1] += z * along.y;
            sizes[row] += z.abs();
            let mut differentiate = |unknown: usize, by: Vector2<N>, factor: N| {
                let factor = factor * self.worth[unknown];
                jacobian[row][unknown] += factor * by.x;
                jacobian[row + 1][unknown] += factor * by.y;
            };
            if let Length::Unknown(unknown) = term.length {
                differentiate(unknown, along, term.factor);
            }
            if let Reference::Unknown(unknown) = term.reference {
                differentiate(unknown, perpendicular(along), z);
            }
        }
        Linearisation {
            residual: largest_relative_gap(&gaps, &sizes),
            finite: all_finite(&gaps) && all_finite(&sizes),
            gaps,
            jacobian,
        }
    }
}

/// The largest gap relative to the lengths of its loop's vectors.
fn largest_relative_gap<N: Number, const UNKNOWNS: usize>(
    gaps: &[N; UNKNOWNS],
    sizes: &[N; UNKNOWNS],
) -> N {
    let mut largest = N::ZERO;
    for (row, gap) in gaps.iter().enumerate() {
        let size = sizes[row & !1];
        // A loop of vectors without length is closed.
        if size > N::ZERO {
            let relative = gap.abs().div(size);
            if relative > largest {
                largest = relative;
            }
        }
    }
    largest
}

fn all_finite<N: Number>(values: &[N]) -> bool {
    values.iter().all(|value| value.is_finite())
}

#[cfg(test)]
mod tests;
