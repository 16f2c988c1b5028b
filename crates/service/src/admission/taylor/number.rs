//! Taylor models as numbers of the pipeline.

use super::operators::{difference_of_products, inverse, root, rounded_again, sum_of_products};
use super::{AngleModel, Float, Middle, Rough, Roundoffs, TaylorModel, Terms};
use crate::admission::Enclose;
use crate::admission::enclose::Centre;
use nalgebra::Vector2;
use trirrr_core::number::{Arithmetic, RoundsEachStep};

impl<N: Enclose> RoundsEachStep for TaylorModel<N> {}

impl<N: Enclose> Arithmetic for TaylorModel<N> {
    type Angle = AngleModel<N>;

    const ZERO: Self = Self {
        constant: <Middle<N>>::ZERO,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };
    const ONE: Self = Self {
        constant: <Middle<N>>::ONE,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };
    const HALF: Self = Self {
        constant: <Middle<N>>::HALF,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };
    const UNIT_ROUNDOFF: Self = Self {
        constant: <Middle<N>>::UNIT_ROUNDOFF,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };

    /// The coefficient, with what the tick makes of it.
    fn from_f64(x: f64) -> Self {
        let constant = <Middle<N>>::from_f64(x);
        Self {
            constant,
            error: N::coefficient(constant.nearest().abs()),
            ..Self::ZERO
        }
    }

    /// The constant part.
    fn to_f64(self) -> f64 {
        self.constant.to_f64()
    }

    fn angle_from_f64(radians: f64) -> Self::Angle {
        let radians = Self {
            constant: <Middle<N>>::from_f64(radians),
            ..Self::ZERO
        };
        AngleModel { radians }
    }

    /// The constant part.
    fn angle_to_f64(angle: Self::Angle) -> f64 {
        angle.radians.to_f64()
    }

    fn half_turn() -> Self::Angle {
        AngleModel::of(N::half_turn())
    }

    #[inline(always)]
    fn angle(radians: Self) -> Self::Angle {
        let radians = rounded_again(radians);
        AngleModel { radians }
    }

    #[inline(always)]
    fn radians(angle: Self::Angle) -> Self {
        rounded_again(angle.radians)
    }

    #[inline(never)]
    fn ratio(numerator: u32, denominator: u32) -> Self {
        let model = Self {
            constant: <Middle<N>>::ratio(numerator, denominator),
            ..Self::ZERO
        };
        model.rounded_again()
    }

    #[inline(always)]
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        sum_of_products(a, b, c, d)
    }

    #[inline(always)]
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        difference_of_products(a, b, c, d)
    }

    /// A function of its own: operands stay in memory up to here.
    #[cfg_attr(target_os = "none", inline(never))]
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn dot_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self {
        sum_of_products(a.x, b.x, a.y, b.y)
    }

    /// As [`dot_of`](Self::dot_of).
    #[cfg_attr(target_os = "none", inline(never))]
    #[cfg_attr(not(target_os = "none"), inline(always))]
    fn cross_of(a: &Vector2<Self>, b: &Vector2<Self>) -> Self {
        difference_of_products(a.x, b.y, a.y, b.x)
    }

    #[inline(never)]
    fn div(self, divisor: Self) -> Self {
        self * inverse(divisor)
    }

    #[inline(never)]
    fn sqrt(self) -> Self {
        let middle = self.middle();
        if middle > <Float<N>>::ZERO && self.least_magnitude() >= <Float<N>>::ZERO {
            root(self)
        } else if self.is_zero() {
            self
        } else {
            Self::unknown()
        }
    }

    /// A size differs from that in the middle by at most the radius.
    #[inline(never)]
    fn abs(self) -> Self {
        if self.least_magnitude() >= <Float<N>>::ZERO {
            if self.middle() < <Float<N>>::ZERO {
                -self
            } else {
                self
            }
        } else {
            let rough = self.rough();
            let straddling = Rough {
                constant: rough.constant.abs(),
                linear: <Float<N>>::ZERO,
                error: rough.radius(),
            };
            straddling.rounded_again().result()
        }
    }

    #[inline(never)]
    fn sin_cos(angle: Self::Angle) -> (Self, Self) {
        let angle = angle.radians;
        if angle.is_rough() {
            let (sin, cos) = angle.rough().sine_and_cosine();
            (sin.result(), cos.result())
        } else {
            angle.sine_and_cosine()
        }
    }

    /// Continuous over the interval, so beyond +-pi where the vector passes the negative x axis. The
    /// angle's first derivatives at the distance rho are of size 1 / rho, its second ones
    /// 1 / rho^2: what is not linear is below d^2 / (2 rho^2) for a step of length d.
    #[inline(never)]
    fn atan2(y: Self, x: Self) -> Self::Angle {
        let (middle_x, middle_y) = (x.middle(), y.middle());
        let length_sq = <Float<N>>::ab_plus_cd(middle_x, middle_x, middle_y, middle_y);
        let length = length_sq.sqrt();
        let step = x.radius() + y.radius();
        let least = length - step;
        let constant = <Middle<N>>::radians(<Middle<N>>::atan2(y.constant, x.constant));
        if !(least > Roundoffs::Eight.of::<N>(length + step)) {
            let radians = Self {
                constant,
                ..Self::unknown()
            };
            return AngleModel { radians };
        }
        let across = <Float<N>>::ab_minus_cd(middle_x, y.linear, middle_y, x.linear);
        let relative = step.div(least);
        let linear = across.div(length_sq);
        let errors = <Middle<N>>::unmarked(x.error) + <Middle<N>>::unmarked(y.error);
        let error = <Float<N>>::HALF * (relative * relative) + errors.div(length);
        let width = relative + error;
        let size = constant.nearest().abs() + relative + error;
        let radians = Self {
            constant,
            linear,
            error: error + Roundoffs::Eight.of::<N>(<Middle<N>>::rounded_size(size, width)),
        };
        AngleModel { radians }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        (self.middle() + self.linear + self.error).is_finite()
    }
}

impl<N: Enclose, C: Centre<Float<N>>> TaylorModel<N, C> {
    /// Of an angle in radians.
    #[inline(always)]
    fn sine_and_cosine(self) -> (Self, Self) {
        let (sin, cos) = C::sin_cos(C::angle(self.constant));
        let size = self.middle().abs();
        let error = self.error + C::lost(<Float<N>>::UNIT_ROUNDOFF * (size + size));
        let model = |value, slope| Self::near_angle(value, slope, self.linear, error);
        (model(sin, cos.nearest()), model(cos, -sin.nearest()))
    }

    /// A sine or cosine with `value` and `slope` at the middle of an angle: by Taylor's formula to the second order,
    /// with the third derivative at most 1.
    #[inline(never)]
    fn near_angle(value: C, slope: Float<N>, linear: Float<N>, error: Float<N>) -> Self {
        let radius = linear.abs() + error;
        let second = <Float<N>>::HALF * (radius * radius);
        let third = second * radius * <Float<N>>::ratio(1, 3);
        let near = value.nearest();
        let model = Self {
            constant: value,
            linear: slope * linear,
            // Of the second-order term, value t^2 linear^2 / 2 is known up to the error of the
            // angle; it is left whole in the error, for half of it would save little.
            error: <Float<N>>::ab_plus_cd(near.abs(), second, slope.abs(), error) + third,
        };
        model.rounded(Terms::of(near, model.linear), Roundoffs::Eight)
    }
}
