//! [`Arithmetic`] for the two IEEE floats.

use super::{Arithmetic, RoundsEachStep, atan2, direction, sin_cos, sqrt};

macro_rules! float {
    ($float:ident, $sqrt:path, $sin_cos:path, $atan2:path, $directions:path) => {
        impl Arithmetic for $float {
            type Angle = $float;

            const ZERO: Self = 0.0;
            const ONE: Self = 1.0;
            const HALF: Self = 0.5;
            const UNIT_ROUNDOFF: Self = $float::EPSILON / 2.0;

            #[inline(always)]
            fn from_f64(x: f64) -> Self {
                x as $float
            }
            #[inline(always)]
            fn to_f64(self) -> f64 {
                self as f64
            }
            #[inline(always)]
            fn angle_from_f64(radians: f64) -> Self {
                radians as $float
            }
            #[inline(always)]
            fn angle_to_f64(angle: Self) -> f64 {
                angle as f64
            }
            #[inline(always)]
            fn half_turn() -> Self {
                core::$float::consts::PI
            }
            #[inline(always)]
            fn angle(radians: Self) -> Self {
                radians
            }
            #[inline(always)]
            fn radians(angle: Self) -> Self {
                angle
            }
            // A count above 2^24 is rounded to f32 before the division.
            #[inline(always)]
            fn ratio(numerator: u32, denominator: u32) -> Self {
                numerator as $float / denominator as $float
            }
            #[inline(always)]
            fn div(self, divisor: Self) -> Self {
                self / divisor
            }
            #[inline(always)]
            fn sqrt(self) -> Self {
                $sqrt(self)
            }
            #[inline(always)]
            fn abs(self) -> Self {
                $float::abs(self)
            }
            #[inline(always)]
            fn sin_cos(angle: Self) -> (Self, Self) {
                $sin_cos(angle)
            }
            #[inline(always)]
            fn atan2(y: Self, x: Self) -> Self {
                $atan2(y, x)
            }
            #[inline(always)]
            fn is_finite(self) -> bool {
                $float::is_finite(self)
            }
        }

        impl RoundsEachStep for $float {
            #[inline(always)]
            fn directions_at_lengths<const COUNT: usize>(
                x: [Self; COUNT],
                y: [Self; COUNT],
                inverse: [Self; COUNT],
            ) -> [Self; COUNT] {
                $directions(x, y, inverse)
            }
        }
    };
}

float!(
    f32,
    sqrt::sqrt_f32,
    sin_cos::sin_cos_f32,
    atan2::atan2_f32,
    direction::directions_f32
);
float!(
    f64,
    sqrt::sqrt_f64,
    sin_cos::sin_cos_f64,
    atan2::atan2_f64,
    direction::directions_f64
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ratio_is_exact_at_both_ends() {
        for ticks in [1, 3, 16_777_217, u32::MAX] {
            assert_eq!(f32::ratio(0, ticks), 0.0);
            assert_eq!(f32::ratio(ticks, ticks), 1.0);
            assert_eq!(f64::ratio(0, ticks), 0.0);
            assert_eq!(f64::ratio(ticks, ticks), 1.0);
        }
    }

    #[test]
    fn ratio_is_correctly_rounded_up_to_2_24_ticks() {
        for (numerator, denominator) in [(1, 3), (99, 100), (16_777_213, 16_777_216)] {
            let truth = f64::from(numerator) / f64::from(denominator);
            assert_eq!(f32::ratio(numerator, denominator), truth as f32);
            assert_eq!(f64::ratio(numerator, denominator), truth);
        }
    }

    #[test]
    fn division_by_zero_is_not_finite() {
        assert!(!Arithmetic::is_finite(Arithmetic::div(1.0f32, 0.0)));
        assert!(!Arithmetic::is_finite(Arithmetic::div(0.0f64, 0.0)));
    }
}
