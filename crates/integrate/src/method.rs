//! The methods that a scene can choose, and their parameters.

use crate::failure::Unfit;

/// Method of integration.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Method {
    /// Semi-implicit (symplectic) Euler: order 1, one derivative each step.
    SemiImplicitEuler {
        /// Fixed step in s. Shortened so that a whole number of steps fills the time to the next
        /// sample or output.
        step_s: f64,
    },
    /// The classical Runge-Kutta method: order 4, four derivatives each step.
    Rk4 {
        /// Fixed step in s, shortened as for semi-implicit Euler.
        step_s: f64,
    },
    /// Dormand and Prince's explicit pair of orders 5 and 4, adaptive: six derivatives each step.
    DormandPrince {
        /// Error allowed each step, relative to the larger of a variable and its scale.
        tolerance: f64,
    },
    /// Radau IIA of order 5: implicit, L-stable, adaptive. For stiff equations.
    RadauIia {
        /// Error allowed each step, relative to the larger of a variable and its scale.
        tolerance: f64,
    },
}

impl Method {
    /// Tolerance of the explicit pair where none is chosen. Errors of single steps add up, but the
    /// pair's own error is one order better than what it estimates.
    pub const DORMAND_PRINCE_TOLERANCE: f64 = 1e-9;
    /// Tolerance of Radau IIA where none is chosen: 1e-9 of a motion is kept with some to spare.
    pub const RADAU_IIA_TOLERANCE: f64 = 1e-10;
    /// The least tolerance: below it, rounding errors of a step decide.
    pub const LEAST_TOLERANCE: f64 = 1e-14;
    /// The greatest tolerance: above it, estimates of the error mean nothing.
    pub const GREATEST_TOLERANCE: f64 = 1e-1;
    /// Names of the methods as [`Method::name`] gives them, in the order of this type.
    pub const NAMES: [&'static str; 4] =
        ["semi-implicit-euler", "rk4", "dormand-prince", "radau-iia"];

    /// The name in scenes, tables and messages.
    pub fn name(&self) -> &'static str {
        let [euler, rk4, pair, implicit] = Self::NAMES;
        match self {
            Method::SemiImplicitEuler { .. } => euler,
            Method::Rk4 { .. } => rk4,
            Method::DormandPrince { .. } => pair,
            Method::RadauIia { .. } => implicit,
        }
    }

    /// The fixed step in s; `None` for a method that adapts its step.
    pub fn step_s(&self) -> Option<f64> {
        match *self {
            Method::SemiImplicitEuler { step_s } | Method::Rk4 { step_s } => Some(step_s),
            Method::DormandPrince { .. } | Method::RadauIia { .. } => None,
        }
    }

    /// The tolerance; `None` for a method of fixed step.
    pub fn tolerance(&self) -> Option<f64> {
        match *self {
            Method::DormandPrince { tolerance } | Method::RadauIia { tolerance } => Some(tolerance),
            Method::SemiImplicitEuler { .. } | Method::Rk4 { .. } => None,
        }
    }

    /// Checks the parameters by themselves.
    pub(crate) fn check(&self) -> Result<(), Unfit> {
        if let Some(step_s) = self.step_s()
            && !(step_s.is_finite() && step_s > 0.0)
        {
            return Err(Unfit::Step { step_s });
        }
        if let Some(tolerance) = self.tolerance()
            && !(Self::LEAST_TOLERANCE..=Self::GREATEST_TOLERANCE).contains(&tolerance)
        {
            return Err(Unfit::Tolerance {
                tolerance,
                least: Self::LEAST_TOLERANCE,
                most: Self::GREATEST_TOLERANCE,
            });
        }
        Ok(())
    }
}
