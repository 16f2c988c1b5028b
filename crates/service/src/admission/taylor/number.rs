//! Taylor models as numbers of the pipeline.

use super::{AngleModel, Float, Middle, Roundoffs, TaylorModel, Terms, product};
use crate::admission::Enclose;
use crate::admission::enclose::Centre;
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

    #[inline(never)]
    fn angle(radians: Self) -> Self::Angle {
        let radius = radians.radius();
        let size = N::rounded_size(radians.middle().abs() + radius, radius);
        let radians = Self {
            error: radians.error + Roundoffs::Two.of::<N>(size),
            ..radians
        };
        AngleModel { radians }
    }

    #[inline(never)]
    fn radians(angle: Self::Angle) -> Self {
        let model = angle.radians;
        model.rounded(Terms::of(model.middle(), model.linear), Roundoffs::Two)
    }

    #[inline(never)]
    fn ratio(numerator: u32, denominator: u32) -> Self {
        let model = Self {
            constant: <Middle<N>>::ratio(numerator, denominator),
            ..Self::ZERO
        };
        model.rounded(Terms::of(model.middle(), model.linear), Roundoffs::Two)
    }

    #[inline(never)]
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        let ((ab, terms_ab), (cd, terms_cd)) = (product(a, b), product(c, d));
        let model = Self {
            constant: ab.constant + cd.constant,
            linear: ab.linear + cd.linear,
            error: ab.error + cd.error,
        };
        let terms = Terms {
            total: terms_ab.total + terms_cd.total,
            width: terms_ab.width + terms_cd.width,
        };
        model.rounded(terms, Roundoffs::Five)
    }

    #[inline(never)]
    fn ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        Self::ab_plus_cd(a, b, -c, d)
    }

    #[inline(never)]
    fn div(self, divisor: Self) -> Self {
        self * divisor.inverse()
    }

    /// With x = c + d, s the root of c, and |d| <= r <= c:
    /// sqrt(x) = s + d / (2 s) - (sqrt(x) - s)^2 / (2 s), where |sqrt(x) - s| is at most
    /// r / (s + (c - r) / s), and 2 / (2 - p) <= 1 + p for p = r / c.
    #[inline(never)]
    fn sqrt(self) -> Self {
        let (middle, radius) = (self.middle(), self.radius());
        if !(middle > <Float<N>>::ZERO) || !(self.least_magnitude() >= <Float<N>>::ZERO) {
            return if middle == <Float<N>>::ZERO && radius == <Float<N>>::ZERO {
                self
            } else {
                Self::unknown()
            };
        }
        let root = self.constant.sqrt();
        let near = root.nearest();
        let half_inverse = <Float<N>>::HALF.div(near);
        let part = radius * half_inverse;
        let proportion = <Float<N>>::ONE + radius.div(middle);
        let size = part * proportion;
        let half_rest = <Float<N>>::HALF * (half_inverse * (size * size));
        let linear = self.linear * half_inverse;
        let model = Self {
            constant: root - <Middle<N>>::exactly(half_rest),
            linear,
            error: self.error * half_inverse + half_rest,
        };
        let terms = Terms {
            total: near + linear.abs() + half_rest,
            width: linear.abs() + half_rest,
        };
        model.rounded(terms, Roundoffs::Eight)
    }

    /// A straddling sign gives the range from 0 to the largest size.
    #[inline(never)]
    fn abs(self) -> Self {
        if self.least_magnitude() >= <Float<N>>::ZERO {
            if self.middle() < <Float<N>>::ZERO {
                -self
            } else {
                self
            }
        } else {
            let half = <Float<N>>::HALF * self.magnitude();
            let model = Self {
                error: half,
                ..Self::point(half)
            };
            model.rounded(Terms::of(half, <Float<N>>::ZERO), Roundoffs::Two)
        }
    }

    #[inline(never)]
    fn sin_cos(angle: Self::Angle) -> (Self, Self) {
        let angle = angle.radians;
        let (sin, cos) = <Middle<N>>::sin_cos(<Middle<N>>::angle(angle.constant));
        let size = angle.middle().abs();
        let angle_error =
            angle.error + <Middle<N>>::lost(<Float<N>>::UNIT_ROUNDOFF * (size + size));
        let model = |value, slope| near_angle(value, slope, angle.linear, angle_error);
        (model(sin, cos.nearest()), model(cos, -sin.nearest()))
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
        let error = <Float<N>>::HALF * (relative * relative) + (x.error + y.error).div(length);
        let width = relative + error;
        let size = constant.nearest().abs() + relative + error;
        let radians = Self {
            constant,
            linear,
            error: error + Roundoffs::Eight.of::<N>(N::rounded_size(size, width)),
        };
        AngleModel { radians }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        (self.middle() + self.linear + self.error).is_finite()
    }
}

/// A sine or cosine with `value` and `slope` at the middle of an angle: by Taylor's formula to the second order,
/// with the third derivative at most 1.
#[inline(never)]
fn near_angle<N: Enclose>(
    value: Middle<N>,
    slope: Float<N>,
    linear: Float<N>,
    error: Float<N>,
) -> TaylorModel<N> {
    let radius = linear.abs() + error;
    let second = <Float<N>>::HALF * (radius * radius);
    let third = second * radius * <Float<N>>::ratio(1, 3);
    let near = value.nearest();
    let model = TaylorModel {
        constant: value,
        linear: slope * linear,
        // Of the second-order term, value t^2 linear^2 / 2 is known up to the error of the
        // angle; it is left whole in the error, for half of it would save little.
        error: <Float<N>>::ab_plus_cd(near.abs(), second, slope.abs(), error) + third,
    };
    model.rounded(Terms::of(near, model.linear), Roundoffs::Eight)
}
