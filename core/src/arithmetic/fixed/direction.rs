//! The direction of a vector, in turns.

use super::product::{opaque, rounded, signed, signed_high};

/// For the sines (2 k + 1) / 128 up to that of an eighth of a turn: the cosine in 2^-31, and the
/// angle in 2^-32 of a turn. Offline by mpmath.
#[rustfmt::skip]
static ARCS: [(i32, u32); 46] = [
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
];

/// 2^32 / (4 pi): from 2^-33 rad to 2^-32 of a turn, times 2^32.
const TURNS: i32 = 341_782_638;

/// 2^32 / 24.
const TWENTY_FOURTH: i32 = 178_956_971;

/// Angle of (x, y) in 2^-32 of a turn, from -2^31 (exclusive) to 2^31.
///
/// The vector's length is `length` in (2^29, 2^30\], given as `inverse`, 2^60 / `length`. The smaller
/// of the components picks an arc of the table; what is left of the angle is the arcsine of the
/// cross product with it, below 0.012, of which two terms serve.
#[inline(always)]
pub(super) fn direction(x: i32, y: i32, inverse: i32) -> i64 {
    let (width, height) = (x.wrapping_abs(), y.wrapping_abs());
    let steep = height > width;
    let (small, large) = if steep {
        (width, height)
    } else {
        (height, width)
    };
    // The sine in 2^-28; its top 6 bits.
    let arc = (signed_high(opaque(small), inverse) >> 22) as usize;
    // The length may be longer than it was said to be by a rounding, but the table does not end
    // before 45 degrees do.
    let arc = if arc < ARCS.len() {
        arc
    } else {
        ARCS.len() - 1
    };
    let (cos, turns) = ARCS[arc];
    let sin = (2 * arc as i32 + 1) << 24;
    // The sine of the rest in 2^-33: 2^5 of it times length, divided by length.
    let cross = signed(opaque(small), cos) - signed(opaque(large), opaque(sin));
    let rest = signed_high(rounded::<26>(cross), inverse);
    let cubed = signed_high(signed_high(rest, rest), rest);
    let rest = rest + signed_high(cubed, TWENTY_FOURTH);
    let angle = turns as i32 + rounded32(signed(rest, TURNS));
    let angle = if steep { (1 << 30) - angle } else { angle };
    // Half a turn needs the 33rd bit.
    let angle = if x < 0 {
        (1 << 31) - i64::from(angle)
    } else {
        i64::from(angle)
    };
    if y < 0 { -angle } else { angle }
}

/// wide / 2^32, rounded to nearest.
#[inline(always)]
fn rounded32(wide: i64) -> i32 {
    ((wide >> 32) as i32).wrapping_add((wide as u32 >> 31) as i32)
}
