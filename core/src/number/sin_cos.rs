//! Sine and cosine together.

use super::polynomial::horner;
use super::reduction::{reduce_f32, reduce_f64};

/// Sine and cosine of `x` radians.
#[inline(always)]
pub(super) fn sin_cos_f32(x: f32) -> (f32, f32) {
    const MAGIC: f32 = 8_388_608.0 + 512.0;
    let shifted = x * core::f32::consts::FRAC_2_PI + MAGIC;
    let count = shifted.to_bits().wrapping_sub(0x4b00_0000);
    if count >= 1024 {
        return far_f32(x);
    }
    let k = shifted - MAGIC;
    let a = x - k * 1.570_800_8;
    let b = k * 4.454_516e-6;
    let r = a + b;
    let low = (b - (r - a)) - k * 6.077_100_6e-11;
    turn_f32(count, r, low)
}

#[cold]
#[inline(never)]
fn far_f32(x: f32) -> (f32, f32) {
    if !x.is_finite() {
        return (f32::NAN, f32::NAN);
    }
    let (quadrant, r, low) = reduce_f32(x);
    turn_f32(quadrant, r, low)
}

#[inline(always)]
fn turn_f32(quadrant: u32, r: f32, low: f32) -> (f32, f32) {
    let z = r * r;
    let s = horner!(z; -0.166_666_55, 0.008_332_187, -0.000_195_178_97);
    let sin = r + (low + r * z * s);
    let c = horner!(z; 0.041_666_653, -0.001_388_761_8, 2.446_317_7e-5);
    let cos = 1.0 - (z * (0.5 - z * c) + r * low);
    let (sin, cos) = if quadrant & 1 == 0 {
        (sin, cos)
    } else {
        (cos, -sin)
    };
    if quadrant & 2 == 0 {
        (sin, cos)
    } else {
        (-sin, -cos)
    }
}

/// Sine and cosine of `x` radians.
#[inline(always)]
pub(super) fn sin_cos_f64(x: f64) -> (f64, f64) {
    const MAGIC: f64 = 4_503_599_627_370_496.0 + 512.0;
    let shifted = x * core::f64::consts::FRAC_2_PI + MAGIC;
    let count = shifted.to_bits().wrapping_sub(0x4330_0000_0000_0000);
    if count >= 1024 {
        return far_f64(x);
    }
    let k = shifted - MAGIC;
    let a = x - k * 1.570_796_326_734_125_6;
    let b = k * 6.077_100_506_303_966e-11;
    let r = a - b;
    let low = ((a - r) - b) - k * 2.022_266_248_795_950_6e-21;
    turn_f64(count as u32, r, low)
}

#[cold]
#[inline(never)]
fn far_f64(x: f64) -> (f64, f64) {
    if !x.is_finite() {
        return (f64::NAN, f64::NAN);
    }
    let (quadrant, r, low) = reduce_f64(x);
    turn_f64(quadrant, r, low)
}

#[inline(always)]
fn turn_f64(quadrant: u32, r: f64, low: f64) -> (f64, f64) {
    let z = r * r;
    let s = horner!(
        z;
        -0.166_666_666_666_666_3,
        0.008_333_333_333_321_84,
        -0.000_198_412_698_293_585_3,
        2.755_731_353_851_551_3e-6,
        -2.505_073_438_942_018e-8,
        1.589_543_329_293_057e-10
    );
    let sin = r + (low + r * z * s);
    let c = horner!(
        z;
        0.041_666_666_666_666_6,
        -0.001_388_888_888_887_024,
        2.480_158_728_530_095_2e-5,
        -2.755_731_279_746_451e-7,
        2.087_547_868_203_909_4e-9,
        -1.134_574_885_473_565e-11
    );
    let cos = 1.0 - (z * (0.5 - z * c) + r * low);
    let (sin, cos) = if quadrant & 1 == 0 {
        (sin, cos)
    } else {
        (cos, -sin)
    };
    if quadrant & 2 == 0 {
        (sin, cos)
    } else {
        (-sin, -cos)
    }
}
