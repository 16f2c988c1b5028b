//! A hash of the bits of every kernel over a lattice of arguments: equal on two machines that compute
//! alike.

use super::WideArithmetic;

/// FNV-1a over the bits, as f64, of what each function of a float returns: ordinary arguments,
/// angles of every size up to 2^100, vectors from 2^-100 to 2^100, subnormal roots. Results that are not
/// numbers are left out, because their bits depend on the machine.
#[doc(hidden)]
#[must_use]
pub fn fingerprint<N: WideArithmetic<Angle = N>>() -> u64 {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut note = |value: N| {
        for byte in value.to_f64().to_bits().to_le_bytes() {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x100_0000_01b3);
        }
    };
    // Significands that fill an f32 and, where there is room, more.
    let step = N::from_f64(0.618_033_988_749_894_9);
    let mut x = N::ONE;
    for index in 0..64u32 {
        x = if x > N::ONE {
            x - step
        } else {
            x + N::HALF + step * N::HALF
        };
        let size = power::<N>(index as i32 * 25 / 8 - 100);
        let large = x * size;
        note(x.sqrt());
        note(large.sqrt());
        note(N::ratio(index, 64 + index * 67_108_863));
        note(large.div(x + N::HALF));
        for angle in [x, large, -large, x * N::from_f64(f64::from(index))] {
            let (sin, cos) = N::sin_cos(angle);
            note(sin);
            note(cos);
            let small = sin * power(-(index as i32));
            for (y, x) in [(sin, cos), (cos, -small), (-large, sin), (large, -large)] {
                note(N::atan2(y, x));
            }
            note(N::direction(cos, sin, &N::length_from_f64(1.0)));
        }
    }
    // Into the subnormal numbers of f32.
    for exponent in 126..149 {
        note((x * power::<N>(-100) * power::<N>(100 - exponent)).sqrt());
    }
    hash
}

/// 2^exponent, by doubling or halving.
fn power<N: WideArithmetic>(exponent: i32) -> N {
    let factor = if exponent < 0 {
        N::HALF
    } else {
        N::ONE + N::ONE
    };
    let mut value = N::ONE;
    for _ in 0..exponent.unsigned_abs() {
        value *= factor;
    }
    value
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A change of these values means that results changed: of a kernel, or of a machine.
    #[test]
    fn has_not_changed() {
        let prints = [fingerprint::<f32>(), fingerprint::<f64>()];
        let known = [0x6605_164d_a9cb_cf42, 0x6050_7732_d1ba_2f8f];
        assert_eq!(prints, known, "{prints:#x?}");
    }
}
