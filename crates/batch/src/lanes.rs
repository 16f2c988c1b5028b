//! Several values side by side, as one number type.
//!
//! Every operation is the one of the values, so that each lane has the bits that its value alone has. A comparison is
//! true if it is true in every lane. The tick refuses where a comparison is false. So it has a motion if all lanes have
//! one; a status of some lanes asks for an evaluation lane by lane.

use std::cmp::Ordering;
use std::ops::{Add, AddAssign, Mul, MulAssign, Neg, Sub, SubAssign};
use trirrr_core::number::{Arithmetic, RoundsEachStep};
use trirrr_core::to_source;

/// A number type of slices: `f64` or `f32`.
pub trait Float: RoundsEachStep<Angle = Self> {}

impl<F: RoundsEachStep<Angle = F>> Float for F {}

/// Number of values.
pub(crate) const LANES: usize = 4;

/// Values that one machine is evaluated with at once.
#[derive(Clone, Copy, Debug)]
#[repr(align(32))]
pub(crate) struct Lanes<F> {
    values: [F; LANES],
}

to_source!([F: Float] Lanes [F] in trirrr_batch::lanes { values: [F; LANES] });

impl<F: Float> Lanes<F> {
    /// Gathers the value of each lane.
    #[inline(always)]
    pub(crate) fn new(value: impl Fn(usize) -> F) -> Self {
        // Written out: the closure of `array::from_fn` is not inlined.
        Self {
            values: [value(0), value(1), value(2), value(3)],
        }
    }

    /// Value of one lane.
    #[inline(always)]
    pub(crate) fn value(&self, lane: usize) -> F {
        self.values[lane]
    }

    #[inline(always)]
    fn map(self, function: impl Fn(F) -> F) -> Self {
        Self::new(|lane| function(self.values[lane]))
    }

    #[inline(always)]
    fn all(&self, other: &Self, holds: impl Fn(&F, &F) -> bool) -> bool {
        // Every lane is asked, without a branch.
        let mut all = true;
        for lane in 0..LANES {
            all &= holds(&self.values[lane], &other.values[lane]);
        }
        all
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $operator:tt, $assign_trait:ident, $assign:ident) => {
        impl<F: Float> $trait for Lanes<F> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                Self::new(|lane| self.values[lane] $operator other.values[lane])
            }
        }
        impl<F: Float> $assign_trait for Lanes<F> {
            #[inline(always)]
            fn $assign(&mut self, other: Self) {
                *self = *self $operator other;
            }
        }
    };
}

operator!(Add, add, +, AddAssign, add_assign);
operator!(Sub, sub, -, SubAssign, sub_assign);
operator!(Mul, mul, *, MulAssign, mul_assign);

impl<F: Float> Neg for Lanes<F> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        self.map(|value| -value)
    }
}

impl<F: Float> PartialEq for Lanes<F> {
    #[inline(always)]
    fn eq(&self, other: &Self) -> bool {
        self.all(other, F::eq)
    }
}

impl<F: Float> PartialOrd for Lanes<F> {
    #[inline(always)]
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        if self < other {
            Some(Ordering::Less)
        } else if self > other {
            Some(Ordering::Greater)
        } else {
            (self == other).then_some(Ordering::Equal)
        }
    }
    #[inline(always)]
    fn lt(&self, other: &Self) -> bool {
        self.all(other, F::lt)
    }
    #[inline(always)]
    fn le(&self, other: &Self) -> bool {
        self.all(other, F::le)
    }
    #[inline(always)]
    fn gt(&self, other: &Self) -> bool {
        self.all(other, F::gt)
    }
    #[inline(always)]
    fn ge(&self, other: &Self) -> bool {
        self.all(other, F::ge)
    }
}

impl<F: Float> Arithmetic for Lanes<F> {
    type Angle = Self;

    const PROPAGATES_NON_FINITE: bool = F::PROPAGATES_NON_FINITE;

    const ZERO: Self = Self {
        values: [F::ZERO; LANES],
    };
    const ONE: Self = Self {
        values: [F::ONE; LANES],
    };
    const HALF: Self = Self {
        values: [F::HALF; LANES],
    };
    const UNIT_ROUNDOFF: Self = Self {
        values: [F::UNIT_ROUNDOFF; LANES],
    };

    fn from_f64(x: f64) -> Self {
        Self::new(|_| F::from_f64(x))
    }
    /// The value of the first lane: coefficients are the same in all.
    fn to_f64(self) -> f64 {
        self.values[0].to_f64()
    }
    fn angle_from_f64(radians: f64) -> Self {
        Self::from_f64(radians)
    }
    fn angle_to_f64(angle: Self) -> f64 {
        angle.to_f64()
    }
    fn half_turn() -> Self {
        Self::new(|_| F::half_turn())
    }
    #[inline(always)]
    fn angle(radians: Self) -> Self {
        radians
    }
    #[inline(always)]
    fn radians(angle: Self) -> Self {
        angle
    }
    fn ratio(numerator: u32, denominator: u32) -> Self {
        Self::new(|_| F::ratio(numerator, denominator))
    }
    #[inline(always)]
    fn div(self, divisor: Self) -> Self {
        Self::new(|lane| self.values[lane].div(divisor.values[lane]))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.map(F::sqrt)
    }
    #[inline(always)]
    fn abs(self) -> Self {
        self.map(F::abs)
    }
    #[inline(always)]
    fn sin_cos(angle: Self) -> (Self, Self) {
        let of = |lane: usize| F::sin_cos(angle.values[lane]);
        let both = [of(0), of(1), of(2), of(3)];
        (
            Self::new(|lane| both[lane].0),
            Self::new(|lane| both[lane].1),
        )
    }
    #[inline(always)]
    fn atan2(y: Self, x: Self) -> Self {
        Self::new(|lane| F::atan2(y.values[lane], x.values[lane]))
    }
    #[inline(always)]
    fn is_finite(self) -> bool {
        self.all(&self, |value, _| value.is_finite())
    }
}

impl<F: Float> RoundsEachStep for Lanes<F> {
    #[inline(always)]
    fn directions_at_lengths<const COUNT: usize>(
        x: [Self; COUNT],
        y: [Self; COUNT],
        inverse: [Self; COUNT],
    ) -> [Self; COUNT] {
        // A loop, for the closure of `array::from_fn` is not inlined.
        let mut angles = x;
        for ((angle, y), inverse) in angles.iter_mut().zip(y).zip(inverse) {
            let values = F::directions_at_lengths(angle.values, y.values, inverse.values);
            *angle = Self { values };
        }
        angles
    }
}
