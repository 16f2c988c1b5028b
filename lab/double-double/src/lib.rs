//! Numbers of about 31 digits, as the unevaluated sum of two `f64`: truth for machines that are in
//! no reference file, and for finite differences that keep 15 digits.
//!
//! Source of the basic operations: Dekker 1971; Knuth, TAOCP 2, 4.2.2. The functions are Taylor
//! series and Newton steps, which have nothing in common with the kernels measured against them.
#![forbid(unsafe_code)]

use core::ops::{Add, Div, Mul, Neg, Sub};

/// hi + lo, |lo| at most half a unit in the last place of hi.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DoubleDouble {
    hi: f64,
    lo: f64,
}

/// pi/2 in three parts: 53 bits, the next 53, and the next.
const HALF_PI: [f64; 3] = [
    core::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_169_8e-33,
];

/// a + b exactly.
fn two_sum(a: f64, b: f64) -> DoubleDouble {
    let hi = a + b;
    let b_part = hi - a;
    DoubleDouble {
        hi,
        lo: (a - (hi - b_part)) + (b - b_part),
    }
}

/// a b exactly.
fn two_product(a: f64, b: f64) -> DoubleDouble {
    let hi = a * b;
    DoubleDouble {
        hi,
        lo: a.mul_add(b, -hi),
    }
}

impl DoubleDouble {
    /// The decimal number in `text`, within 1e-31 of its size; `None` when it is no number of at
    /// most 36 digits.
    pub fn parse(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (negative, mantissa) = match mantissa.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, mantissa),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits: u128 = format!("{whole}{fraction}").parse().ok()?;
        let low = digits % (1 << 64);
        let number = |x: u128| {
            // Halves of 64 bits, each in parts that an f64 holds exactly.
            two_sum(((x >> 32) << 32) as f64, (x % (1 << 32)) as f64)
        };
        let mut result =
            number(low) + number(digits >> 64) * Self::new(18_446_744_073_709_551_616.0);
        let shift = exponent - i32::try_from(fraction.len()).ok()?;
        for _ in 0..shift.unsigned_abs() {
            result = if shift > 0 {
                result * Self::new(10.0)
            } else {
                result / Self::new(10.0)
            };
        }
        Some(if negative { -result } else { result })
    }

    /// The number `x`, exactly.
    pub const fn new(x: f64) -> Self {
        Self { hi: x, lo: 0.0 }
    }

    /// hi + lo, which need not be apart.
    pub fn sum(hi: f64, lo: f64) -> Self {
        two_sum(hi, lo)
    }

    /// The nearest `f64`.
    pub fn value(self) -> f64 {
        self.hi
    }

    /// `result` less this number: the error of `result`.
    pub fn error_of(self, result: f64) -> f64 {
        (Self::new(result) - self).hi
    }

    /// Returns the distance of `result` from this number, in units in the last place of its `f64`.
    pub fn ulps(self, result: f64) -> f64 {
        let unit = self.hi.abs().next_up() - self.hi.abs();
        self.error_of(result).abs() / unit
    }

    /// Square root.
    pub fn sqrt(self) -> Self {
        if self.hi == 0.0 {
            return self;
        }
        // One Newton step from the root of the leading part doubles its digits.
        let root = Self::new(self.hi.sqrt());
        root + (self - root * root) / (root + root)
    }

    /// Sine and cosine of an angle in rad; all digits up to 1000 rad.
    pub fn sin_cos(self) -> (Self, Self) {
        let quarters = (self.hi / HALF_PI[0]).round();
        let count = Self::new(quarters);
        let reduced = HALF_PI
            .iter()
            .fold(self, |rest, &part| rest - count * Self::new(part));
        // Taylor series on [-pi/4, pi/4]: (pi/4)^30 / 30! is below 1e-35.
        let square = reduced * reduced;
        let (mut sin, mut cos) = (reduced, Self::new(1.0));
        let (mut odd, mut even) = (sin, cos);
        for n in 1..15 {
            let n = 2.0 * f64::from(n);
            even = -(even * square) / Self::new((n - 1.0) * n);
            odd = -(odd * square) / Self::new(n * (n + 1.0));
            cos = cos + even;
            sin = sin + odd;
        }
        match quarters.rem_euclid(4.0) as u8 {
            0 => (sin, cos),
            1 => (cos, -sin),
            2 => (-sin, -cos),
            _ => (-cos, sin),
        }
    }

    /// Angle of the vector (x, y) in rad.
    pub fn atan2(y: Self, x: Self) -> Self {
        let guess = Self::new(y.hi.atan2(x.hi));
        let (sin, cos) = guess.sin_cos();
        // The guess is off by some 1e-16, so the tangent of what is missing is what is missing.
        let (across, along) = (y * cos - x * sin, x * cos + y * sin);
        guess + Self::new(across.hi / along.hi)
    }
}

impl Add for DoubleDouble {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        let (hi, lo) = (two_sum(self.hi, other.hi), two_sum(self.lo, other.lo));
        let carried = two_sum(hi.hi, hi.lo + lo.hi);
        two_sum(carried.hi, carried.lo + lo.lo)
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let product = two_product(self.hi, other.hi);
        two_sum(
            product.hi,
            product.lo + (self.hi * other.lo + self.lo * other.hi),
        )
    }
}

impl Div for DoubleDouble {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        let first = self.hi / other.hi;
        let left = self - other * Self::new(first);
        let second = left.hi / other.hi;
        let left = left - other * Self::new(second);
        two_sum(first, second) + Self::new(left.hi / other.hi)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(text: &str) -> DoubleDouble {
        DoubleDouble::parse(text).expect(text)
    }

    fn close(a: DoubleDouble, text: &str, relative: f64) {
        let (error, size) = ((a - parsed(text)).value(), parsed(text).value());
        assert!(error.abs() <= relative * size.abs(), "{a:?} for {text}");
    }

    /// Constants from tables of elementary functions, 33 digits.
    #[test]
    fn functions_have_thirty_digits() {
        let number = DoubleDouble::new;
        close(
            number(2.0).sqrt(),
            "1.41421356237309504880168872420969808",
            1e-31,
        );
        close(
            number(1.0) / number(3.0),
            "0.333333333333333333333333333333333333",
            1e-31,
        );
        let (sin, cos) = number(1.0).sin_cos();
        close(sin, "0.841470984807896506652502321630298999", 2e-31);
        close(cos, "0.540302305868139717400936607442976603", 2e-31);
        let (sin, cos) = number(1e6).sin_cos();
        close(sin, "-0.349993502171292952117652486780771469", 1e-25);
        close(cos, "0.936752127533144786938532535074918757", 1e-25);
        close(
            DoubleDouble::atan2(number(1.0), number(1.0)),
            "0.785398163397448309615660845819875721",
            2e-31,
        );
        close(
            DoubleDouble::atan2(number(0.0), number(-1.0)),
            "3.14159265358979323846264338327950288",
            2e-31,
        );
    }

    #[test]
    fn reads_decimals_of_every_form() {
        assert_eq!(parsed("-0.25"), DoubleDouble::new(-0.25));
        assert_eq!(parsed("1e3"), DoubleDouble::new(1000.0));
        assert_eq!(DoubleDouble::parse("1e"), None);
        assert_eq!(DoubleDouble::parse("NaN"), None);
        // 0.1 is no binary number: its f64 errs by 5.55e-18.
        assert!((parsed("0.1").error_of(0.1) - 5.551_115_123_125_783e-18).abs() < 1e-31);
        close(parsed("4.41912e-40"), "0.441912e-39", 1e-30);
    }
}
