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
//! Such models cost twice what models of one word cost. So a model of `f32` may also be *rough*: its constant has one
//! word, and all rounding counts in full, that of the tick included. Results of a rough model are rough. The check
//! measures an interval roughly first.
//!
//! Comparisons are true only where they are certain: true for every t. That is what the guards of
//! the pipeline need, for there a comparison that is false means "refuse".

mod angle;
mod dyad;
mod number;
pub(super) mod operators;

pub use angle::AngleModel;

use crate::admission::Enclose;
use crate::admission::breach::Extent;
use crate::admission::enclose::Centre;
use trirrr_core::number::Arithmetic;
use trirrr_core::to_source;

/// The float that the numbers of a model of `N` are.
pub(super) type Float<N> = <N as Enclose>::Bound;

/// The number that the middle of a model of `N` is.
pub(super) type Middle<N> = <N as Enclose>::Centre;

/// A quantity of the type `N` over an interval of time, with a constant of the type `C`.
///
/// In the layout of C its numbers are passed in registers of the FPU.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub struct TaylorModel<N: Enclose, C = <N as Enclose>::Centre> {
    /// Value in the middle of the interval, without the error.
    pub(crate) constant: C,
    /// Change from the middle of the interval to its end, as far as it is linear.
    pub(crate) linear: Float<N>,
    /// Bound of everything else; not negative. [Marked](Centre::marked) in a rough model.
    pub(crate) error: Float<N>,
}

to_source!([N: Enclose] TaylorModel [N] in trirrr_service::admission {
    constant: Middle<N>,
    linear: Float<N>,
    error: Float<N>,
});

/// A model whose constant has no more digits than its bounds.
type Rough<N> = TaylorModel<N, Float<N>>;

/// A [`TaylorModel`] in the numbers of bounds: constant + slope t, to within the error, for t from -1 to 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ModelLine<B> {
    /// Value in the middle.
    pub constant: B,
    /// Change from the middle to the end.
    pub slope: B,
    /// Bound of everything else; not negative.
    pub error: B,
}

impl<B: Arithmetic> ModelLine<B> {
    /// The line at `t`, without its error.
    pub fn at(self, t: B) -> B {
        self.constant + self.slope * t
    }

    /// Largest size, to a few roundings.
    pub fn magnitude(self) -> B {
        self.constant.abs() + self.slope.abs() + self.error
    }
}

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

    /// The model as a line with its error.
    pub fn line(self) -> ModelLine<Float<N>> {
        let rough = self.rough();
        ModelLine {
            constant: rough.constant,
            slope: rough.linear,
            error: rough.error,
        }
    }

    /// The same, with results that are rough.
    pub fn made_rough(self) -> Self {
        Self {
            error: <Middle<N>>::marked(self.error),
            ..self
        }
    }

    /// Returns `true` if a result of the two is rough.
    #[inline(always)]
    fn are_rough(self, other: Self) -> bool {
        <Middle<N>>::is_one_bound([self.error, other.error])
    }

    /// Returns `true` if every result of the model is rough.
    #[inline(always)]
    pub(in crate::admission) fn is_rough(self) -> bool {
        self.are_rough(self)
    }

    /// Returns `true` for an exact zero.
    #[inline(always)]
    fn is_zero(self) -> bool {
        self.middle() == <Float<N>>::ZERO && self.radius() == <Float<N>>::ZERO
    }

    /// Computes a result by `rough` if the model is rough, by `precise` if it is not.
    #[inline(always)]
    fn map(
        self,
        rough: impl FnOnce(Rough<N>) -> Rough<N>,
        precise: impl FnOnce(Self) -> Self,
    ) -> Self {
        if self.is_rough() {
            rough(self.rough()).result()
        } else {
            precise(self)
        }
    }

    /// With what the constant leaves out in the error.
    #[inline(always)]
    fn rough(self) -> Rough<N> {
        TaylorModel {
            constant: self.middle(),
            linear: self.linear,
            error: <Middle<N>>::unmarked(self.error) + self.constant.rest(),
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
}

impl<N: Enclose> Rough<N> {
    /// As a number of the pipeline.
    #[inline(always)]
    fn result(self) -> TaylorModel<N> {
        TaylorModel {
            constant: <Middle<N>>::exactly(self.constant),
            linear: self.linear,
            error: <Middle<N>>::marked(self.error),
        }
    }
}

impl<N: Enclose, C: Centre<Float<N>>> TaylorModel<N, C> {
    /// The value in the middle of the interval, as a bound.
    #[inline(always)]
    pub(in crate::admission) fn middle(self) -> Float<N> {
        self.constant.nearest()
    }

    /// Largest deviation from the value in the middle of the interval.
    #[inline(always)]
    pub fn radius(self) -> Float<N> {
        self.linear.abs() + self.curvature()
    }

    /// Bound of what is not linear.
    #[inline(always)]
    pub(super) fn curvature(self) -> Float<N> {
        C::unmarked(self.error)
    }

    /// Least and greatest value.
    #[inline(never)]
    pub(in crate::admission) fn ends(self) -> [Float<N>; 2] {
        let (middle, radius) = (self.middle(), self.radius());
        let radius = radius + C::lost(middle.abs() + radius);
        [middle - radius, middle + radius]
    }

    /// Largest size.
    #[inline(never)]
    pub fn magnitude(self) -> Float<N> {
        self.extent().greatest
    }

    /// Least size; negative where the quantity may change its sign.
    #[inline(never)]
    pub fn least_magnitude(self) -> Float<N> {
        self.extent().least
    }

    /// Bounds of the size.
    #[inline(always)]
    pub(super) fn extent(self) -> Extent<Float<N>> {
        let (value, radius) = (self.middle().abs(), self.radius());
        let radius = radius + C::lost(value + radius);
        Extent {
            least: value - radius,
            value,
            greatest: value + radius,
            curved: self.curvature(),
        }
    }

    /// With what rounding adds: `count` roundoffs of the terms, and twice as many of the error, which was
    /// itself computed in a few operations.
    #[inline(always)]
    fn rounded(self, terms: Terms<N>, count: Roundoffs) -> Self {
        let size = C::rounded_size(terms.total, terms.width);
        let size = size + (self.error + self.error);
        Self {
            error: self.error + count.of::<N>(size),
            ..self
        }
    }

    /// The same, rounded once more.
    #[inline(always)]
    fn rounded_again(self) -> Self {
        self.rounded(Terms::of(self.middle(), self.linear), Roundoffs::Two)
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
}

/// Number of times that an operation rounds what its size bounds. It counts the model's constant and
/// linear parts, and the tick's own result, which the model has to hold too.
#[derive(Clone, Copy)]
enum Roundoffs {
    /// A sum: each part once, the tick's once.
    Two = 2,
    /// A product: each part twice, of different terms; the tick's once.
    Three = 3,
    /// A sum of two products: each part three times, of different terms; the tick's twice.
    Five = 5,
    /// A few operations in a row, or a function of the number type that is off by a unit in the last
    /// place, which is two roundoffs, here and in the tick.
    Eight = 8,
}

impl Roundoffs {
    #[inline(always)]
    fn of<N: Enclose>(self, size: Float<N>) -> Float<N> {
        N::roundoffs(self as u8, size)
    }
}

#[cfg(test)]
mod tests;
