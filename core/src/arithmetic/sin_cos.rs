//! Sine and cosine together.
//!
//! x = k pi/2 + r with |r| <= pi/4. Up to pi/4, x is r. Up to some hundred radians, pi/2 is split
//! in three (after Cody and Waite) so that k times the first two parts is exact; r then comes with
//! a low part that holds what its rounding lost, so that results near their zeros keep all digits.
//! Beyond, [`reduction`](super::reduction) takes over. The polynomials are minimax for the
//! relative error of the sine and the absolute error of the cosine on |r| <= pi/4, coefficients
//! rounded one after the other, each refitted to the ones before it.

use super::polynomial::horner_pair;
use super::reduction::{reduce_f32, reduce_f64};

/// Sine and cosine of `x` radians, for any finite `x`. What is not finite gives two results that
/// are not numbers.
///
/// Each is within 1.0 units in the last place.
#[inline(always)]
pub(super) fn sin_cos_f32(x: f32) -> (f32, f32) {
    // Adding 2^23 + 128 rounds to an integer, which then stands in the low bits, offset by a
    // multiple of 4. The range check on those bits also catches what is not finite.
    const ROUND: f32 = 8_388_608.0 + 128.0;
    const RANGE: u32 = 256;
    if x.abs() <= core::f32::consts::FRAC_PI_4 {
        return near_f32(x, None);
    }
    let rounded = x * core::f32::consts::FRAC_2_PI + ROUND;
    let quadrant = rounded.to_bits().wrapping_sub(0x4b00_0000);
    if quadrant >= RANGE {
        return far_f32(x);
    }
    let k = rounded - ROUND;
    // 12 bits, 13 bits, 24 bits; the second part is negative.
    let a = x - k * 1.570_800_8;
    let b = k * 4.454_516e-6;
    let r = a + b;
    turned_f32(quadrant, r, (b - (r - a)) - k * 6.077_100_6e-11)
}

#[cold]
#[inline(never)]
fn far_f32(x: f32) -> (f32, f32) {
    if !x.is_finite() {
        return (f32::NAN, f32::NAN);
    }
    let (quadrant, r, low) = reduce_f32(x);
    turned_f32(quadrant, r, low)
}

/// Sine and cosine of `r` and, if there is one, its low part.
#[inline(always)]
fn near_f32(r: f32, low: Option<f32>) -> (f32, f32) {
    let z = r * r;
    // 1 - z/2 with what its rounding lost.
    let half = 0.5 * z;
    let most = 1.0 - half;
    let rest = (1.0 - most) - half;
    let (s, c) = horner_pair!(
        z;
        (-0.166_666_55, 0.041_666_653),
        (0.008_332_187, -0.001_388_761_8),
        (-0.000_195_178_97, 2.446_317_7e-5)
    );
    let (cube, square) = (r * z, z * z);
    let (mut sin, mut cos) = (cube * s, square * c);
    if let Some(low) = low {
        (sin, cos) = (low + sin, cos - r * low);
    }
    (r + sin, most + (rest + cos))
}

