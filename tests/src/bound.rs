//! Comparison of results with true values.

use crate::double_double::DoubleDouble;
use crate::results::{Name, angle_error};
use core::f64::consts::TAU;

/// How far the worst of many results came to its bound.
#[derive(Clone, Debug, Default)]
pub struct Worst {
    /// Largest error divided by its bound; 1 is just at the bound.
    pub ratio: f64,
    /// Where.
    pub place: String,
    /// How many results were compared.
    pub compared: usize,
    /// How many of them were beyond their bounds.
    pub beyond: usize,
}

impl Worst {
    /// Compares one result.
    pub fn compare(&mut self, place: impl Fn() -> String, error: f64, bound: f64) {
        // A result without any error meets a bound of zero.
        let ratio = if error == 0.0 {
            0.0
        } else {
            error.abs() / bound
        };
        self.compared += 1;
        // What is not a number must not pass for small.
        let ratio = if ratio.is_nan() { f64::INFINITY } else { ratio };
        self.beyond += usize::from(ratio > 1.0);
        if ratio > self.ratio {
            self.ratio = ratio;
            self.place = format!("{}: error {error:e}, bound {bound:e}", place());
        }
    }

    /// Asserts that the worst ratio lies in a bracket: above it is a defect, below it a bound that
    /// has become too wide to find one. A build without optimisation takes a share of the cases, whose worst is smaller: there the
    /// lower end counts three tenths.
    ///
    /// # Panics
    /// When it does not, with the place.
    pub fn assert_within(&self, what: &str, bracket: core::ops::RangeInclusive<f64>) {
        assert!(self.compared > 0, "{what}: nothing was compared");
        let part = if cfg!(debug_assertions) { 0.3 } else { 1.0 };
        let bracket = part * bracket.start()..=*bracket.end();
        assert!(
            bracket.contains(&self.ratio),
            "{what}: worst ratio {:.3} of {} is not in {bracket:?}: {}",
            self.ratio,
            self.compared,
            self.place
        );
        println!(
            "{what}: worst {:.3} of {} ({} beyond), {}",
            self.ratio, self.compared, self.beyond, self.place
        );
    }
}

/// The error of `result`; of angles without whole turns.
pub fn error(name: Name, result: f64, truth: DoubleDouble) -> f64 {
    if name.is_angle() {
        angle_error(truth, result)
    } else {
        truth.error_of(result)
    }
}

/// The difference of two angles, without whole turns.
pub fn angle_difference(a: f64, b: f64) -> f64 {
    let difference = a - b;
    difference - TAU * (difference / TAU).round()
}
