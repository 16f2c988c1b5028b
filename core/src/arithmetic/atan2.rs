//! The angle of a plane vector.
//!
//! The quotient of the components is brought below 1/2 by turning the vector by a multiple of
//! pi/4; the polynomials are minimax for the relative error of the arctangent, coefficients
//! rounded one after the other, each refitted to the ones before it.

use super::polynomial::horner;

macro_rules! atan2 {
    (
        $(#[$doc:meta])* $name:ident, $float:ident, $tail:ident,
        $quarter_low:expr, $half_low:expr, $three_quarters:expr, $three_quarters_low:expr,
        $pi_low:expr
    ) => {
        $(#[$doc])*
        #[inline]
        pub(super) fn $name(y: $float, x: $float) -> $float {
            use core::$float::consts::{FRAC_PI_2, FRAC_PI_4, PI};
            let (height, width) = (y.abs(), x.abs());
            // The vector (x, |y|) has the angle turn + turn_low + atan(n / d).
            let (n, d, turn, turn_low) = if height + height <= width {
                if x > 0.0 {
                    (height, x, 0.0, 0.0)
                } else {
                    (height, x, PI, $pi_low)
                }
            } else if width + width <= height {
                (-x, height, FRAC_PI_2, $half_low)
            } else {
                // Within a factor of two the difference is exact. Halving the larger vectors keeps
                // the sum in range.
                let scale = if height > 0.25 * $float::MAX { 0.5 } else { 1.0 };
                let (height, width) = (scale * height, scale * width);
                if x > 0.0 {
                    (height - width, height + width, FRAC_PI_4, $quarter_low)
                } else {
                    (width - height, height + width, $three_quarters, $three_quarters_low)
                }
            };
            // (0, 0) has x = 0 on the side of pi; neither 0/0 nor pi is wanted.
            if n == 0.0 && d == 0.0 {
                return 0.0;
            }
            let t = n / d;
            let upper = turn + (t + ($tail(t) + turn_low));
            if y < 0.0 { -upper } else { upper }
        }
    };
}

atan2! {
    /// Angle of (x, y) in radians, in [-pi, pi], within 1.6 units in the last place.
    atan2_f32, f32, tail_f32, -2.185_569_4e-8, -4.371_139e-8, 2.356_194_5, -5.962_440_3e-9,
    -8.742_278e-8
}
atan2! {
    /// Angle of (x, y) in radians, in [-pi, pi], within 1.6 units in the last place.
    atan2_f64, f64, tail_f64, 3.061_616_997_868_383e-17, 6.123_233_995_736_766e-17,
    2.356_194_490_192_345, 9.184_850_993_605_148e-17, 1.224_646_799_147_353_2e-16
}

/// atan(t) - t for |t| <= 1/2.
#[inline(always)]
fn tail_f32(t: f32) -> f32 {
    let z = t * t;
    t * z
        * horner!(
            z;
            -0.333_332_33,
            0.199_941_68,
            -0.141_742_13,
            0.101_558_28,
            -0.051_251_657
        )
}

/// atan(t) - t for |t| <= 1/2.
#[inline(always)]
fn tail_f64(t: f64) -> f64 {
    let z = t * t;
    t * z
        * horner!(
            z;
            -0.333_333_333_333_329_8,
            0.199_999_999_999_031_06,
            -0.142_857_142_763_854_28,
            0.111_111_106_596_237_66,
            -0.090_908_962_447_506_85,
            0.076_920_739_179_063_81,
            -0.066_638_107_106_700_97,
            0.058_582_996_931_379_66,
            -0.051_220_093_527_425_514,
            0.041_865_133_309_256_33,
            -0.027_435_062_201_769_625,
            0.010_116_895_156_127_891
        )
}

#[cfg(test)]
mod tests {
    use super::super::reference::ATAN2;
    use super::*;
    use trirrr_double_double::DoubleDouble;

    /// Vectors of all directions: around the axes, the diagonals and the seams of the reduction,
    /// at angles that are powers of two, and evenly between; of changing length.
    fn vectors(count: u32) -> impl Iterator<Item = (f64, f64)> {
        let seams = [0.0, 0.25, 0.463_647_609, 0.5, 1.107_148_718];
        let even =
            (0..count).map(move |k| f64::from(k) * (core::f64::consts::TAU / f64::from(count)));
        let close = (0..count).map(move |k| {
            let seam = seams[k as usize % seams.len()];
            let turns = f64::from(k / 8 % 4) * core::f64::consts::FRAC_PI_2;
            turns + seam + (f64::from(k) / f64::from(count) - 0.5) * 0.04
        });
        even.chain(close).enumerate().map(|(k, angle)| {
            let length = 1.0 + 0.618_033_988_75 * (k % 97) as f64;
            (length * angle.sin(), length * angle.cos())
        })
    }

    #[test]
    fn f32_error_is_as_documented() {
        let mut worst: f64 = 0.0;
        for (y, x) in vectors(1_000_000) {
            let (y, x) = (y as f32, x as f32);
            let truth = f64::from(y).atan2(f64::from(x));
            let size = (truth as f32).abs();
            let ulp = f64::from(size.next_up() - size);
            worst = worst.max((f64::from(atan2_f32(y, x)) - truth).abs() / ulp);
        }
        std::println!("atan2_f32: {worst:.3} ulp");
        assert!((1.4..1.6).contains(&worst), "{worst} ulp");
    }

    #[test]
    fn f64_error_is_as_documented() {
        let mut worst: f64 = 0.0;
        for (y, x) in vectors(150_000) {
            let truth = DoubleDouble::atan2(DoubleDouble::new(y), DoubleDouble::new(x));
            worst = worst.max(truth.ulps(atan2_f64(y, x)));
        }
        std::println!("atan2_f64: {worst:.3} ulp");
        assert!((1.4..1.6).contains(&worst), "{worst} ulp");
        for (y, x, truth) in ATAN2 {
            let error = DoubleDouble::sum(truth.0, truth.1).ulps(atan2_f64(y, x));
            assert!(error < 1.5, "({y}, {x}): {error} ulp");
        }
    }

    #[test]
    fn axes_and_ends_of_the_range() {
        use core::f32::consts::{FRAC_PI_2, FRAC_PI_4, PI};
        const SMALLEST: f32 = 1e-45;
        for (y, x, angle) in [
            (0.0, 0.0, 0.0),
            (-0.0, -0.0, 0.0),
            (0.0, 3.0, 0.0),
            (0.0, -3.0, PI),
            (-0.0, -3.0, PI),
            (2.0, 0.0, FRAC_PI_2),
            (-2.0, -0.0, -FRAC_PI_2),
            (1e30, 1e-30, FRAC_PI_2),
            (-1e-30, -1e30, -PI),
            (1e-30, 1e30, 0.0),
            (SMALLEST, SMALLEST, FRAC_PI_4),
            (SMALLEST, 0.0, FRAC_PI_2),
            (f32::MAX, f32::MAX, FRAC_PI_4),
            (-f32::MAX, f32::MAX, -FRAC_PI_4),
            (f32::MAX, -SMALLEST, FRAC_PI_2),
        ] {
            assert_eq!(atan2_f32(y, x), angle, "f32 ({y}, {x})");
            let found = atan2_f64(y.into(), x.into());
            assert_eq!(found as f32, angle, "f64 ({y}, {x})");
        }
        // Halved where the sum would overflow.
        let (y, x) = (f32::MAX, f32::MAX / 1.5);
        let truth = f64::from(y).atan2(x.into()) as f32;
        assert!((atan2_f32(y, x) - truth).abs() <= f32::EPSILON);
    }
}
