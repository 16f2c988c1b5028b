//! First-order Taylor models in time and in every uncertain parameter: a quantity over a whole box, as a number.
//!
//! With each variable v_k from -1 to 1 across the box, a quantity is enclosed by
//!
//! ```text
//! |q(v) - (constant + sum linear_k v_k)| <= error
//! ```
//!
//! Arithmetic carries the slopes along and collects in `error` what is not linear, and what the operation itself
//! rounds. So the enclosure holds for the real numbers that the box stands for. What two quantities have in common
//! cancels in their difference as far as it is linear, which plain intervals do not know.
//!
//! Comparisons are true only where they are certain: true everywhere in the box.

mod number;

use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use trirrr_core::number::Arithmetic;
use trirrr_core::to_source;

/// Number of variables: time and the parameters.
pub const VARIABLES: usize = 50;

/// Bound of what an operation rounds, relative to the sum of the sizes of its terms: a sum over the variables rounds
/// once for each of them, and a few roundings belong to the operation itself.
const ROUNDING: f64 = (VARIABLES as f64 + 16.0) * <f64 as Arithmetic>::UNIT_ROUNDOFF;

/// A quantity over a box of [`VARIABLES`].
#[derive(Clone, Copy, Debug)]
pub struct BoxModel {
    /// Value in the middle of the box, without the error.
    pub(crate) constant: f64,
    /// Change from the middle of the box to its side, as far as it is linear.
    pub(crate) linear: [f64; VARIABLES],
    /// Bound of everything else; not negative.
    pub(crate) error: f64,
}

to_source!([] BoxModel [] in trirrr_tolerances::model {
    constant: f64,
    linear: [f64; VARIABLES],
    error: f64,
});

impl BoxModel {
    /// The same number everywhere.
    pub const fn point(value: f64) -> Self {
        Self {
            constant: value,
            linear: [0.0; VARIABLES],
            error: 0.0,
        }
    }

    /// `middle` plus `half_width` times the variable `index`.
    pub fn variable(middle: f64, index: usize, half_width: f64) -> Self {
        let mut model = Self::point(middle);
        model.linear[index] = half_width;
        model
    }

    /// Everything within `radius` of the quantity.
    pub(crate) fn widened(self, radius: f64) -> Self {
        Self {
            error: (self.error + radius) * (1.0 + ROUNDING),
            ..self
        }
    }

    /// With what a few roundings of a value of this size add.
    pub(crate) fn with_roundings_of(self, size: f64) -> Self {
        self.widened(ROUNDING * size.abs())
    }

    /// The constant and linear part alone.
    pub(crate) fn without_error(self) -> Self {
        Self { error: 0.0, ..self }
    }

    /// Sum of the sizes of the slopes.
    pub(crate) fn spread(&self) -> f64 {
        self.linear.iter().map(|slope| slope.abs()).sum()
    }

    /// Largest deviation from the value in the middle of the box.
    pub fn radius(&self) -> f64 {
        (self.spread() + self.error) * (1.0 + ROUNDING)
    }

    /// Largest size.
    pub fn magnitude(&self) -> f64 {
        (self.constant.abs() + self.radius()) * (1.0 + ROUNDING)
    }

    /// Least and greatest value.
    pub fn range(&self) -> [f64; 2] {
        let radius = self.radius() + ROUNDING * self.magnitude();
        [self.constant - radius, self.constant + radius]
    }

    /// Nothing is known.
    fn unknown() -> Self {
        Self {
            error: f64::INFINITY,
            ..Self::point(0.0)
        }
    }

    /// Adds to `error` what rounding adds, where the sizes of all terms sum up to at most `size`. The last term is for
    /// products that underflow.
    fn rounded(constant: f64, linear: [f64; VARIABLES], error: f64, size: f64) -> Self {
        Self {
            constant,
            linear,
            error: error + ROUNDING * (size + (error + error)) + f64::MIN_POSITIVE,
        }
    }

    /// A smooth function of the quantity by Taylor's formula: its `value` and `slope` in the middle, and the `rest`, from
    /// its middle and half-width.
    fn composed(&self, value: f64, slope: f64, [rest, half_width]: [f64; 2]) -> Self {
        Self::rounded(
            value + rest,
            self.linear.map(|linear| slope * linear),
            slope.abs() * self.error + half_width,
            value.abs() + rest.abs() + slope.abs() * self.spread() + half_width,
        )
    }

    /// 1 / self. With x = c + d and |d| <= r, 1 / x = 1 / c - d / c^2 + d^2 / (c^2 x), the last term of the sign of c.
    fn inverse(&self) -> Self {
        let (size, radius) = (self.constant.abs(), self.radius());
        let least = size - radius * (1.0 + ROUNDING);
        // False where a size is not a number.
        let is_away = least > ROUNDING * size;
        if !is_away {
            return Self::unknown();
        }
        let inverse = 1.0 / self.constant;
        let squared = inverse * inverse;
        let half_rest = 0.5 * (squared * (radius * radius / least));
        self.composed(
            inverse,
            -squared,
            [half_rest.copysign(self.constant), half_rest],
        )
    }
}

impl Add for BoxModel {
    type Output = Self;

    fn add(mut self, other: Self) -> Self {
        self.constant += other.constant;
        let mut size = self.constant.abs();
        for (slope, more) in self.linear.iter_mut().zip(&other.linear) {
            *slope += more;
            size += slope.abs();
        }
        Self::rounded(self.constant, self.linear, self.error + other.error, size)
    }
}

impl Neg for BoxModel {
    type Output = Self;

    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: self.linear.map(Neg::neg),
            error: self.error,
        }
    }
}

impl Sub for BoxModel {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for BoxModel {
    type Output = Self;

    /// Of the terms of second order, those in v_k^2 lie between 0 and their value at the sides: half of each is known.
    fn mul(self, other: Self) -> Self {
        let (a, b) = (&self, &other);
        let mut linear = [0.0; VARIABLES];
        let (mut spread_a, mut spread_b) = (0.0, 0.0);
        let (mut squares, mut size_of_squares) = (0.0, 0.0);
        for ((slope, &of_a), &of_b) in linear.iter_mut().zip(&a.linear).zip(&b.linear) {
            *slope = a.constant * of_b + b.constant * of_a;
            spread_a += of_a.abs();
            spread_b += of_b.abs();
            let square = of_a * of_b;
            squares += square;
            size_of_squares += square.abs();
        }
        let (size_a, size_b) = (a.constant.abs() + spread_a, b.constant.abs() + spread_b);
        // Not negative but for rounding, which is counted with the sizes.
        let second_order = (spread_a * spread_b - 0.5 * size_of_squares).max(0.0);
        Self::rounded(
            a.constant * b.constant + 0.5 * squares,
            linear,
            second_order + (size_a + a.error) * b.error + size_b * a.error,
            size_a * size_b,
        )
    }
}

impl AddAssign for BoxModel {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl SubAssign for BoxModel {
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl MulAssign for BoxModel {
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl PartialOrd for BoxModel {
    /// The order that holds everywhere in the box; `None` where there is no such order.
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let difference = *self - *other;
        let radius = difference.radius();
        if difference.constant > radius {
            Some(Ordering::Greater)
        } else if -difference.constant > radius {
            Some(Ordering::Less)
        } else if self.radius() == 0.0 && other.radius() == 0.0 && self.constant == other.constant {
            Some(Ordering::Equal)
        } else {
            None
        }
    }
}

impl PartialEq for BoxModel {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

#[cfg(test)]
mod tests;