/// Sine and cosine of `quadrant` pi/2 + `r` + `low`.
#[inline(always)]
fn turned_f32(quadrant: u32, r: f32, low: f32) -> (f32, f32) {
    let (sin, cos) = near_f32(r, Some(low));
    match quadrant & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Sine and cosine of `x` radians, for any finite `x`, each within 1.0 units in the last place.
/// An angle that is not finite gives two results that are not numbers.
#[inline(always)]
pub(super) fn sin_cos_f64(x: f64) -> (f64, f64) {
    // As for f32, with 2^52 + 512.
    const ROUND: f64 = 4_503_599_627_370_496.0 + 512.0;
    const RANGE: u64 = 1024;
    if x.abs() <= core::f64::consts::FRAC_PI_4 {
        return near_f64(x, None);
    }
    let rounded = x * core::f64::consts::FRAC_2_PI + ROUND;
    let quadrant = rounded.to_bits().wrapping_sub(0x4330_0000_0000_0000);
    if quadrant >= RANGE {
        return far_f64(x);
    }
    let k = rounded - ROUND;
    // 33 bits, 33 bits, 53 bits.
    let a = x - k * 1.570_796_326_734_125_6;
    let b = k * 6.077_100_506_303_966e-11;
    let r = a - b;
    let low = ((a - r) - b) - k * 2.022_266_248_795_950_6e-21;
    turned_f64(quadrant as u32, r, low)
}

#[cold]
#[inline(never)]
fn far_f64(x: f64) -> (f64, f64) {
    if !x.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    let (quadrant, r, low) = reduce_f64(x);
    turned_f64(quadrant, r, low)
}

/// Sine and cosine of `r` and, if there is one, its low part.
#[inline(always)]
fn near_f64(r: f64, low: Option<f64>) -> (f64, f64) {
    let z = r * r;
    // 1 - z/2 with what its rounding lost.
    let half = 0.5 * z;
    let most = 1.0 - half;
    let rest = (1.0 - most) - half;
    let (s, c) = horner_pair!(
        z;
        (-0.166_666_666_666_666_3, 0.041_666_666_666_666_6),
        (0.008_333_333_333_321_84, -0.001_388_888_888_887_024),
        (-0.000_198_412_698_293_585_3, 2.480_158_728_530_095_2e-5),
        (2.755_731_353_851_551_3e-6, -2.755_731_279_746_451e-7),
        (-2.505_073_438_942_018e-8, 2.087_547_868_203_909_4e-9),
        (1.589_543_329_293_057e-10, -1.134_574_885_473_565e-11)
    );
    let (cube, square) = (r * z, z * z);
    let (mut sin, mut cos) = (cube * s, square * c);
    if let Some(low) = low {
        (sin, cos) = (low + sin, cos - r * low);
    }
    (r + sin, most + (rest + cos))
}

/// Sine and cosine of `quadrant` pi/2 + `r` + `low`.
#[inline(always)]
fn turned_f64(quadrant: u32, r: f64, low: f64) -> (f64, f64) {
    let (sin, cos) = near_f64(r, Some(low));
    match quadrant & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

#[cfg(test)]
mod tests {
    use super::super::reference::SIN_COS;
    use super::*;
    use trirrr_double_double::DoubleDouble;

    /// Largest errors so far of the sine's polynomial and of the cosine's, in units in the last
    /// place.
    #[derive(Debug, Default)]
    struct Worst {
        sin: f64,
        cos: f64,
    }

    impl Worst {
        fn note(&mut self, odd_quadrant: bool, sin: f64, cos: f64) {
            let (sin, cos) = if odd_quadrant { (cos, sin) } else { (sin, cos) };
            self.sin = self.sin.max(sin);
            self.cos = self.cos.max(cos);
        }

        fn note_f32(&mut self, x: f32) {
            // The platform's f64 functions, below one unit of f64, are the reference.
            let (sin, cos) = f64::from(x).sin_cos();
            let ulps = |value: f32, truth: f64| {
                let size = (truth as f32).abs();
                (f64::from(value) - truth).abs() / f64::from(size.next_up() - size)
            };
            let (s, c) = sin_cos_f32(x);
            self.note(odd_quadrant(x.into()), ulps(s, sin), ulps(c, cos));
        }

        fn note_f64(&mut self, x: f64, sin: DoubleDouble, cos: DoubleDouble) {
            let (s, c) = sin_cos_f64(x);
            self.note(odd_quadrant(x), sin.ulps(s), cos.ulps(c));
        }
    }

    /// In odd quadrants, those around pi/2 and 3 pi/2, the sine is the larger of the two.
    fn odd_quadrant(x: f64) -> bool {
        let (sin, cos) = x.sin_cos();
        sin.abs() > cos.abs()
    }

    #[test]
    fn f32_error_is_as_documented() {
        // Every 13th float from 2^-14 to 1000, and every 997th from there to the largest.
        let mut near = Worst::default();
        let mut far = Worst::default();
        for bits in (0x3880_0000..1000f32.to_bits()).step_by(13) {
            near.note_f32(f32::from_bits(bits));
            near.note_f32(-f32::from_bits(bits + 5));
        }
        for bits in (1000f32.to_bits()..=f32::MAX.to_bits()).step_by(997) {
            far.note_f32(f32::from_bits(bits));
        }
        far.note_f32(f32::MAX);
        for (x, _, _) in SIN_COS {
            if (x as f32).is_finite() {
                far.note_f32(x as f32);
            }
        }
        std::println!("f32: {near:?} beyond 1000: {far:?}");
        assert!((0.95..1.0).contains(&near.sin), "{near:?}");
        assert!((0.75..0.85).contains(&near.cos), "{near:?}");
        assert!((0.95..1.0).contains(&far.sin), "{far:?}");
        assert!((0.75..0.85).contains(&far.cos), "{far:?}");
    }

    #[test]
    fn f64_error_is_as_documented() {
        let mut sweep = Worst::default();
        let mut x = 1e-9;
        while x < 1000.0 {
            for x in [x, -x * 1.000_003, (x * 700.0) % 1000.0] {
                let (sin, cos) = DoubleDouble::new(x).sin_cos();
                sweep.note_f64(x, sin, cos);
            }
            x *= 1.000_3;
        }
        // Neighbours of the multiples of pi/4, where the results and the quadrants change.
        for k in 1..1200 {
            let mut x = f64::from(k) * core::f64::consts::FRAC_PI_4;
            for _ in 0..8 {
                let (sin, cos) = DoubleDouble::new(x).sin_cos();
                sweep.note_f64(x, sin, cos);
                x = x.next_up();
            }
        }
        let mut table = Worst::default();
        for (x, sin, cos) in SIN_COS {
            let sum = |(hi, lo)| DoubleDouble::sum(hi, lo);
            table.note_f64(x, sum(sin), sum(cos));
        }
        std::println!("f64: {sweep:?} table: {table:?}");
        assert!((0.9..1.0).contains(&sweep.sin), "{sweep:?}");
        assert!((0.7..0.9).contains(&sweep.cos), "{sweep:?}");
        assert!(table.sin < 1.0 && table.cos < 0.9, "{table:?}");
    }

    #[test]
    fn small_and_special_angles() {
        assert_eq!(sin_cos_f32(0.0), (0.0, 1.0));
        assert_eq!(sin_cos_f64(0.0), (0.0, 1.0));
        assert_eq!(sin_cos_f32(1e-45), (1e-45, 1.0));
        assert_eq!(sin_cos_f64(-5e-324), (-5e-324, 1.0));
        for x in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            let (sin, cos) = sin_cos_f32(x);
            assert!(sin.is_nan() && cos.is_nan());
            let (sin, cos) = sin_cos_f64(x.into());
            assert!(sin.is_nan() && cos.is_nan());
        }
    }
}
