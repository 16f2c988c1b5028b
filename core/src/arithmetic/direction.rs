//! The direction of a vector whose length is known.
//!
//! The vector is turned back by the multiple of pi/4 next to its direction. What is left of the angle,
//! below 24 degrees, is the arcsine of one component over the length. There is no division and no
//! branch. Several directions are computed step by step beside each other: none waits for itself.

/// One of the eight directions that vectors are turned back by. Four numbers: the place of a turn in a table is
/// a shift away.
struct Turn<N> {
    /// Cosine and sine over the larger of the two: 0 or 1 in size, so that products with them are exact.
    cos: N,
    sin: N,
    /// The larger of the two.
    scale: N,
    angle: N,
}

macro_rules! direction {
    (
        $(#[$doc:meta])* $name:ident, $float:ident, $bits:ident, $seam:expr, $turns:ident,
        $arcsine:ident
    ) => {
        /// The direction next to a vector. An index has four bits: near the x axis, near the y axis, the
        /// signs of x and of y. No vector is near both axes.
        static $turns: [Turn<$float>; 16] = {
            use core::$float::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4, PI};
            const fn axis(cos: $float, sin: $float, angle: $float) -> Turn<$float> {
                let scale = 1.0;
                Turn { cos, sin, scale, angle }
            }
            const fn diagonal(cos: $float, sin: $float, angle: $float) -> Turn<$float> {
                let scale = FRAC_1_SQRT_2;
                Turn { cos, sin, scale, angle }
            }
            const OBTUSE: $float = 3.0 * FRAC_PI_4;
            const EAST: Turn<$float> = axis(1.0, 0.0, 0.0);
            const NORTH: Turn<$float> = axis(0.0, 1.0, FRAC_PI_2);
            const SOUTH: Turn<$float> = axis(0.0, -1.0, -FRAC_PI_2);
            [
                diagonal(1.0, 1.0, FRAC_PI_4),
                diagonal(1.0, -1.0, -FRAC_PI_4),
                diagonal(-1.0, 1.0, OBTUSE),
                diagonal(-1.0, -1.0, -OBTUSE),
                NORTH,
                SOUTH,
                NORTH,
                SOUTH,
                EAST,
                EAST,
                axis(-1.0, 0.0, PI),
                axis(-1.0, 0.0, -PI),
                EAST,
                EAST,
                EAST,
                EAST,
            ]
        };

        /// Angles of the vectors (x, y) in [-pi, pi]; `inverse` is 1 over the length of each.
        $(#[$doc])*
        #[inline(always)]
        pub(super) fn $name<const COUNT: usize>(
            x: [$float; COUNT],
            y: [$float; COUNT],
            inverse: [$float; COUNT],
        ) -> [$float; COUNT] {
            use core::array::from_fn;
            let turns: [&Turn<$float>; COUNT] = from_fn(|i| {
                const SIGN: u32 = $bits::BITS - 1;
                let (x, y) = (x[i].to_bits(), y[i].to_bits());
                // The bits of a positive float are nearly a logarithm. Where two components differ by a
                // factor of 2.29 to 2.5, 21.8 to 23.7 degrees from an axis, is the seam.
                let size = |bits: $bits| bits & ($bits::MAX >> 1);
                let steepness = size(y).wrapping_sub(size(x));
                let near_x = steepness.wrapping_add($seam) >> SIGN;
                let near_y = $bits::wrapping_sub($seam, steepness) >> SIGN;
                let near = near_x << 1 | near_y;
                let signs = x >> SIGN << 1 | y >> SIGN;
                &$turns[(near << 2 | signs) as usize]
            });
            let across: [$float; COUNT] = from_fn(|i| y[i] * turns[i].cos);
            let along: [$float; COUNT] = from_fn(|i| x[i] * turns[i].sin);
            let scale: [$float; COUNT] = from_fn(|i| inverse[i] * turns[i].scale);
            let rest: [$float; COUNT] = from_fn(|i| across[i] - along[i]);
            let arcsine: [$float; COUNT] = $arcsine(from_fn(|i| rest[i] * scale[i]));
            from_fn(|i| turns[i].angle + arcsine[i])
        }
    };
}

/// s + s z (c0 + c1 z + ...), z = s^2, of several numbers step by step.
macro_rules! odd_polynomial {
    ($(#[$doc:meta])* $name:ident, $float:ident; $last:expr $(, $coefficient:expr)+) => {
        $(#[$doc])*
        #[inline(always)]
        fn $name<const COUNT: usize>(s: [$float; COUNT]) -> [$float; COUNT] {
            use core::array::from_fn;
            let z: [$float; COUNT] = from_fn(|i| s[i] * s[i]);
            let mut p = [$last; COUNT];
            $(
                let product: [$float; COUNT] = from_fn(|i| p[i] * z[i]);
                p = from_fn(|i| product[i] + $coefficient);
            )+
            let cube: [$float; COUNT] = from_fn(|i| s[i] * z[i]);
            let tail: [$float; COUNT] = from_fn(|i| cube[i] * p[i]);
            from_fn(|i| s[i] + tail[i])
        }
    };
}

odd_polynomial! {
    /// Arcsines for |s| <= 0.4015: minimax for the relative error, 7.9e-9. The last coefficient comes first.
    arcsines_f32, f32;
    0.041_369_118, 0.043_041_63, 0.075_088_896, 0.166_665_15
}

odd_polynomial! {
    /// Arcsines for |s| <= 0.4015: minimax for the relative error, 6.7e-19. The last coefficient comes first.
    arcsines_f64, f64;
    0.018_085_804_661_391_217,
    0.003_078_209_453_878_397,
    0.011_150_506_557_799_224,
    0.011_328_786_947_226_437,
    0.013_988_088_719_428_613,
    0.017_351_167_179_189_633,
    0.022_372_230_599_011_084,
    0.030_381_942_438_727_76,
    0.044_642_857_175_458_92,
    0.074_999_999_999_736_26,
    0.166_666_666_666_667_4
}

direction! {
    /// The error is below 3.1 units in the last place when the reciprocal is correctly rounded.
    directions_f32, f32, u32, 0x00a0_0000, TURNS_F32, arcsines_f32
}
direction! {
    /// The error is below 3.1 units in the last place when the reciprocal is correctly rounded.
    directions_f64, f64, u64, 0x0014_0000_0000_0000, TURNS_F64, arcsines_f64
}

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
                // Of the length that this very point has, rounded once.
                let inverse = (1.0 / std::primitive::f64::hypot(xd, yd)) as f32;
                let truth = std::primitive::f64::atan2(yd, xd);
                let ulp = (truth as f32).abs().next_up() - (truth as f32).abs();
                let error = f64::from(directions_f32([x], [y], [inverse])[0]) - truth;
                worst = worst.max(error.abs() / f64::from(ulp));
            }
        }
        std::println!("direction_f32: {worst:.3} ulp");
        assert!((2.9..3.1).contains(&worst), "{worst} ulp");
    }

    #[test]
    fn f64_error_is_as_documented() {
        // The reference is atan2 of the same kernel family, itself within an ulp of the truth;
        // its polynomial is the same, its reduction and its constants are not.
        let mut worst: f64 = 0.0;
        for length in [0.2f64, 1.0, 37.25] {
            for (x, y) in points(length) {
                let inverse = 1.0 / std::primitive::f64::hypot(x, y);
                let truth = std::primitive::f64::atan2(y, x);
                let ulp = truth.abs().next_up() - truth.abs();
                worst = worst.max((directions_f64([x], [y], [inverse])[0] - truth).abs() / ulp);
            }
        }
        std::println!("direction_f64: {worst:.3} ulp");
        assert!((2.9..3.1).contains(&worst), "{worst} ulp");
    }

    #[test]
    fn is_exact_on_the_axes() {
        use core::f32::consts::{FRAC_PI_2, PI};
        assert_eq!(directions_f32([2.0], [0.0], [0.5])[0], 0.0);
        assert_eq!(directions_f32([0.0], [2.0], [0.5])[0], FRAC_PI_2);
        assert_eq!(directions_f32([-2.0], [0.0], [0.5])[0], PI);
        assert_eq!(directions_f32([0.0], [-2.0], [0.5])[0], -FRAC_PI_2);
    }
}
