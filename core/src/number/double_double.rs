//! Sums of two f64, about 32 digits, as the reference that the f64 kernels are tested against:
//! Taylor series and the machine's own fused multiply-add, nothing in common with the kernels.

use std::primitive::f64;

/// A value as the unevaluated sum of two floats.
#[derive(Clone, Copy, Debug)]
pub(super) struct Double(pub(super) f64, pub(super) f64);

/// pi/2 in three floats.
const HALF_PI: [f64; 3] = [
    core::f64::consts::FRAC_PI_2,
    6.123_233_995_736_766e-17,
    -1.497_384_904_859_169_8e-33,
];

fn sum(a: f64, b: f64) -> Double {
    let s = a + b;
    let t = s - a;
    Double(s, (a - (s - t)) + (b - t))
}

fn product(a: f64, b: f64) -> Double {
    let p = a * b;
    Double(p, f64::mul_add(a, b, -p))
}

impl Double {
    pub(super) fn add(self, other: Double) -> Double {
        let high = sum(self.0, other.0);
        let low = sum(self.1, other.1);
        let s = sum(high.0, high.1 + low.0);
        sum(s.0, s.1 + low.1)
    }

    pub(super) fn mul(self, other: Double) -> Double {
        let p = product(self.0, other.0);
        sum(p.0, p.1 + (self.0 * other.1 + self.1 * other.0))
    }

    fn scaled(self, factor: f64) -> Double {
        self.mul(Double(factor, 0.0))
    }

    /// Divided by a small integer.
    fn over(self, divisor: f64) -> Double {
        let q = self.0 / divisor;
        let rest = product(q, divisor).scaled(-1.0).add(self);
        sum(q, rest.0 / divisor)
    }

    /// How far `value` is from this, in units in the last place of this.
    pub(super) fn ulps(self, value: f64) -> f64 {
        let ulp = self.0.abs().next_up() - self.0.abs();
        ((value - self.0) - self.1).abs() / ulp
    }
}

/// Sine and cosine of x, |x| <= 1000.
pub(super) fn sin_cos(x: f64) -> (Double, Double) {
    let k = f64::round(x / HALF_PI[0]);
    let mut r = Double(x, 0.0);
    for part in HALF_PI {
        r = r.add(product(-k, part));
    }
    let square = r.mul(r).scaled(-1.0);
    let series = |first: Double, step: f64| {
        let (mut term, mut total) = (first, first);
        for n in 0..14 {
            let n = 2.0 * f64::from(n) + step;
            term = term.mul(square).over(n * (n + 1.0));
            total = total.add(term);
        }
        total
    };
    let (sin, cos) = (series(r, 2.0), series(Double(1.0, 0.0), 1.0));
    match k.rem_euclid(4.0) as u32 {
        0 => (sin, cos),
        1 => (cos, sin.scaled(-1.0)),
        2 => (sin.scaled(-1.0), cos.scaled(-1.0)),
        _ => (cos.scaled(-1.0), sin),
    }
}

/// The angle of (x, y): the platform's own, with the correction that turning the vector back by
/// it leaves.
pub(super) fn atan2(y: f64, x: f64) -> Double {
    let guess = f64::atan2(y, x);
    let (sin, cos) = sin_cos(guess);
    let (y, x) = (Double(y, 0.0), Double(x, 0.0));
    let across = y.mul(cos).add(x.mul(sin).scaled(-1.0));
    let along = x.mul(cos).add(y.mul(sin));
    Double(guess, across.0 / along.0)
}

#[test]
fn agrees_with_the_table() {
    for (x, sin, cos) in super::reference::SIN_COS {
        if x.abs() > 1000.0 {
            continue;
        }
        let (s, c) = sin_cos(x);
        for (found, truth) in [(s, sin), (c, cos)] {
            let error = (found.0 - truth.0) + (found.1 - truth.1);
            assert!(
                error.abs() < 1e-29 * truth.0.abs(),
                "{x}: {found:?} {truth:?}"
            );
        }
    }
    for (y, x, truth) in super::reference::ATAN2 {
        if x.abs().max(y.abs()) < 1e100 && x.abs().min(y.abs()) > 1e-100 {
            let found = atan2(y, x);
            let error = (found.0 - truth.0) + (found.1 - truth.1);
            assert!(
                error.abs() < 1e-30 * truth.0.abs(),
                "{y} {x}: {found:?} {truth:?}"
            );
        }
    }
}
