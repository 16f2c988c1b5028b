//! First-order Taylor models: a quantity over a whole interval of time, as a number.
//!
//! With t from -1 to 1 across the interval, a quantity is enclosed by
//!
//! ```text
//! |q(t) - (constant + linear t)| <= error
//! ```
//!
//! Arithmetic carries the slope along and collects in `error` what is not linear, so the enclosure
//! is wrong by the square of the interval's length: halving the interval divides the excess by
//! four. The pipeline of the tick is generic over its number type; run on Taylor models it gives
//! bounds of rates and torques over an interval, by the very code that computes them in the tick.
//!
//! Every operation also adds to `error` what the number type `N` may round, more than once over:
//! for the model's own three numbers, and for the operation of the tick that the model stands for.
//! So the enclosure holds for what a tick in `N` returns, not only for the exact value.
//!
//! Comparisons are true only where they are certain: true for every t. That is what the guards of
//! the pipeline need, for there a comparison that is false means "refuse".

use crate::number::Number;
use crate::number::simple::rounds_every_step;
use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};

/// A quantity over an interval of time; see the [module](self).
#[derive(Clone, Copy, Debug)]
pub struct TaylorModel<N> {
    /// Value in the middle of the interval, without the error.
    pub constant: N,
    /// Change from the middle of the interval to its end, as far as it is linear.
    pub linear: N,
    /// Bound of everything else; not negative.
    pub error: N,
}

/// An angle over an interval of time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AngleModel<N: Number> {
    constant: N::Angle,
    /// In radians.
    linear: N,
    /// In radians.
    error: N,
}

impl<N: Number> AngleModel<N> {
    /// The same at all times.
    pub fn point(angle: N::Angle) -> Self {
        Self {
            constant: angle,
            linear: N::ZERO,
            error: N::ZERO,
        }
    }
}

impl<N: Number> TaylorModel<N> {
    /// The same at all times.
    pub fn point(value: N) -> Self {
        Self {
            constant: value,
            linear: N::ZERO,
            error: N::ZERO,
        }
    }

    /// Everything from `middle - half_width` to `middle + half_width`, linear in time.
    pub fn span(middle: N, half_width: N) -> Self {
        Self {
            constant: middle,
            linear: half_width,
            error: N::ZERO,
        }
    }

    /// Largest deviation from [`TaylorModel::constant`].
    #[inline(always)]
    pub fn radius(self) -> N {
        self.linear.abs() + self.error
    }

    /// Largest size.
    #[inline(always)]
    pub fn magnitude(self) -> N {
        self.constant.abs() + self.radius()
    }

    /// Least size; negative where the quantity may change its sign.
    #[inline(always)]
    pub fn least_magnitude(self) -> N {
        self.constant.abs() - self.radius()
    }

    /// Nothing is known.
    #[inline(always)]
    fn unknown() -> Self {
        Self {
            error: N::ONE.div(N::ZERO),
            ..Self::point(N::ZERO)
        }
    }

    /// With what rounding may add where `size` bounds every number that was rounded.
    #[inline(always)]
    fn rounded(constant: N, linear: N, error: N, size: N) -> Self {
        Self {
            constant,
            linear,
            error: error + roundings(size + error),
        }
    }

    /// 1 / self. With x = c + d and |d| <= r,
    /// 1 / x = 1 / c - d / c^2 + d^2 / (c^2 x), the last term of the sign of c.
    #[inline(always)]
    fn inverse(self) -> Self {
        let radius = self.radius();
        let least = self.constant.abs() - (radius + roundings(self.constant.abs() + radius));
        if !(least > N::ZERO) {
            return Self::unknown();
        }
        let inverse = N::ONE.div(self.constant);
        let squared = inverse * inverse;
        let half_rest = N::HALF * (squared * (radius * radius).div(least));
        let rest_towards = if self.constant > N::ZERO {
            half_rest
        } else {
            -half_rest
        };
        let linear = -(self.linear * squared);
        Self::rounded(
            inverse + rest_towards,
            linear,
            squared * self.error + half_rest,
            inverse.abs() + linear.abs() + half_rest,
        )
    }
}

/// More than what a handful of operations round where `size` bounds their terms.
#[inline(always)]
fn roundings<N: Number>(size: N) -> N {
    let one = N::roundoff(size);
    let two = one + one;
    let four = two + two;
    four + four
}

