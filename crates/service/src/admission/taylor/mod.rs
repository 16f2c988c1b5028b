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
//! binary32 is another matter. The sum of all that a tick may round is hundreds of times what it does round: the
//! models take no notice that errors cancel, or that one error enters a result in several ways. Many moves near a
//! limit would be refused for that alone. So the constant of a model of `f32` is a
//! [`TwoWord`](crate::admission::TwoWord) number, whose own rounding hardly counts. What the slope and `error` round
//! counts in full. Of what the tick rounds a part counts, at least a 32nd for each operation. The enclosure then
//! holds the true motion for certain, with the move's own numbers, the tick's period, and the machine's coefficients
//! before they are rounded. A tick's value lies within it but for its rounding error. The guard in the tick looks at each value.
//!
//! Comparisons are true only where they are certain: true for every t. That is what the guards of
//! the pipeline need, for there a comparison that is false means "refuse".

mod angle;
mod number;

pub use angle::AngleModel;

use crate::admission::Enclose;
use crate::admission::breach::Extent;
use crate::admission::enclose::Centre;
use core::cmp::Ordering;
use core::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use trirrr_core::number::Arithmetic;
use trirrr_core::to_source;

/// The float that the numbers of a model of `N` are.
pub(super) type Float<N> = <N as Enclose>::Bound;

/// The number that the middle of a model of `N` is.
pub(super) type Middle<N> = <N as Enclose>::Centre;

/// A quantity of the type `N` over an interval of time.
#[derive(Clone, Copy, Debug)]
pub struct TaylorModel<N: Enclose> {
    /// Value in the middle of the interval, without the error.
    pub(crate) constant: Middle<N>,
    /// Change from the middle of the interval to its end, as far as it is linear.
    pub(crate) linear: Float<N>,
    /// Bound of everything else; not negative.
    pub(crate) error: Float<N>,
}

to_source!([N: Enclose] TaylorModel [N] in trirrr_service::admission {
    constant: Middle<N>,
    linear: Float<N>,
    error: Float<N>,
});

impl<N: Enclose> TaylorModel<N> {
    /// A value of the tick, the same at all times.
    pub fn of(value: N) -> Self {
        Self::near(value.bound())
    }

    /// Returns what the number type makes of `value`, the same at all times.
    pub(super) fn near(value: Float<N>) -> Self {
        Self {
            error: N::conversion(value.abs()),
            ..Self::point(value)
        }
    }

    /// The same at all times.
    pub fn point(value: Float<N>) -> Self {
        Self {
            constant: <Middle<N>>::exactly(value),
            linear: <Float<N>>::ZERO,
            error: <Float<N>>::ZERO,
        }
    }

    /// Everything from `middle - half_width` to `middle + half_width`, linear in time.
    pub fn span(middle: Float<N>, half_width: Float<N>) -> Self {
        Self {
            constant: <Middle<N>>::exactly(middle),
            linear: half_width,
            error: <Float<N>>::ZERO,
        }
    }

    /// The value in the middle of the interval, as a bound.
    #[inline(always)]
    pub(in crate::admission) fn middle(self) -> Float<N> {
        self.constant.nearest()
    }

    /// Largest deviation from the value in the middle of the interval.
    #[inline(always)]
    pub fn radius(self) -> Float<N> {
        self.linear.abs() + self.error
    }

    /// Least and greatest value.
    #[inline(never)]
    pub(in crate::admission) fn ends(self) -> [Float<N>; 2] {
        let (middle, radius) = (self.middle(), self.radius());
        let radius = radius + <Middle<N>>::lost(middle.abs() + radius);
        [middle - radius, middle + radius]
    }

    /// Largest size.
    #[inline(never)]
    pub fn magnitude(self) -> Float<N> {
        let (size, radius) = (self.middle().abs(), self.radius());
        size + (radius + <Middle<N>>::lost(size + radius))
    }

    /// Least size; negative where the quantity may change its sign.
    #[inline(never)]
    pub fn least_magnitude(self) -> Float<N> {
        let (size, radius) = (self.middle().abs(), self.radius());
        size - (radius + <Middle<N>>::lost(size + radius))
    }

    /// Bounds of the size.
    #[inline(never)]
    pub(super) fn extent(self) -> Extent<Float<N>> {
        Extent {
            least: self.least_magnitude(),
            value: self.middle().abs(),
            greatest: self.magnitude(),
        }
    }

    /// Nothing is known.
    #[inline(always)]
    fn unknown() -> Self {
        Self {
            error: <Float<N>>::ONE.div(<Float<N>>::ZERO),
            ..Self::point(<Float<N>>::ZERO)
        }
    }

    /// With what rounding adds: `count` roundoffs of the terms, and twice as many of the error, which was
    /// itself computed in a few operations.
    #[inline(always)]
    fn rounded(self, terms: Terms<N>, count: Roundoffs) -> Self {
        Self {
            error: terms.rounded(self.error, count),
            ..self
        }
    }

    /// 1 / self. With x = c + d and |d| <= r,
    /// 1 / x = 1 / c - d / c^2 + d^2 / (c^2 x), the last term of the sign of c.
    #[inline(never)]
    fn inverse(self) -> Self {
        let (size, radius) = (self.middle().abs(), self.radius());
        let least = size - (radius + Roundoffs::Eight.of::<N>(size + radius));
        if !(least > <Float<N>>::ZERO) {
            return Self::unknown();
        }
        let inverse = <Middle<N>>::ONE.div(self.constant);
        let near = inverse.nearest();
        let squared = near * near;
        let half_rest = <Float<N>>::HALF * (squared * (radius * radius).div(least));
        let rest_towards = if near > <Float<N>>::ZERO {
            half_rest
        } else {
            -half_rest
        };
        let linear = -(self.linear * squared);
        let model = Self {
            constant: inverse + <Middle<N>>::exactly(rest_towards),
            linear,
            error: squared * self.error + half_rest,
        };
        let terms = Terms {
            total: near.abs() + linear.abs() + half_rest,
            width: linear.abs() + half_rest,
        };
        model.rounded(terms, Roundoffs::Eight)
    }
}

