//! The reciprocal of a normalised number.

use super::product::{rounded, signed_by_short, square_of_high, unsigned_by_short, within_sign};

/// 1/z on 32 equal parts of 1/2 <= z < 1, in 2^-15: the line of least relative error, as its value
/// at the part's lower end and its fall over the part. Offline by mpmath.
#[rustfmt::skip]
static LINES: [u32; 32] = packed([
    (65528, 1986), (63543, 1869), (61675, 1762), (59913, 1664), (58249, 1574), (56675, 1492),
    (55184, 1415), (53769, 1344), (52425, 1279), (51146, 1218), (49929, 1161), (48768, 1108),
    (47660, 1059), (46601, 1013), (45588, 970), (44618, 930), (43688, 892), (42797, 856),
    (41941, 822), (41119, 791), (40328, 761), (39567, 733), (38835, 706), (38129, 681),
    (37448, 657), (36791, 634), (36156, 613), (35544, 592), (34951, 573), (34378, 555),
    (33824, 537), (33287, 520),
]);

/// 1/z in 2^-30 for z in 2^-32, 1/2 <= z < 1: a value in (2^30, 2^31).
///
/// The line is off by less than 2^-12 of the value; one step of the third order takes that below
/// the rounding. The error is below 0.51 units, at z = 1/2, which has no room, 1 unit.
#[inline(always)]
pub(crate) fn reciprocal(z: u32) -> i32 {
    let line = on_line(&LINES, z);
    // e = 1 - z y; 1/z = y / (1 - e) = y (1 + e + e^2 + ...). z y is exact in 2^-47, e in 2^-43.
    // What 1 is in the product is beyond the 32 bits that are kept.
    let e = ((unsigned_by_short(z, line) >> 4) as i32).wrapping_neg();
    let e = e + (square_of_high(e) >> 11);
    let y = (line << 15) as i32;
    within_sign(y.wrapping_add(rounded::<28>(signed_by_short(e, line))))
}

/// Lines as [`on_line`] reads them; the `COUNT` parts end at 1.
pub(super) const fn packed<const COUNT: usize, const SIZE: usize>(
    lines: [(u16, u16); COUNT],
) -> [u32; SIZE] {
    let mut packed = [0; SIZE];
    let mut part = 0;
    while part < COUNT {
        let (start, fall) = lines[part];
        packed[SIZE - COUNT + part] = ((start as u32) << 16) | fall as u32;
        part += 1;
    }
    packed
}

/// The value at `z` of the line of its part, in 2^-15. As many of the top 6 bits of `z` name it as the table
/// needs; its size is a power of two.
#[inline(always)]
pub(super) fn on_line<const SIZE: usize>(lines: &[u32; SIZE], z: u32) -> u32 {
    let line = lines[(z >> 26) as usize & (SIZE - 1)];
    let within = (z >> 10) & 0xffff;
    // The fall's own bits below the start add less than a unit.
    line.wrapping_sub((line & 0xffff) * within) >> 16
}