impl<N: Number> Add for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let constant = self.constant + other.constant;
        let linear = self.linear + other.linear;
        Self::rounded(
            constant,
            linear,
            self.error + other.error,
            constant.abs() + linear.abs(),
        )
    }
}

impl<N: Number> Neg for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: -self.linear,
            error: self.error,
        }
    }
}

impl<N: Number> Sub for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// A product whose rounding is not counted yet, with a bound of the size of its terms.
#[inline(always)]
fn product<N: Number>(a: TaylorModel<N>, b: TaylorModel<N>) -> (TaylorModel<N>, N) {
    // The term in t^2 lies between 0 and its value at the ends: half of it is known.
    let half_square = N::HALF * (a.linear * b.linear);
    let (size_a, size_b) = (
        a.constant.abs() + a.linear.abs(),
        b.constant.abs() + b.linear.abs(),
    );
    let model = TaylorModel {
        constant: a.constant * b.constant + half_square,
        linear: N::ab_plus_cd(a.constant, b.linear, a.linear, b.constant),
        error: half_square.abs() + N::ab_plus_cd(size_a + a.error, b.error, size_b, a.error),
    };
    (model, size_a * size_b)
}

impl<N: Number> Mul for TaylorModel<N> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        let (model, size) = product(self, other);
        Self::rounded(model.constant, model.linear, model.error, size)
    }
}

impl<N: Number> AddAssign for TaylorModel<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<N: Number> SubAssign for TaylorModel<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<N: Number> MulAssign for TaylorModel<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<N: Number> PartialOrd for TaylorModel<N> {
    /// The order that holds at all times; `None` where there is no such order.
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let difference = *self - *other;
        let radius = difference.radius();
        if difference.constant > radius {
            Some(Ordering::Greater)
        } else if -difference.constant > radius {
            Some(Ordering::Less)
        } else if difference.constant == N::ZERO && radius == N::ZERO {
            Some(Ordering::Equal)
        } else {
            None
        }
    }
}

impl<N: Number> PartialEq for TaylorModel<N> {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

impl<N: Number> Add for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        let constant = self.constant + other.constant;
        let linear = self.linear + other.linear;
        let error = self.error + other.error;
        let size = N::radians(constant).abs() + linear.abs() + error;
        Self {
            constant,
            linear,
            error: error + roundings(size),
        }
    }
}

impl<N: Number> Neg for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: -self.linear,
            error: self.error,
        }
    }
}

impl<N: Number> Sub for AngleModel<N> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl<N: Number> Number for TaylorModel<N> {
    type Angle = AngleModel<N>;
    rounds_every_step!();

    const ZERO: Self = Self {
        constant: N::ZERO,
        linear: N::ZERO,
        error: N::ZERO,
    };
    const ONE: Self = Self {
        constant: N::ONE,
        linear: N::ZERO,
        error: N::ZERO,
    };
    const HALF: Self = Self {
        constant: N::HALF,
        linear: N::ZERO,
        error: N::ZERO,
    };
    const UNIT_ROUNDOFF: Self = Self {
        constant: N::UNIT_ROUNDOFF,
        linear: N::ZERO,
        error: N::ZERO,
    };

    /// The value that a tick in `N` works with, without an error.
    fn from_f64(x: f64) -> Self {
        Self::point(N::from_f64(x))
    }

    /// The constant part.
    fn to_f64(self) -> f64 {
        self.constant.to_f64()
    }

    fn angle_from_f64(radians: f64) -> Self::Angle {
        AngleModel {
            constant: N::angle_from_f64(radians),
            linear: N::ZERO,
            error: N::ZERO,
        }
    }

    /// The constant part.
    fn angle_to_f64(angle: Self::Angle) -> f64 {
        N::angle_to_f64(angle.constant)
    }

    #[inline(always)]
    fn angle(radians: Self) -> Self::Angle {
        AngleModel {
            constant: N::angle(radians.constant),
            linear: radians.linear,
            error: radians.error + roundings(radians.magnitude()),
        }
    }

    #[inline(always)]
    fn radians(angle: Self::Angle) -> Self {
        let constant = N::radians(angle.constant);
        let size = constant.abs() + angle.linear.abs();
        Self::rounded(constant, angle.linear, angle.error, size)
    }

