//! Linearisation of a system: its stiffness, and the steps that are stable.

use crate::method::Method;
use crate::system::System;
use nalgebra::linalg::Schur;
use nalgebra::linalg::balancing::balance_parlett_reinsch;
use nalgebra::{Complex, ComplexField, DMatrix};
use std::fmt::{Display, Formatter};

/// An eigenvalue counts as decaying or oscillating where it exceeds this part of the largest;
/// below, it is a rounding error of a zero (drift of a free body, a recorded energy).
const ZERO: f64 = 1e-9;
/// A step is unstable where it amplifies by more than this beyond what the system itself does, each
/// step or in the time of the largest eigenvalue: what rounding makes of eigenvalues that stand still.
const AMPLIFIES: f64 = 1e-6;
/// Longest step looked at, times the largest eigenvalue.
const LONGEST: f64 = 100.0;
/// Shortest step looked at, times the largest eigenvalue.
const SHORTEST: f64 = 1e-2;
/// Factor from one step looked at to the next.
const LOOK: f64 = 1.02;

/// A state's linearisation and its eigenvalues.
#[derive(Clone, Debug)]
pub struct Spectrum {
    jacobian: DMatrix<f64>,
    eigenvalues: Vec<Complex<f64>>,
}

impl Spectrum {
    /// Of `system` at the time `t` in s and the state `y`.
    pub fn of<const N: usize, S: System<N>>(
        system: &S,
        t: f64,
        y: &[f64; N],
    ) -> Result<Self, S::Refusal> {
        let mut jacobian = [[0.0; N]; N];
        system.jacobian(t, y, &mut jacobian)?;
        let jacobian = DMatrix::from_fn(N, N, |i, j| jacobian[i][j]);
        // The iteration for the eigenvalues has no end on what is not a number.
        let eigenvalues = if jacobian.iter().all(|entry| entry.is_finite()) {
            eigenvalues(&jacobian)
        } else {
            vec![Complex::new(f64::INFINITY, 0.0)]
        };
        Ok(Self {
            jacobian,
            eigenvalues,
        })
    }

    /// The eigenvalues in 1/s.
    pub fn eigenvalues(&self) -> &[Complex<f64>] {
        &self.eigenvalues
    }

    /// Magnitude of the largest eigenvalue, in 1/s.
    pub fn radius(&self) -> f64 {
        self.eigenvalues
            .iter()
            .fold(0.0, |most, value| value.modulus().max(most))
    }

    /// Rate in 1/s at which the fastest growing part of a deviation grows; negative where all decay.
    pub fn growth(&self) -> f64 {
        self.eigenvalues
            .iter()
            .fold(f64::NEG_INFINITY, |most, value| value.re.max(most))
    }

    /// The longest step in s with which the method stays stable on this linearisation; infinite
    /// for a method that is stable with every step, and for one that adapts its step.
    ///
    /// Only what decays or oscillates is looked at: what grows by itself does so in every method.
    /// `positions` are those of the system, see [`System::positions`].
    pub fn longest_step(&self, method: &Method, positions: &[(usize, usize)]) -> f64 {
        match method {
            Method::SemiImplicitEuler { .. } => self.longest_semi_implicit_euler(positions),
            Method::Rk4 { .. } => self.longest_explicit(rk4_amplification),
            Method::DormandPrince { .. } | Method::RadauIia { .. } => f64::INFINITY,
        }
    }

    /// The longest step in s with which an explicit pair of order 5 is stable here: it takes no
    /// longer steps whatever its tolerance.
    pub fn longest_dormand_prince(&self) -> f64 {
        self.longest_explicit(dormand_prince_amplification)
    }

