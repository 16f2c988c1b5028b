//! The dyad's kernel in fixed point against integers of 128 bits.

use super::*;
use crate::arithmetic::{Arithmetic, WideArithmetic};

/// Every 32 bits, from a generator of congruences.
fn random() -> impl FnMut() -> i32 {
    let mut state = 1u64;
    move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 32) as i32
    }
}

/// Asserts that `found` is `exact`, in 2^-58, rounded once.
fn assert_rounded(found: Fixed, exact: i128) {
    let off = (i128::from(found.0) << FRACTION) - exact;
    assert!(off.abs() <= 1 << (FRACTION - 1), "{found:?} {exact} {off}");
}

#[test]
fn motions_of_an_arm_are_rounded_once() {
    let mut next = random();
    let one = i128::from(Fixed::ONE.0);
    for _ in 0..100_000 {
        // Arms to 1/2; the others are below 2, as a sine and a square of a rate are besides.
        let arm = Vector2::new(Fixed(next() >> 3), Fixed(next() >> 3));
        let start = Vector2::new(Fixed(next() >> 1), Fixed(next() >> 1));
        let (p, q) = (Fixed(next() >> 2), Fixed(next() >> 2));
        let [x, y] = [arm.x.0, arm.y.0].map(i128::from);
        let [vx, vy] = [start.x.0, start.y.0].map(|raw| i128::from(raw) * one);
        let (pp, qq) = (i128::from(p.0), i128::from(q.0));

        let turned = Fixed::turn_arm(arm, p, q);
        assert_rounded(turned.x, x * qq - y * pp);
        assert_rounded(turned.y, y * qq + x * pp);
        let velocity = Fixed::arm_velocity(start, p, arm);
        assert_rounded(velocity.x, vx - y * pp);
        assert_rounded(velocity.y, vy + x * pp);
        let acceleration = Fixed::arm_acceleration(start, p, q, arm);
        assert_rounded(acceleration.x, vx - y * pp - x * qq);
        assert_rounded(acceleration.y, vy + x * pp - y * qq);
    }
}

/// Sums of all sizes over all that r1 x r2 can be: rounded once where it fits, and out of range
/// otherwise.
#[test]
fn quotients_are_right_or_out_of_range() {
    let mut next = random();
    let (mut right, mut beyond) = (0, 0);
    for _ in 0..100_000 {
        let size = 1 << 30 | (next() & 0x3fff_ffff);
        let inverse = Factor {
            significand: if next() < 0 { -size } else { size },
            shift: 1 + (next() & 31) % 29,
        };
        let sum = |high: i32, low: i32, size: i32| {
            Sum(((i64::from(high) << 32) | i64::from(low as u32)) >> (size & 63))
        };
        let sums = [sum(next(), next(), next()), sum(next(), next(), next())];
        let inverse_f64 = Fixed::factor_to_f64(inverse);
        let exact = sums.map(|sum| sum.0 as f64 * inverse_f64 * Fixed::UNIT);
        let found = Fixed::over_cross(sums, inverse);
        if exact.iter().all(|exact| exact.abs() < 2.0 / Fixed::UNIT) {
            right += 1;
            for (found, exact) in found.iter().zip(exact) {
                let off = (f64::from(found.0) - exact).abs();
                assert!(off <= 1.6, "{found:?} {exact}");
            }
        } else if exact.iter().any(|exact| exact.abs() > 2.1 / Fixed::UNIT) {
            beyond += 1;
            assert!(!Fixed::in_range(found), "{found:?} {exact:?}");
        }
    }
    assert!(right > 10_000 && beyond > 10_000, "{right} {beyond}");
}