    #[inline(always)]
    fn ratio(numerator: u32, denominator: u32) -> Self {
        let ratio = N::ratio(numerator, denominator);
        Self::rounded(ratio, N::ZERO, N::ZERO, ratio)
    }

    #[inline(always)]
    fn roundoff(size: Self) -> Self {
        Self::point(N::roundoff(size.magnitude()))
    }

    #[inline(always)]
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        let ((ab, size_ab), (cd, size_cd)) = (product(a, b), product(c, d));
        Self::rounded(
            ab.constant + cd.constant,
            ab.linear + cd.linear,
            ab.error + cd.error,
            size_ab + size_cd,
        )
    }

    #[inline(always)]
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        Self::ab_plus_cd(a, b, -c, d)
    }

    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        self * divisor.inverse()
    }

    /// With x = c + d, s the root of c, and |d| <= r <= c:
    /// sqrt(x) = s + d / (2 s) - (sqrt(x) - s)^2 / (2 s), where |sqrt(x) - s| is at most
    /// r / (s + (c - r) / s), and 2 / (2 - p) <= 1 + p for p = r / c.
    #[inline(always)]
    fn sqrt(self) -> Self {
        let radius = self.radius();
        let root = self.constant.sqrt();
        if !(self.constant > N::ZERO) || !(self.constant >= radius) {
            return if self.constant == N::ZERO && radius == N::ZERO {
                self
            } else {
                Self::unknown()
            };
        }
        let half_inverse = N::HALF.div(root);
        let part = radius * half_inverse;
        let proportion = N::ONE + radius.div(self.constant);
        let size = part * proportion;
        let half_rest = N::HALF * (half_inverse * (size * size));
        let linear = self.linear * half_inverse;
        Self::rounded(
            root - half_rest,
            linear,
            self.error * half_inverse + half_rest,
            root + linear.abs() + half_rest,
        )
    }

    /// A straddling sign gives the range from 0 to the largest size.
    #[inline(always)]
    fn abs(self) -> Self {
        if self.least_magnitude() >= N::ZERO {
            if self.constant < N::ZERO { -self } else { self }
        } else {
            let half = N::HALF * self.magnitude();
            Self::rounded(half, N::ZERO, half, half)
        }
    }

    /// By Taylor's formula to the second order, with the third derivative at most 1.
    #[inline(always)]
    fn sin_cos(angle: Self::Angle) -> (Self, Self) {
        let (sin, cos) = N::sin_cos(angle.constant);
        let radius = angle.linear.abs() + angle.error;
        let second = N::HALF * (radius * radius);
        let third = second * radius * N::ratio(1, 3);
        let model = |value: N, slope: N| {
            let linear = slope * angle.linear;
            // Of the second-order term, value t^2 linear^2 / 2 is known up to the error of the
            // angle; it is left whole in the error, for half of it would save little.
            let error = N::ab_plus_cd(value.abs(), second, slope.abs(), angle.error) + third;
            Self::rounded(value, linear, error, value.abs() + linear.abs())
        };
        (model(sin, cos), model(cos, -sin))
    }

    /// The angle's first derivatives at the distance rho are of size 1 / rho, its second ones
    /// 1 / rho^2: what is not linear is below d^2 / (2 rho^2) for a step of length d.
    fn atan2(y: Self, x: Self) -> Self::Angle {
        let length_sq = N::ab_plus_cd(x.constant, x.constant, y.constant, y.constant);
        let length = length_sq.sqrt();
        let step = x.radius() + y.radius();
        let least = length - step;
        if !(least > roundings(length + step)) {
            return AngleModel {
                constant: N::atan2(y.constant, x.constant),
                linear: N::ZERO,
                error: N::ONE.div(N::ZERO),
            };
        }
        let across = N::ab_minus_cd(x.constant, y.linear, y.constant, x.linear);
        let relative = step.div(least);
        let constant = N::atan2(y.constant, x.constant);
        let linear = across.div(length_sq);
        let error = N::HALF * (relative * relative) + (x.error + y.error).div(length);
        let size = N::radians(constant).abs() + relative + error;
        AngleModel {
            constant,
            linear,
            error: error + roundings(size),
        }
    }

    /// Without use of the length, which only makes the angle cheaper to compute.
    fn direction(x: Self, y: Self, _length: Self) -> Self::Angle {
        Self::atan2(y, x)
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        (self.constant + self.linear + self.error).is_finite()
    }
}
