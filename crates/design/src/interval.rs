//! Numbers with bounds. Each operation rounds outward, so that the true value stays between them.

use std::ops::{Add, Mul, Neg, Sub};

/// Closed interval of real numbers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
}

impl Interval {
    /// Interval from `low` to `high`.
    pub fn new(low: f64, high: f64) -> Self {
        Self { low, high }
    }

    /// Interval of one number.
    pub fn point(value: f64) -> Self {
        Self::new(value, value)
    }

    /// A computed `value` that is off by a few roundings at most.
    pub fn about(value: f64) -> Self {
        let off = 4.0 * f64::EPSILON * value.abs();
        Self::new(value - off, value + off).outward()
    }

    /// Sine and cosine of the angles from `low` to `high`, rad.
    pub fn sin_cos(low: f64, high: f64) -> [Self; 2] {
        // Between the ends and the middle the curves bend by at most half the square of half the width.
        let bend = 0.5 * (0.5 * (high - low)).powi(2);
        let ends = [low, high].map(f64::sin_cos);
        let of = |one: f64, other: f64| {
            let (low, high) = (one.min(other), one.max(other));
            let pad = bend + 4.0 * f64::EPSILON;
            Self::new((low - pad).max(-1.0), (high + pad).min(1.0)).outward()
        };
        [of(ends[0].0, ends[1].0), of(ends[0].1, ends[1].1)]
    }

    fn outward(self) -> Self {
        Self::new(self.low.next_down(), self.high.next_up())
    }

    /// Returns true if `value` lies between the bounds.
    pub fn contains(self, value: f64) -> bool {
        self.low <= value && value <= self.high
    }

    /// The square.
    pub fn squared(self) -> Self {
        let (low, high) = (self.low * self.low, self.high * self.high);
        let least = if self.contains(0.0) {
            0.0
        } else {
            low.min(high).next_down()
        };
        Self::new(least.max(0.0), low.max(high).next_up())
    }

    /// The square root of what is not negative of it.
    pub fn sqrt(self) -> Self {
        let root = |value: f64| value.max(0.0).sqrt();
        Self::new(
            root(self.low).next_down().max(0.0),
            root(self.high).next_up(),
        )
    }

    /// One over it; it must not hold 0.
    pub fn reciprocal(self) -> Self {
        Self::new(self.high.recip(), self.low.recip()).outward()
    }

    /// Smallest interval with the sizes of all its numbers.
    pub fn abs(self) -> Self {
        match () {
            () if self.low >= 0.0 => self,
            () if self.high <= 0.0 => -self,
            () => Self::new(0.0, self.high.max(-self.low)),
        }
    }

    /// Multiplies by a number.
    pub fn times(self, factor: f64) -> Self {
        self * Self::point(factor)
    }
}

impl Neg for Interval {
    type Output = Self;

    fn neg(self) -> Self {
        Self::new(-self.high, -self.low)
    }
}

impl Add for Interval {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self::new(self.low + other.low, self.high + other.high).outward()
    }
}

impl Sub for Interval {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Interval {
    type Output = Self;

    fn mul(self, other: Self) -> Self {
        let products = [
            self.low * other.low,
            self.low * other.high,
            self.high * other.low,
            self.high * other.high,
        ];
        let low = products.iter().copied().fold(f64::INFINITY, f64::min);
        let high = products.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self::new(low, high).outward()
    }
}
