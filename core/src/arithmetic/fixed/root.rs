//! The reciprocal square root of a normalised number.

use super::product::{rounded, signed_by_short, square_of_high, unsigned, within_sign};
use super::reciprocal::{on_line, packed};

/// 1/sqrt(z) on 48 equal parts of 1/4 <= z < 1, in 2^-15, as in the reciprocal. Offline by mpmath.
#[rustfmt::skip]
static LINES: [u32; 64] = packed([
    (65525, 1957), (63570, 1791), (61780, 1648), (60133, 1523), (58611, 1413), (57199, 1315),
    (55884, 1228), (54656, 1151), (53506, 1081), (52425, 1018), (51407, 961), (50447, 909),
    (49538, 862), (48676, 818), (47858, 778), (47080, 742), (46339, 708), (45632, 676),
    (44956, 647), (44309, 620), (43689, 594), (43095, 571), (42524, 549), (41975, 528),
    (41447, 509), (40939, 490), (40449, 473), (39976, 457), (39519, 442), (39077, 427),
    (38650, 413), (38237, 400), (37836, 388), (37448, 376), (37072, 365), (36707, 355),
    (36352, 345), (36008, 335), (35673, 326), (35347, 317), (35030, 309), (34721, 301),
    (34421, 293), (34128, 286), (33842, 279), (33564, 272), (33292, 265), (33027, 259),
]);

/// 1/sqrt(z) in 2^-30 for z in 2^-32, 1/4 <= z < 1: a value in (2^30, 2^31).
///
/// The line is off by less than 2.3e-4 of the value; one step of the third order takes that below
/// the rounding. The error is below 0.54 units, at z = 1/4, which has no room, 1 unit.
#[inline(always)]
pub(crate) fn inverse_root(z: u32) -> i32 {
    let line = on_line(&LINES, z);
    // r = 1 - z y^2; 1/sqrt(z) = y / sqrt(1 - r) = y (1 + r/2 + 3 r^2/8 + ...). z is in 2^-32 and
    // y^2 in 2^-30, exact; r in 2^-42.
    // What 1 is in the product is beyond the 32 bits that are kept.
    let r = ((unsigned(z, line * line) >> 20) as i32).wrapping_neg();
    // r/2 in 2^-43 has the bits of r in 2^-42; r^2 in 2^-52.
    let correction = r + ((3 * (square_of_high(r) >> 10)) >> 2);
    let y = (line << 15) as i32;
    within_sign(y.wrapping_add(rounded::<28>(signed_by_short(correction, line))))
}

/// The root of `wide`, rounded to nearest; at most 2^62.
pub(super) fn integer_root(wide: u64) -> u32 {
    let (mut left, mut root, mut bit) = (wide, 0u64, 1u64 << 62);
    while bit != 0 {
        if left >= root + bit {
            left -= root + bit;
            root = (root >> 1) + bit;
        } else {
            root >>= 1;
        }
        bit >>= 2;
    }
    // The next half lies at root^2 + root + 1/4.
    (root + u64::from(left > root)) as u32
}