    fn longest_explicit(&self, amplification: fn(Complex<f64>) -> Complex<f64>) -> f64 {
        let radius = self.radius();
        let decaying =
            |value: &&Complex<f64>| value.modulus() > ZERO * radius && value.re <= ZERO * radius;
        self.eigenvalues
            .iter()
            .filter(decaying)
            .map(|&value| {
                let unstable = |h: f64| amplification(value * h).modulus() > 1.0 + AMPLIFIES;
                first_step(value.modulus(), unstable)
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// One step is y + h G y, where G is the Jacobian but for the rows of the positions, which are
    /// those of their velocities at the end of the step. An eigenvalue g of G amplifies by
    /// |1 + h g| each step, by h Re g + h^2 |g|^2 / 2 for short ones; G and not 1 + h G, as rounding
    /// would not leave much of the slow ones beside 1.
    fn longest_semi_implicit_euler(&self, positions: &[(usize, usize)]) -> f64 {
        let radius = self.radius();
        let allowed = self.growth().max(0.0) + AMPLIFIES * radius;
        let unstable = |h: f64| {
            let mut step = self.jacobian.clone();
            for &(position, velocity) in positions {
                let mut row = self.jacobian.row(velocity) * h;
                row[velocity] += 1.0;
                step.set_row(position, &row);
            }
            if !step.iter().all(|entry| entry.is_finite()) {
                return true;
            }
            let grows = |g: &Complex<f64>| g.re + 0.5 * h * g.norm_sqr() > allowed;
            eigenvalues(&step).iter().any(grows)
        };
        first_step(radius, unstable)
    }
}

/// Iterations allowed for each eigenvalue; two or three are usual.
const ITERATIONS: usize = 100;

/// The eigenvalues of a matrix of finite entries. It is balanced first: its variables have
/// different units. Where the iteration does not end, one that no eigenvalue can exceed.
fn eigenvalues(matrix: &DMatrix<f64>) -> Vec<Complex<f64>> {
    let mut balanced = matrix.clone();
    balance_parlett_reinsch(&mut balanced);
    let most = balanced
        .row_iter()
        .map(|row| row.iter().map(|entry| entry.abs()).sum())
        .fold(0.0, f64::max);
    match Schur::try_new(balanced, f64::EPSILON, ITERATIONS * matrix.nrows()) {
        Some(schur) => schur.complex_eigenvalues().iter().copied().collect(),
        None => vec![Complex::new(-most, 0.0)],
    }
}

/// The first step in s that is unstable, between steps that are short and long for `radius` in
/// 1/s; infinite where none is.
fn first_step(radius: f64, unstable: impl Fn(f64) -> bool) -> f64 {
    if radius == 0.0 {
        return f64::INFINITY;
    }
    if !radius.is_finite() {
        return 0.0;
    }
    let mut stable = 0.0;
    let mut step = SHORTEST / radius;
    while !unstable(step) {
        stable = step;
        step *= LOOK;
        if step > LONGEST / radius {
            return f64::INFINITY;
        }
    }
    for _ in 0..40 {
        let middle = 0.5 * (stable + step);
        if unstable(middle) {
            step = middle;
        } else {
            stable = middle;
        }
    }
    stable
}

/// Factor of the classical method on a solution of y' = lambda y, for z = h lambda.
fn rk4_amplification(z: Complex<f64>) -> Complex<f64> {
    ((z / 4.0 + 1.0) * z / 3.0 + 1.0) * z / 2.0 * z + z + 1.0
}

/// Factor of Dormand and Prince's method of order 5.
fn dormand_prince_amplification(z: Complex<f64>) -> Complex<f64> {
    (((((z / 600.0 + 1.0 / 120.0) * z + 1.0 / 24.0) * z + 1.0 / 6.0) * z + 0.5) * z + 1.0) * z + 1.0
}

/// A method chosen for a system, and why.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Choice {
    /// The method.
    pub method: Method,
    /// Magnitude of the largest eigenvalue, in 1/s.
    pub radius: f64,
    /// Longest stable step of the explicit pair, in s.
    pub explicit_step_s: f64,
    /// The time that results are asked for at, in s: from sample to sample, or row to row.
    pub resolution_s: f64,
}

impl Display for Choice {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        write!(
            f,
            "{}: an explicit method needs {:.3} steps from one result to the next \
             ({:.3e} s; largest eigenvalue {:.3e} 1/s, stable below {:.3e} s)",
            self.method.name(),
            self.resolution_s / self.explicit_step_s,
            self.resolution_s,
            self.radius,
            self.explicit_step_s
        )
    }
}

/// The method for a system whose results are asked for every `resolution_s`: the explicit pair
/// where one stable step of it reaches from one result to the next, or the implicit method, which
/// is cheaper as soon as it can take longer steps than stability allows the pair. Without a
/// `tolerance`, the method's own.
pub fn choose(spectrum: &Spectrum, resolution_s: f64, tolerance: Option<f64>) -> Choice {
    let explicit_step_s = spectrum.longest_dormand_prince();
    let stiff = resolution_s > explicit_step_s;
    Choice {
        method: if stiff {
            Method::RadauIia {
                tolerance: tolerance.unwrap_or(Method::RADAU_IIA_TOLERANCE),
            }
        } else {
            Method::DormandPrince {
                tolerance: tolerance.unwrap_or(Method::DORMAND_PRINCE_TOLERANCE),
            }
        },
        radius: spectrum.radius(),
        explicit_step_s,
        resolution_s,
    }
}

/// Warning about a method before its first step.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum Warning {
    /// A fixed step is longer than the linearisation allows.
    #[error(
        "{method} cannot be stable with steps of {step_s:.3e} s: at the start below {limit_s:.3e} s"
    )]
    Unstable {
        /// The method's name.
        method: &'static str,
        /// The step in s.
        step_s: f64,
        /// The longest stable step in s.
        limit_s: f64,
    },
    /// The system is stiff and the method explicit.
    #[error(
        "{method} needs steps below {limit_s:.3e} s for stability alone, {steps:.0} for the run: \
         the system is stiff"
    )]
    Stiff {
        /// The method's name.
        method: &'static str,
        /// The longest stable step in s.
        limit_s: f64,
        /// Steps for the whole run.
        steps: f64,
    },
}

/// Steps for stability alone that are worth a warning.
const MANY_STEPS: f64 = 1e5;

/// Warns about `method` on this linearisation, for a run of `run_s` seconds.
pub fn warning(
    spectrum: &Spectrum,
    method: &Method,
    positions: &[(usize, usize)],
    run_s: f64,
) -> Option<Warning> {
    let name = method.name();
    if let Some(step_s) = method.step_s() {
        let limit_s = spectrum.longest_step(method, positions);
        return (step_s > limit_s).then_some(Warning::Unstable {
            method: name,
            step_s,
            limit_s,
        });
    }
    if matches!(method, Method::RadauIia { .. }) {
        return None;
    }
    let limit_s = spectrum.longest_dormand_prince();
    let steps = run_s / limit_s;
    (steps > MANY_STEPS).then_some(Warning::Stiff {
        method: name,
        limit_s,
        steps,
    })
}
