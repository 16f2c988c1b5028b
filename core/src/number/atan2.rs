//! The angle of a plane vector.

use super::polynomial::horner;
use core::f32::consts as c32;
use core::f64::consts as c64;

/// Arctangent of `t`, |t| <= tan(pi / 8), less `t` itself.
#[inline(always)]
fn atan_tail_f32(t: f32) -> f32 {
    let z = t * t;
    let p = horner!(
        z;
        -0.333_333_16,
        0.199_985_28,
        -0.142_443_91,
        0.105_991_684,
        -0.060_900_52
    );
    t * z * p
}

/// Arctangent of `t`, |t| <= tan(pi / 8).
#[inline(always)]
pub(super) fn atan_small_f32(t: f32) -> f32 {
    t + atan_tail_f32(t)
}

/// Angle of (x, y) in radians.
#[inline(always)]
pub(super) fn atan2_f32(y: f32, x: f32) -> f32 {
    const TAN_PI_8: f32 = 0.414_213_57;
    let h = y.abs();
    let w = x.abs();
    let (n, d, k, k_low) = if h <= TAN_PI_8 * w {
        if x > 0.0 {
            (h, x, 0.0, 0.0)
        } else {
            (h, x, c32::PI, -8.742_278e-8)
        }
    } else if w < TAN_PI_8 * h {
        (-x, h, c32::FRAC_PI_2, -4.371_139e-8)
    } else if x > 0.0 {
        (h - x, h + x, c32::FRAC_PI_4, -2.185_569_4e-8)
    } else if x < 0.0 {
        (-(h + x), h - x, 2.356_194_5, -5.962_440_3e-9)
    } else {
        (h, 1.0, 0.0, 0.0)
    };
    let d = if h == 0.0 && x == 0.0 { 1.0 } else { d };
    let t = n / d;
    let angle = k + (t + (atan_tail_f32(t) + k_low));
    if y < 0.0 { -angle } else { angle }
}

/// Arctangent of `t`, |t| <= tan(pi / 8), less `t` itself.
#[inline(always)]
fn atan_tail_f64(t: f64) -> f64 {
    let z = t * t;
    let p = horner!(
        z;
        -0.333_333_333_333_332,
        0.199_999_999_999_536_74,
        -0.142_857_142_801_999_6,
        0.111_111_107_835_250_24,
        -0.090_908_977_587_288_14,
        0.076_920_602_358_638_75,
        -0.066_631_044_256_009_77,
        0.058_478_933_946_189_46,
        -0.050_393_299_491_561_04,
        0.038_065_384_003_302_05,
        -0.017_908_313_163_642_057
    );
    t * z * p
}

/// Arctangent of `t`, |t| <= tan(pi / 8).
#[inline(always)]
pub(super) fn atan_small_f64(t: f64) -> f64 {
    t + atan_tail_f64(t)
}

/// Angle of (x, y) in radians.
#[inline(always)]
pub(super) fn atan2_f64(y: f64, x: f64) -> f64 {
    const TAN_PI_8: f64 = 0.414_213_562_373_095_03;
    let h = y.abs();
    let w = x.abs();
    let (n, d, k, k_low) = if h <= TAN_PI_8 * w {
        if x > 0.0 {
            (h, x, 0.0, 0.0)
        } else {
            (h, x, c64::PI, 1.224_646_799_147_353_2e-16)
        }
    } else if w < TAN_PI_8 * h {
        (-x, h, c64::FRAC_PI_2, 6.123_233_995_736_766e-17)
    } else if x > 0.0 {
        (h - x, h + x, c64::FRAC_PI_4, 3.061_616_997_868_383e-17)
    } else if x < 0.0 {
        (
            -(h + x),
            h - x,
            2.356_194_490_192_345,
            9.184_850_993_605_148e-17,
        )
    } else {
        (h, 1.0, 0.0, 0.0)
    };
    let d = if h == 0.0 && x == 0.0 { 1.0 } else { d };
    let t = n / d;
    let angle = k + (t + (atan_tail_f64(t) + k_low));
    if y < 0.0 { -angle } else { angle }
}
