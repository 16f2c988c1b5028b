//! Against binary64, whose own rounding is an eighth of u^2 of the result, and against known digits.

use super::*;
use crate::tests::share;
use proptest::prelude::*;

/// u^2.
const UNIT: f64 = 1.0 / (1u64 << 48) as f64;

/// Numbers of two words, of sizes from 2^-20 to 2^20 and both signs.
fn number() -> impl Strategy<Value = f64> {
    (-20..20, 1.0..2.0, any::<bool>()).prop_map(|(exponent, part, negative): (i32, f64, _)| {
        let x = TwoWord::from_f64(part * f64::from(exponent).exp2()).to_f64();
        if negative { -x } else { x }
    })
}

/// `found` is within `most` u^2 of `truth`, and its words are as they should be.
fn near(what: &str, found: TwoWord, truth: f64, most: f64) {
    let error = (found.to_f64() - truth).abs() / (UNIT * truth.abs());
    let allowed = if truth == 0.0 {
        found.to_f64() == 0.0
    } else {
        error <= most + 0.13
    };
    assert!(allowed, "{what}: {found:?}, {truth:e}: {error}");
    assert_eq!(found.high + found.low, found.high, "{what}");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(share(20_000)))]

    #[test]
    fn operations_are_within_their_bounds(x in number(), y in number()) {
        let (a, b) = (TwoWord::from_f64(x), TwoWord::from_f64(y));
        near("x", a, x, 0.0);
        near("x + y", a + b, x + y, 3.0);
        // Nearly all of it cancels.
        let nearly = TwoWord::from_f64(x * (1.0 + 1e-9 * y));
        near("difference", nearly - a, nearly.to_f64() - x, 3.0);
        near("x y", a * b, x * y, 5.0);
        near("x / y", a.div(b), x / y, 16.0);
        near("root", a.abs().sqrt(), x.abs().sqrt(), 5.0);
    }

    #[test]
    fn one_words_multiply_exactly(x in any::<u32>(), y in any::<u32>()) {
        // Exponents away from those of the smallest and the largest numbers.
        let word = |bits: u32| f32::from_bits(bits & 0x83ff_ffff | 0x3c00_0000);
        let (x, y) = (word(x), word(y));
        let product = TwoWord::new(x) * TwoWord::new(y);
        assert_eq!(product.to_f64(), f64::from(x) * f64::from(y), "{x:e} {y:e}");
    }

    #[test]
    fn counts_divide_as_numbers(x in any::<u32>(), y in 1..u32::MAX) {
        near("ratio", TwoWord::ratio(x, y), f64::from(x) / f64::from(y), 17.0);
    }

    #[test]
    fn sines_are_within_their_bounds(angle in prop_oneof![-0.8..0.8, -8.0..8.0, -2e5..2e5]) {
        let angle = TwoWord::from_f64(angle);
        let (sin, cos) = TwoWord::sin_cos(angle);
        let (true_sin, true_cos) = angle.to_f64().sin_cos();
        for (found, truth, slope) in [(sin, true_sin, true_cos), (cos, true_cos, true_sin)] {
            let turned = if angle.high.abs() < 0.78 { 0.0 } else { 10.0 * angle.to_f64().abs() };
            let most = 40.0 * truth.abs() + turned * slope.abs();
            let error = (found.to_f64() - truth).abs() / UNIT;
            assert!(error <= most + 1.0, "{angle:?}: {error} of {most}");
        }
    }

    #[test]
    fn directions_are_those_of_binary64(x in number(), y in number()) {
        let found = TwoWord::atan2(TwoWord::from_f64(y), TwoWord::from_f64(x)).to_f64();
        // Across the negative x axis they differ by a turn.
        let apart = (found - y.atan2(x)).abs();
        let apart = apart.min((apart - core::f64::consts::TAU).abs());
        assert!(apart <= 100.0 * UNIT, "{x:e} {y:e}: {apart:e}");
    }
}

#[test]
fn what_is_no_number_is_not_finite() {
    let [one, zero] = [TwoWord::ONE, TwoWord::ZERO];
    assert!(!one.div(zero).is_finite() && !zero.div(zero).is_finite());
    assert!(!(-one).sqrt().is_finite());
    assert_eq!(zero.sqrt(), zero);
    let huge = TwoWord::new(f32::MAX);
    assert!(!(huge + huge).is_finite() && !(huge * huge).is_finite());
    let (sin, cos) = TwoWord::sin_cos(TwoWord::new(3e5));
    assert!(!sin.is_finite() && !cos.is_finite());
    assert!(!TwoWord::from_f64(1e300).is_finite());
}

#[test]
fn order_is_that_of_the_sums() {
    let above = TwoWord::from_f64(1.0 + 1e-12);
    assert!(above > TwoWord::ONE && -above < -TwoWord::ONE && above.abs() == (-above).abs());
    assert!(TwoWord::from_f64(1.0 - 1e-12) < TwoWord::ONE);
}
