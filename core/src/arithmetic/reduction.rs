//! Argument reduction for angles beyond the reach of the Cody-Waite constants of
//! [`sin_cos`](super::sin_cos), after Payne and Hanek: the product of the significand with only
//! those bits of 2/pi that matter, in integers.
//!
//! With x = m 2^e, the bits of 2/pi of weight above 2^(2 - e) contribute whole turns to
//! x 2/pi and are skipped; the window that follows, times m, modulo its own width, is
//! x 2/pi modulo 4: two bits of quadrant, then the fraction.

/// The first 1216 bits of 2/pi behind two words of zeros (which stand for its integer part), most
/// significant first.
const TWO_OVER_PI: [u32; 40] = [
    0,
    0,
    0xa2f9_836e,
    0x4e44_1529,
    0xfc27_57d1,
    0xf534_ddc0,
    0xdb62_9599,
    0x3c43_9041,
    0xfe51_63ab,
    0xdebb_c561,
    0xb724_6e3a,
    0x424d_d2e0,
    0x0649_2eea,
    0x09d1_921c,
    0xfe1d_eb1c,
    0xb129_a73e,
    0xe882_35f5,
    0x2ebb_4484,
    0xe99c_7026,
    0xb45f_7e41,
    0x3991_d639,
    0x8353_39f4,
    0x9c84_5f8b,
    0xbdf9_283b,
    0x1ff8_97ff,
    0xde05_980f,
    0xef2f_118b,
    0x5a0a_6d1f,
    0x6d36_7ecf,
    0x27cb_09b7,
    0x4f46_3f66,
    0x9e5f_ea2d,
    0x7527_bac7,
    0xebe5_f17b,
    0x3d07_39f7,
    0x8a52_92ea,
    0x6bfb_5fb1,
    0x1f8d_5d08,
    0x5603_3046,
    0xfc7b_6bab,
];

/// The part of [`TWO_OVER_PI`] that `f32` needs, so that an image without `f64` does not carry the rest.
const TWO_OVER_PI_F32: [u32; 8] = {
    let mut head = [0; 8];
    let mut i = 0;
    while i < 8 {
        head[i] = TWO_OVER_PI[i + 1];
        i += 1;
    }
    head
};

/// 32 bits of the table from bit `position` on.
#[inline]
fn window(table: &[u32], position: usize) -> u32 {
    let (word, shift) = (position >> 5, position & 31);
    // Indexing would leave a panic in the image; no float's exponent reaches beyond the table.
    let at = |word: usize| table.get(word).copied().unwrap_or(0) as u64;
    let pair = at(word) << 32 | at(word + 1);
    (pair << shift >> 32) as u32
}

/// `x` = `quadrant` pi/2 + r, |r| <= pi/4, for finite `x` with 2^-7 <= |x|. Returns the quadrant
/// (its two low bits count) and r as a sum of two floats, relative error below 2^-29.
#[cold]
#[inline(never)]
pub(super) fn reduce_f32(x: f32) -> (u32, f32, f32) {
    let bits = x.to_bits();
    let significand = (bits & 0x007f_ffff | 0x0080_0000) as u64;
    let exponent = (bits >> 23 & 0xff) as i32 - 150;
    let position = (exponent - 2 + 32) as usize;
    let word = |i: usize| significand * window(&TWO_OVER_PI_F32, position + 32 * i) as u64;
    // Truncation of the table: below 2^(24 - 94) quadrants, and no f32 comes closer to a
    // multiple of pi/2 than 2^-30.
    let turns = (word(0) << 32)
        .wrapping_add(word(1))
        .wrapping_add(word(2) >> 32);
    let quadrant = (turns >> 61).wrapping_add(1) >> 1;
    let fraction = turns.wrapping_sub(quadrant << 62) as i64;
    let magnitude = fraction.unsigned_abs();
    let zeros = magnitude.leading_zeros();
    // pi/2 in units of 2^-31.
    let product = (magnitude << zeros >> 32) * 0xc90f_daa2;
    let high = (product >> 40) as u32 as f32 * f32::from_bits((127 - 21 - zeros) << 23);
    let low =
        ((product >> 16) as u32 & 0x00ff_ffff) as f32 * f32::from_bits((127 - 45 - zeros) << 23);
    let quadrant = quadrant as u32;
    match (fraction < 0, bits >> 31 != 0) {
        (false, false) => (quadrant, high, low),
        (true, false) => (quadrant, -high, -low),
        (false, true) => (quadrant.wrapping_neg(), -high, -low),
        (true, true) => (quadrant.wrapping_neg(), high, low),
    }
}

/// The same for `f64`, relative error below 2^-60.
#[cold]
#[inline(never)]
pub(super) fn reduce_f64(x: f64) -> (u32, f64, f64) {
    let bits = x.to_bits();
    let significand = (bits & 0x000f_ffff_ffff_ffff | 0x0010_0000_0000_0000) as u128;
    let exponent = (bits >> 52 & 0x7ff) as i32 - 1075;
    let position = (exponent - 2 + 64) as usize;
    let word = |i: usize| {
        let at = position + 64 * i;
        let high = window(&TWO_OVER_PI, at) as u64;
        significand * (high << 32 | window(&TWO_OVER_PI, at + 32) as u64) as u128
    };
    // Truncation of the table: below 2^(53 - 190) quadrants, and no f64 comes closer to a
    // multiple of pi/2 than 2^-62.
    let turns = (word(0) << 64)
        .wrapping_add(word(1))
        .wrapping_add(word(2) >> 64);
    let quadrant = (turns >> 125).wrapping_add(1) >> 1;
    let fraction = turns.wrapping_sub(quadrant << 126) as i128;
    let magnitude = fraction.unsigned_abs();
    let zeros = magnitude.leading_zeros() as u64;
    // pi/2 in units of 2^-63.
    let product = (magnitude << zeros >> 64) * 0xc90f_daa2_2168_c235;
    let high = (product >> 75) as u64 as f64 * f64::from_bits((1023 - 50 - zeros) << 52);
    let low = ((product >> 22) as u64 & 0x001f_ffff_ffff_ffff) as f64
        * f64::from_bits((1023 - 103 - zeros) << 52);
    let quadrant = quadrant as u32;
    match (fraction < 0, bits >> 63 != 0) {
        (false, false) => (quadrant, high, low),
        (true, false) => (quadrant, -high, -low),
        (false, true) => (quadrant.wrapping_neg(), -high, -low),
        (true, true) => (quadrant.wrapping_neg(), high, low),
    }
}
