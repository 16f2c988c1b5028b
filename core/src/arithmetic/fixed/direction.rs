//! The direction of a vector, in turns.

use super::product::{opaque, rounded, signed, signed_high};
use crate::to_source;

/// For the sines (2 k + 1) / 128 up to that of an eighth of a turn: the cosine in 2^-31, and the
/// angle in 2^-32 of a turn. Offline by mpmath.
#[rustfmt::skip]
static ARCS: [(i32, u32); 64] = to_64([
    (2147418111, 5340408), (2146893743, 16022528), (2145844623, 26708564),
    (2144269979, 37401135), (2142168655, 48102875), (2139539097, 58816439),
    (2136379355, 69544508), (2132687072, 80289795), (2128459478, 91055052),
    (2123693375, 101843079), (2118385129, 112656724), (2112530652, 123498899),
    (2106125390, 134372580), (2099164300, 145280822), (2091641834, 156226761),
    (2083551911, 167213628), (2074887893, 178244759), (2065642557, 189323602),
    (2055808059, 200453730), (2045375902, 211638858), (2034336890, 222882849),
    (2022681089, 234189736), (2010397769, 245563734), (1997475355, 257009260),
    (1983901358, 268530954), (1969662307, 280133698), (1954743668, 291822645),
    (1939129757, 303603242), (1922803635, 315481265), (1905746999, 327462853),
    (1887940049, 339554544), (1869361344, 351763325), (1849987633, 364096678),
    (1829793663, 376562641), (1808751960, 389169873), (1786832578, 401927731),
    (1764002797, 414846360), (1740226788, 427936794), (1715465208, 441211081),
    (1689674729, 454682423), (1662807474, 468365347), (1634810357, 482275905),
    (1605624275, 496431923), (1575183138, 510853289), (1543412689, 525562319),
    (1510229034, 540584200),
]);

/// The arcs, the last one repeated, so that 6 bits always name one.
const fn to_64<const COUNT: usize>(arcs: [(i32, u32); COUNT]) -> [(i32, u32); 64] {
    let mut all = [arcs[COUNT - 1]; 64];
    let mut arc = 0;
    while arc < COUNT {
        all[arc] = arcs[arc];
        arc += 1;
    }
    all
}

/// The inverse of a length, prepared for directions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Inverse {
    /// 2^44 / length, rounded down.
    sine: u32,
    /// 2^61 / (pi length): to 2^-37 of a turn.
    turns: i32,
}

to_source!([] Inverse [] in trirrr_core::number::fixed { sine: u32, turns: i32 });

impl Inverse {
    /// From 2^60 / `length`, the length in (2^29, 2^30\].
    #[inline(always)]
    pub(super) fn new(inverse: i32) -> Self {
        /// 2^31 / pi.
        const TO_TURNS: i32 = 683_565_276;
        Self {
            sine: inverse as u32 >> 16,
            turns: rounded::<30>(signed(inverse, TO_TURNS)),
        }
    }
}

/// Angle of (x, y) in 2^-32 of a turn, from -2^31 (exclusive) to 2^31.
///
/// The vector's length in (2^29, 2^30\] is given by its `inverse`. The smaller of the components
/// picks an arc of the table; what is left of the angle is the arcsine of the cross product with
/// it, below 0.012, of which two terms serve.
#[inline(always)]
pub(super) fn direction(x: i32, y: i32, inverse: Inverse) -> i64 {
    /// (2 pi)^2 / 6 in 2^-26 of what the product of shortened factors needs.
    const CUBE: i32 = 421;
    let (width, height) = (x.wrapping_abs(), y.wrapping_abs());
    let steep = height > width;
    let (small, large) = if steep {
        (width, height)
    } else {
        (height, width)
    };
    // The top 6 bits of the sine, from 16 bits of each factor.
    let arc = ((small as u32 >> 14).wrapping_mul(inverse.sine) >> 24) as usize & 63;
    let (cos, turns) = ARCS[arc];
    // The cross product in 2^-24 of its unit. It is small: 32 bits hold the difference, though not the
    // parts. The sine of the arc has 24 zeros at its end.
    let part = (signed(opaque(small), cos) >> 24) as i32;
    let rest = part.wrapping_sub(large.wrapping_mul(2 * arc as i32 + 1));
    // In 2^-37 of a turn. The cube is 5000 of them at most: 15 bits of each factor serve.
    let rest = signed_high(rest, inverse.turns);
    let short = rest >> 13;
    let cube = (short.wrapping_mul(short) >> 15).wrapping_mul(short);
    let rest = rest + ((cube >> 10).wrapping_mul(CUBE) >> 16);
    // Not negative: the angle of such a vector is 0.
    let angle = (turns as i32 + ((rest + 16) >> 5)).max(0);
    let angle = if steep { (1 << 30) - angle } else { angle };
    let angle = angle as u32;
    // Half a turn needs all 32 bits, its sign the 33rd.
    let angle = if x < 0 { (1 << 31) - angle } else { angle };
    let sign = i64::from(y >> 31);
    (i64::from(angle) ^ sign).wrapping_sub(sign)
}
