//! The direction of a vector whose length is known.
//!
//! The tangent of half the angle is y / (length + x). With x the larger of the two components it
//! stays below tan(pi / 8), so that one short polynomial serves without further reduction.

use super::atan2::{atan_small_f32, atan_small_f64};

macro_rules! direction {
    ($name:ident, $float:ident, $atan:path, $pi_low:expr, $doc:literal) => {
        /// Angle of (x, y), a vector of length `length`, in [-pi, pi].
        #[doc = $doc]
        #[inline(always)]
        pub(super) fn $name(x: $float, y: $float, length: $float) -> $float {
            use core::$float::consts::{FRAC_PI_2, PI};
            let height = y.abs();
            let west = -x;
            if height <= x {
                let half = $atan(y / (length + x));
                half + half
            } else if height <= west {
                let half = $atan(y / (length + west));
                if y < 0.0 {
                    -PI - (half + half)
                } else {
                    PI - (half + half)
                }
            } else {
                let half = $atan(x / (length + height));
                if y < 0.0 {
                    half + half - FRAC_PI_2
                } else {
                    FRAC_PI_2 - (half + half)
                }
            }
        }
    };
}

direction!(
    direction_f32,
    f32,
    atan_small_f32,
    -8.742_278e-8,
    "The error is below 2.8 units in the last place when the length is correctly rounded."
);
direction!(
    direction_f64,
    f64,
    atan_small_f64,
    1.224_646_799_147_353_2e-16,
    "The error is below 3.1 units in the last place when the length is correctly rounded."
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::arithmetic::{Coarse, Fixed, WideArithmetic};

    #[test]
    fn half_a_turn_is_the_direction_of_the_negative_axis() {
        fn is_half_a_turn<N: WideArithmetic>() {
            let one = N::length_from_f64(1.0);
            assert_eq!(N::direction(-N::ONE, N::ZERO, &one), N::half_turn());
        }
        is_half_a_turn::<f32>();
        is_half_a_turn::<f64>();
        is_half_a_turn::<Fixed>();
        is_half_a_turn::<Coarse>();
    }

    /// Points of the circle of radius `length` at a million angles around it, near the axes and
    /// the diagonals as well as between; every point's own angle is the reference.
    fn points(length: f64) -> impl Iterator<Item = (f64, f64)> {
        let sines_and_cosines = (0..1_000_000u32).map(|k| {
            let angle = f64::from(k) * (core::f64::consts::TAU / 1e6);
            std::primitive::f64::sin_cos(angle)
        });
        sines_and_cosines.map(move |(sin, cos)| (length * cos, length * sin))
    }

    #[test]
    fn f32_error_is_as_documented() {
        let mut worst: f64 = 0.0;
        for length in [0.2f32, 1.0, 37.25] {
            for (x, y) in points(length.into()) {
                let (x, y) = (x as f32, y as f32);
                let (xd, yd) = (f64::from(x), f64::from(y));
                // The length that this very point has, rounded once.
                let length = std::primitive::f64::hypot(xd, yd) as f32;
                let truth = std::primitive::f64::atan2(yd, xd);
                let ulp = (truth as f32).abs().next_up() - (truth as f32).abs();
                let error = f64::from(direction_f32(x, y, length)) - truth;
                worst = worst.max(error.abs() / f64::from(ulp));
            }
        }
        std::println!("direction_f32: {worst:.3} ulp");
        assert!((2.6..2.8).contains(&worst), "{worst} ulp");
    }

    #[test]
    fn f64_error_is_as_documented() {
        // The reference is atan2 of the same kernel family, itself within an ulp of the truth;
        // its polynomial is the same, its reduction and its constants are not.
        let mut worst: f64 = 0.0;
        for length in [0.2f64, 1.0, 37.25] {
            for (x, y) in points(length) {
                let length = std::primitive::f64::hypot(x, y);
                let truth = std::primitive::f64::atan2(y, x);
                let ulp = truth.abs().next_up() - truth.abs();
                worst = worst.max((direction_f64(x, y, length) - truth).abs() / ulp);
            }
        }
        std::println!("direction_f64: {worst:.3} ulp");
        assert!((2.5..3.1).contains(&worst), "{worst} ulp");
    }

    #[test]
    fn is_exact_on_the_axes() {
        use core::f32::consts::{FRAC_PI_2, PI};
        assert_eq!(direction_f32(2.0, 0.0, 2.0), 0.0);
        assert_eq!(direction_f32(0.0, 2.0, 2.0), FRAC_PI_2);
        assert_eq!(direction_f32(-2.0, 0.0, 2.0), PI);
        assert_eq!(direction_f32(0.0, -2.0, 2.0), -FRAC_PI_2);
    }
}
