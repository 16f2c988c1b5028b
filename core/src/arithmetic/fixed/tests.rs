//! The kernels against independent oracles: integers of 128 bits where the exact value is a root
//! or a quotient, the platform's f64 functions (within 2^-53, 2^-24 of a unit here) where it is
//! transcendental. Dense lattices, every significand that the tables meet included; not a sweep of
//! all 2^32 arguments.

use super::*;
use std::primitive::f64;

/// Largest errors, both sides.
#[derive(Debug, Default)]
struct Worst {
    low: f64,
    high: f64,
}

impl Worst {
    fn note(&mut self, error: f64) {
        assert!(!error.is_nan());
        self.low = self.low.min(error);
        self.high = self.high.max(error);
    }

    fn size(&self) -> f64 {
        self.high.max(-self.low)
    }
}

/// Every `step`th of all 2^32, from zero.
fn lattice(step: u32) -> impl Iterator<Item = u32> {
    (0..=u32::MAX).step_by(step as usize)
}

fn reciprocal_error(step: u32) -> Worst {
    let mut worst = Worst::default();
    for z in (1u32 << 31..=u32::MAX).step_by(step as usize) {
        // 2^62 / z, with 20 bits behind the point.
        let exact = (1u128 << 82) / u128::from(z);
        let found = i128::from(reciprocal::reciprocal(z)) << 20;
        worst.note((found - exact as i128) as f64 / f64::from(1 << 20));
    }
    std::println!("reciprocal: {worst:?} units of 2^-30");
    worst
}

fn inverse_root_error(step: u32) -> Worst {
    let mut worst = Worst::default();
    for z in (1u32 << 30..=u32::MAX).step_by(step as usize) {
        // 2^46 / sqrt(z): the correctly rounded root and quotient of f64 are within 2^-52.
        let exact = 70_368_744_177_664.0 / f64::sqrt(z.into());
        worst.note(f64::from(root::inverse_root(z)) - exact);
    }
    std::println!("inverse root: {worst:?} units of 2^-30");
    worst
}

fn sin_cos_error(step: u32) -> Worst {
    let mut worst = Worst::default();
    for turn in lattice(step) {
        let angle = f64::from(turn) * (core::f64::consts::TAU / 4_294_967_296.0);
        let (sin, cos) = f64::sin_cos(angle);
        let (s, c) = sin_cos::sin_cos(turn);
        worst.note(f64::from(s) - sin * 536_870_912.0);
        worst.note(f64::from(c) - cos * 536_870_912.0);
    }
    std::println!("sine and cosine: {worst:?} units of 2^-29");
    worst
}

/// Directions of vectors of length 2^30 2^-`short`, rounded, at every `step`th angle; in 2^-32 of
/// a turn.
fn direction_error(step: u32, part: f64) -> Worst {
    let mut worst = Worst::default();
    let length = 1_073_741_824.0 * part;
    let inverse = f64::round(1_152_921_504_606_846_976.0 / length) as i32;
    let inverse = direction::Inverse::new(inverse);
    for turn in lattice(step) {
        let angle = f64::from(turn) * (core::f64::consts::TAU / 4_294_967_296.0);
        let (sin, cos) = f64::sin_cos(angle);
        let (x, y) = (f64::round(length * cos), f64::round(length * sin));
        let exact = f64::atan2(y, x) / core::f64::consts::TAU * 4_294_967_296.0;
        let found = direction::direction(x as i32, y as i32, inverse) as f64;
        worst.note(found - exact);
    }
    std::println!("direction: {worst:?} units of 2^-32 of a turn");
    worst
}

#[test]
fn reciprocals_are_within_a_unit() {
    let worst = reciprocal_error(499).size();
    assert!((0.9..=1.0).contains(&worst), "{worst}");
}

#[test]
fn inverse_roots_are_within_a_unit() {
    let worst = inverse_root_error(499).size();
    assert!((0.9..=1.0).contains(&worst), "{worst}");
}

#[test]
fn sines_and_cosines_are_within_a_unit() {
    let worst = sin_cos_error(997).size();
    assert!((0.85..0.95).contains(&worst), "{worst}");
}

#[test]
fn directions_are_within_units() {
    for part in [0.5000001, 0.7, 1.0] {
        let worst = direction_error(4999, part).size();
        assert!((1.0..1.1).contains(&worst), "{worst}");
    }
}

#[test]
fn factors() {
    for x in [1.0, 0.3, 6.0, 1e-3, 1e4, 312.7, 1.0 / 3.0, 0.5, 2.0] {
        let f = Fixed::factor_from_f64(x);
        assert!((f.to_f64() / x - 1.0).abs() < 5e-10, "{x} {f:?}");
        assert!((f.inverse().to_f64() * x - 1.0).abs() < 1.5e-9, "{x} {f:?}");
        let g = f * Fixed::factor_from_f64(-7.3);
        assert!((g.to_f64() / (-7.3 * x) - 1.0).abs() < 1e-9);
        for y in [1e-6, 0.01, 0.3, -0.7, 1.9, -3.9] {
            let found = Fixed::from_f64(y).scaled(f);
            let exact = Fixed::from_f64(y).to_f64() * f.to_f64();
            if exact.abs() < 2.0 {
                assert!(
                    (found.to_f64() - exact).abs() <= 1.6 * Fixed::UNIT,
                    "{x} {y} {} {exact}",
                    found.to_f64()
                );
            } else {
                assert!(!Fixed::in_range([found]), "{x} {y} {}", found.to_f64());
            }
        }
    }
    for n in [1, 2, 3, 100, 1_000_000, u32::MAX] {
        assert!((Factor::of_count(n).to_f64() / f64::from(n) - 1.0).abs() < 1e-9);
    }
}

/// Zero is a factor like any other.
#[test]
fn nothing_times_anything_is_nothing() {
    let zero = Fixed::factor_from_f64(0.0);
    for value in [Fixed::ONE, -Fixed::ONE, Fixed::HALF, Fixed(1), Fixed(-1)] {
        assert_eq!(value.scaled(zero), Fixed::ZERO);
    }
    assert_eq!(Fixed::ratio(0, 2000), Fixed::ZERO);
}

/// Nothing but zero itself stays in range with the reciprocal of zero, as with that of the least number.
#[test]
fn the_reciprocal_of_zero_takes_everything_out_of_range() {
    for divisor in [Fixed::ZERO, Fixed(1)] {
        let inverse = divisor.reciprocal();
        assert_eq!(Fixed::ZERO.scaled(inverse), Fixed::ZERO);
        for value in [Fixed(4), Fixed(-4), Fixed::HALF, -Fixed::ONE] {
            assert!(!Fixed::in_range([value.scaled(inverse)]), "{value:?}");
        }
    }
}