/// Bounds of the sizes of the terms of a result, without the error.
struct Terms<N: Enclose> {
    /// All of them.
    total: Float<N>,
    /// Those that are not of the centre alone.
    width: Float<N>,
}

impl<N: Enclose> Terms<N> {
    /// Of a model with nothing but its constant and linear parts.
    #[inline(always)]
    fn of(constant: Float<N>, linear: Float<N>) -> Self {
        Self {
            total: constant.abs() + linear.abs(),
            width: linear.abs(),
        }
    }

    /// `error` with what rounding adds to it.
    #[inline(always)]
    fn rounded(self, error: Float<N>, count: Roundoffs) -> Float<N> {
        let size = N::rounded_size(self.total, self.width);
        error + count.of::<N>(size + (error + error))
    }
}

/// Number of times that an operation rounds what its size bounds. It counts the model's constant and
/// linear parts, and the tick's own result, which the model has to hold too.
#[derive(Clone, Copy)]
enum Roundoffs {
    /// A sum: each part once, the tick's once.
    Two,
    /// A product: each part twice, of different terms; the tick's once.
    Three,
    /// A sum of two products: each part three times, of different terms; the tick's twice.
    Five,
    /// A few operations in a row, or a function of the number type that is off by a unit in the last
    /// place, which is two roundoffs, here and in the tick.
    Eight,
}

impl Roundoffs {
    #[inline(always)]
    fn of<N: Enclose>(self, size: Float<N>) -> Float<N> {
        let one = N::roundoff(size);
        let two = one + one;
        match self {
            Self::Two => two,
            Self::Three => two + one,
            Self::Five => (two + two) + one,
            Self::Eight => (two + two) + (two + two),
        }
    }
}

impl<N: Enclose> Add for TaylorModel<N> {
    type Output = Self;

    #[inline(never)]
    fn add(self, other: Self) -> Self {
        let sum = Self {
            constant: self.constant + other.constant,
            linear: self.linear + other.linear,
            error: self.error + other.error,
        };
        sum.rounded(Terms::of(sum.middle(), sum.linear), Roundoffs::Two)
    }
}

impl<N: Enclose> Neg for TaylorModel<N> {
    type Output = Self;

    #[inline(never)]
    fn neg(self) -> Self {
        Self {
            constant: -self.constant,
            linear: -self.linear,
            error: self.error,
        }
    }
}

impl<N: Enclose> Sub for TaylorModel<N> {
    type Output = Self;

    #[inline(never)]
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

/// A product whose rounding is not counted yet, with its terms.
#[inline(always)]
fn product<N: Enclose>(a: TaylorModel<N>, b: TaylorModel<N>) -> (TaylorModel<N>, Terms<N>) {
    // The term in t^2 lies between 0 and its value at the ends: half of it is known.
    let half_square = <Float<N>>::HALF * (a.linear * b.linear);
    let (middle_a, middle_b) = (a.middle(), b.middle());
    let (linear_a, linear_b) = (a.linear.abs(), b.linear.abs());
    let (size_a, size_b) = (middle_a.abs() + linear_a, middle_b.abs() + linear_b);
    let model = TaylorModel {
        constant: a.constant * b.constant + <Middle<N>>::exactly(half_square),
        linear: <Float<N>>::ab_plus_cd(middle_a, b.linear, a.linear, middle_b),
        error: half_square.abs()
            + <Float<N>>::ab_plus_cd(size_a + a.error, b.error, size_b, a.error),
    };
    let terms = Terms {
        total: size_a * size_b,
        width: size_a * linear_b + linear_a * size_b,
    };
    (model, terms)
}

impl<N: Enclose> Mul for TaylorModel<N> {
    type Output = Self;

    #[inline(never)]
    fn mul(self, other: Self) -> Self {
        let (model, terms) = product(self, other);
        model.rounded(terms, Roundoffs::Three)
    }
}

impl<N: Enclose> AddAssign for TaylorModel<N> {
    #[inline(always)]
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl<N: Enclose> SubAssign for TaylorModel<N> {
    #[inline(always)]
    fn sub_assign(&mut self, other: Self) {
        *self = *self - other;
    }
}

impl<N: Enclose> MulAssign for TaylorModel<N> {
    #[inline(always)]
    fn mul_assign(&mut self, other: Self) {
        *self = *self * other;
    }
}

impl<N: Enclose> PartialOrd for TaylorModel<N> {
    /// The order that holds at all times; `None` where there is no such order.
    #[inline(never)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        let difference = *self - *other;
        let middle = difference.middle();
        if difference.least_magnitude() > <Float<N>>::ZERO {
            middle.partial_cmp(&<Float<N>>::ZERO)
        } else if middle == <Float<N>>::ZERO && difference.radius() == <Float<N>>::ZERO {
            Some(Ordering::Equal)
        } else {
            None
        }
    }
}

impl<N: Enclose> PartialEq for TaylorModel<N> {
    fn eq(&self, other: &Self) -> bool {
        self.partial_cmp(other) == Some(Ordering::Equal)
    }
}

#[cfg(test)]
mod tests;
