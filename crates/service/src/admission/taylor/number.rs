//! Taylor models as numbers of the pipeline.

use super::{AngleModel, Float, Roundoffs, TaylorModel, product};
use crate::admission::Enclose;
use trirrr_core::number::{Arithmetic, RoundsEachStep};

impl<N: Enclose> RoundsEachStep for TaylorModel<N> {}

impl<N: Enclose> Arithmetic for TaylorModel<N> {
    type Angle = AngleModel<N>;

    const ZERO: Self = Self {
        constant: <Float<N>>::ZERO,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };
    const ONE: Self = Self {
        constant: <Float<N>>::ONE,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };
    const HALF: Self = Self {
        constant: <Float<N>>::HALF,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };
    const UNIT_ROUNDOFF: Self = Self {
        constant: <Float<N>>::UNIT_ROUNDOFF,
        linear: <Float<N>>::ZERO,
        error: <Float<N>>::ZERO,
    };

    /// The tick's own coefficient, as far as the bound's type knows it.
    fn from_f64(x: f64) -> Self {
        Self::near(<Float<N>>::from_f64(x))
    }

    /// The constant part.
    fn to_f64(self) -> f64 {
        self.constant.to_f64()
    }

    fn angle_from_f64(radians: f64) -> Self::Angle {
        AngleModel {
            constant: <Float<N>>::angle_from_f64(radians),
            linear: <Float<N>>::ZERO,
            error: <Float<N>>::ZERO,
        }
    }

    /// The constant part.
    fn angle_to_f64(angle: Self::Angle) -> f64 {
        <Float<N>>::angle_to_f64(angle.constant)
    }

    fn half_turn() -> Self::Angle {
        AngleModel::of(N::half_turn())
    }

    #[inline(never)]
    fn angle(radians: Self) -> Self::Angle {
        AngleModel {
            constant: <Float<N>>::angle(radians.constant),
            linear: radians.linear,
            error: radians.error + Roundoffs::Two.of::<N>(radians.magnitude()),
        }
    }

    #[inline(never)]
    fn radians(angle: Self::Angle) -> Self {
        let constant = <Float<N>>::radians(angle.constant);
        let size = constant.abs() + angle.linear.abs();
        Self::rounded(constant, angle.linear, angle.error, size, Roundoffs::Two)
    }

    #[inline(never)]
    fn ratio(numerator: u32, denominator: u32) -> Self {
        let ratio = <Float<N>>::ratio(numerator, denominator);
        Self::rounded(
            ratio,
            <Float<N>>::ZERO,
            <Float<N>>::ZERO,
            ratio,
            Roundoffs::Two,
        )
    }

    #[inline(never)]
    fn ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
        let ((ab, size_ab), (cd, size_cd)) = (product(a, b), product(c, d));
        Self::rounded(
            ab.constant + cd.constant,
            ab.linear + cd.linear,
            ab.error + cd.error,
            size_ab + size_cd,
            Roundoffs::Five,
        )
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
        let radius = self.radius();
        let root = self.constant.sqrt();
        if !(self.constant > <Float<N>>::ZERO) || !(self.constant >= radius) {
            return if self.constant == <Float<N>>::ZERO && radius == <Float<N>>::ZERO {
                self
            } else {
                Self::unknown()
            };
        }
        let half_inverse = <Float<N>>::HALF.div(root);
        let part = radius * half_inverse;
        let proportion = <Float<N>>::ONE + radius.div(self.constant);
        let size = part * proportion;
        let half_rest = <Float<N>>::HALF * (half_inverse * (size * size));
        let linear = self.linear * half_inverse;
        Self::rounded(
            root - half_rest,
            linear,
            self.error * half_inverse + half_rest,
            root + linear.abs() + half_rest,
            Roundoffs::Eight,
        )
    }

    /// A straddling sign gives the range from 0 to the largest size.
    #[inline(never)]
    fn abs(self) -> Self {
        if self.least_magnitude() >= <Float<N>>::ZERO {
            if self.constant < <Float<N>>::ZERO {
                -self
            } else {
                self
            }
        } else {
            let half = <Float<N>>::HALF * self.magnitude();
            Self::rounded(half, <Float<N>>::ZERO, half, half, Roundoffs::Two)
        }
    }

    /// By Taylor's formula to the second order, with the third derivative at most 1.
    #[inline(never)]
    fn sin_cos(angle: Self::Angle) -> (Self, Self) {
        let (sin, cos) = <Float<N>>::sin_cos(angle.constant);
        let radius = angle.linear.abs() + angle.error;
        let second = <Float<N>>::HALF * (radius * radius);
        let third = second * radius * <Float<N>>::ratio(1, 3);
        let model = |value: Float<N>, slope: Float<N>| {
            let linear = slope * angle.linear;
            // Of the second-order term, value t^2 linear^2 / 2 is known up to the error of the
            // angle; it is left whole in the error, for half of it would save little.
            let error =
                <Float<N>>::ab_plus_cd(value.abs(), second, slope.abs(), angle.error) + third;
            let size = value.abs() + linear.abs();
            Self::rounded(value, linear, error, size, Roundoffs::Eight)
        };
        (model(sin, cos), model(cos, -sin))
    }

    /// Continuous over the interval, so beyond +-pi where the vector passes the negative x axis. The
    /// angle's first derivatives at the distance rho are of size 1 / rho, its second ones
    /// 1 / rho^2: what is not linear is below d^2 / (2 rho^2) for a step of length d.
    #[inline(never)]
    fn atan2(y: Self, x: Self) -> Self::Angle {
        let length_sq = <Float<N>>::ab_plus_cd(x.constant, x.constant, y.constant, y.constant);
        let length = length_sq.sqrt();
        let step = x.radius() + y.radius();
        let least = length - step;
        if !(least > Roundoffs::Eight.of::<N>(length + step)) {
            return AngleModel {
                constant: <Float<N>>::atan2(y.constant, x.constant),
                linear: <Float<N>>::ZERO,
                error: <Float<N>>::ONE.div(<Float<N>>::ZERO),
            };
        }
        let across = <Float<N>>::ab_minus_cd(x.constant, y.linear, y.constant, x.linear);
        let relative = step.div(least);
        let constant = <Float<N>>::atan2(y.constant, x.constant);
        let linear = across.div(length_sq);
        let error = <Float<N>>::HALF * (relative * relative) + (x.error + y.error).div(length);
        let size = <Float<N>>::radians(constant).abs() + relative + error;
        AngleModel {
            constant,
            linear,
            error: error + Roundoffs::Eight.of::<N>(size),
        }
    }

    #[inline(always)]
    fn is_finite(self) -> bool {
        (self.constant + self.linear + self.error).is_finite()
    }
}
