//! Box models as numbers of the pipeline.

use super::{BoxModel, ROUNDING, VARIABLES};
use trirrr_core::number::{Arithmetic, RoundsEachStep};

impl RoundsEachStep for BoxModel {}

impl Arithmetic for BoxModel {
    /// Radians.
    type Angle = Self;

    const ZERO: Self = Self::point(0.0);
    const ONE: Self = Self::point(1.0);
    const HALF: Self = Self::point(0.5);
    const UNIT_ROUNDOFF: Self = Self::point(<f64 as Arithmetic>::UNIT_ROUNDOFF);

    /// A coefficient that was computed in binary64, with what that rounded.
    fn from_f64(x: f64) -> Self {
        Self::point(x).with_roundings_of(x)
    }

    /// The constant part.
    fn to_f64(self) -> f64 {
        self.constant
    }

    fn angle_from_f64(radians: f64) -> Self {
        Self::from_f64(radians)
    }

    /// The constant part.
    fn angle_to_f64(angle: Self) -> f64 {
        angle.constant
    }

    fn half_turn() -> Self {
        Self::from_f64(<f64 as Arithmetic>::half_turn())
    }

    fn angle(radians: Self) -> Self {
        radians
    }

    fn radians(angle: Self) -> Self {
        angle
    }

    fn ratio(numerator: u32, denominator: u32) -> Self {
        Self::from_f64(<f64 as Arithmetic>::ratio(numerator, denominator))
    }

    fn div(self, divisor: Self) -> Self {
        self * divisor.inverse()
    }

    /// With x = c + d, s the root of c, and |d| <= r <= c: sqrt(x) = s + d / (2 s) - (sqrt(x) - s)^2 / (2 s), where
    /// |sqrt(x) - s| is at most r / (s + (c - r) / s), and 2 / (2 - p) <= 1 + p for p = r / c.
    fn sqrt(self) -> Self {
        let radius = self.radius();
        if self.constant == 0.0 && radius == 0.0 {
            return self;
        }
        if !(self.constant > 0.0 && self.constant >= radius) {
            return Self::unknown();
        }
        let root = <f64 as Arithmetic>::sqrt(self.constant);
        let half_inverse = 0.5 / root;
        let size = radius * half_inverse * (1.0 + radius / self.constant);
        let half_rest = 0.5 * (half_inverse * (size * size));
        self.composed(root, half_inverse, [-half_rest, half_rest])
    }

    /// A straddling sign gives the range from 0 to the largest size.
    fn abs(self) -> Self {
        if self.constant.abs() >= self.radius() {
            if self.constant < 0.0 { -self } else { self }
        } else {
            let half = 0.5 * self.magnitude();
            Self::rounded(half, [0.0; VARIABLES], half, half)
        }
    }

    /// By Taylor's formula: the second derivative is the function again, which changes by no more than the angle.
    fn sin_cos(angle: Self) -> (Self, Self) {
        let (sin, cos) = <f64 as Arithmetic>::sin_cos(angle.constant);
        let radius = angle.radius();
        let model = |value: f64, slope: f64| {
            let curvature = (value.abs() + radius).min(1.0);
            angle.composed(value, slope, [0.0, 0.5 * curvature * (radius * radius)])
        };
        (model(sin, cos), model(cos, -sin))
    }

    /// Continuous over the box, so beyond +-pi where the vector passes the negative x axis. The angle's first derivatives
    /// at the distance rho are of size 1 / rho, its second ones 1 / rho^2: what is not linear is below d^2 / (2 rho^2)
    /// for a step of length d.
    fn atan2(y: Self, x: Self) -> Self {
        let length_sq = x.constant * x.constant + y.constant * y.constant;
        let length = <f64 as Arithmetic>::sqrt(length_sq);
        let step = x.radius() + y.radius();
        let least = length - step;
        // False where a size is not a number.
        let is_away = least > ROUNDING * (length + step);
        if !is_away {
            return Self::unknown();
        }
        let constant = <f64 as Arithmetic>::atan2(y.constant, x.constant);
        let mut linear = [0.0; VARIABLES];
        for ((slope, of_x), of_y) in linear.iter_mut().zip(&x.linear).zip(&y.linear) {
            *slope = (x.constant * of_y - y.constant * of_x) / length_sq;
        }
        let relative = step / least;
        let error = 0.5 * (relative * relative) + (x.error + y.error) / length;
        Self::rounded(constant, linear, error, constant.abs() + relative + error)
    }

    fn is_finite(self) -> bool {
        (self.constant + self.radius()).is_finite()
    }
}
