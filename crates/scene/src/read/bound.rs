//! Bounds of the numbers in a scene.

use super::suggest::unit_of;
use crate::words::written;
use std::f64::consts::TAU;

/// The values a number may take. Every number must be finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Bound {
    /// Any finite number.
    Finite,
    /// Greater than 0.
    Positive,
    /// 0 or more.
    NotNegative,
    /// From the first to the second, both included.
    Within(f64, f64),
    /// 0 or more and less than 1.
    Fraction,
    /// A whole number from the first to the second, both included.
    Whole(u32, u32),
    /// 1 or -1.
    Sign,
    /// An angle of a drawing: within two turns, rad.
    TwoTurns,
}

impl Bound {
    /// Returns the reason that the bound refuses `value`, if it does.
    pub(super) fn objection(self, value: f64) -> Option<String> {
        if !value.is_finite() {
            return Some("must be a finite number".into());
        }
        let allowed = match self {
            Bound::Finite => true,
            Bound::Positive => value > 0.0,
            Bound::NotNegative => value >= 0.0,
            Bound::Within(low, high) => (low..=high).contains(&value),
            Bound::Fraction => (0.0..1.0).contains(&value),
            Bound::Whole(low, high) => {
                value.fract() == 0.0 && (low.into()..=high.into()).contains(&value)
            }
            Bound::Sign => value.abs() == 1.0,
            Bound::TwoTurns => value.abs() <= 2.0 * TAU,
        };
        (!allowed).then(|| format!("must {}", self.demand()))
    }

    /// Names the values of `key` with their unit: `a number in m/s`, `1 or -1`.
    pub(super) fn number_in(self, key: &str) -> String {
        match (self, unit_of(key)) {
            (Bound::Sign, _) => "1 or -1".into(),
            (Bound::Whole(low, high), _) => format!("a whole number from {low} to {high}"),
            (_, Some(unit)) => format!("a number in {unit}"),
            (_, None) => "a number".into(),
        }
    }

    /// "be greater than 0" and the like, to follow "must".
    fn demand(self) -> String {
        match self {
            Bound::Finite => "be a finite number".into(),
            Bound::Positive => "be greater than 0".into(),
            Bound::NotNegative => "not be negative".into(),
            Bound::Within(low, high) => {
                format!("be from {} to {}", written(low), written(high))
            }
            Bound::Fraction => "be at least 0 and less than 1".into(),
            Bound::Whole(low, high) => format!("be a whole number from {low} to {high}"),
            Bound::Sign => "be 1 or -1".into(),
            Bound::TwoTurns => "be within two turns, from -12.566 to 12.566".into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_hold_at_their_ends() {
        let within = Bound::Within(1.0, 2.0);
        for (bound, value, allowed) in [
            (Bound::Finite, -1e308, true),
            (Bound::Finite, f64::NAN, false),
            (Bound::Finite, f64::INFINITY, false),
            (Bound::Positive, 0.0, false),
            (Bound::Positive, f64::MIN_POSITIVE, true),
            (Bound::Positive, f64::NAN, false),
            (Bound::NotNegative, 0.0, true),
            (Bound::NotNegative, -1e-300, false),
            (within, 1.0, true),
            (within, 2.0, true),
            (within, 2.0 + 1e-15, false),
            (Bound::Fraction, 0.0, true),
            (Bound::Fraction, 1.0, false),
            (Bound::Whole(2, 4), 4.0, true),
            (Bound::Whole(2, 4), 3.5, false),
            (Bound::Whole(2, 4), 5.0, false),
            (Bound::Sign, -1.0, true),
            (Bound::Sign, 0.5, false),
            (Bound::TwoTurns, -2.0 * TAU, true),
            (Bound::TwoTurns, 12.567, false),
        ] {
            assert_eq!(
                bound.objection(value).is_none(),
                allowed,
                "{bound:?} {value}"
            );
        }
    }
}
