//! Correctly rounded square roots: the machine's instruction where it has one, otherwise a digit
//! recurrence on integers. Both give the same bits.

mod hardware;
mod software;

pub(super) use hardware::{sqrt_f32, sqrt_f64};

#[cfg(test)]
mod tests {
    use super::{hardware, software};
    use crate::forward::random::share;

    // On a host with the instruction this compares the two; elsewhere it compares the software
    // with itself, and the platform's own root below is the reference.
    fn check_f32(x: f32) {
        let bits = software::sqrt_f32(x).to_bits();
        assert_eq!(bits, x.sqrt().to_bits(), "{x:e}");
        assert_eq!(bits, hardware::sqrt_f32(x).to_bits(), "{x:e}");
    }

    fn check_f64(x: f64) {
        let bits = software::sqrt_f64(x).to_bits();
        assert_eq!(bits, x.sqrt().to_bits(), "{x:e}");
        assert_eq!(bits, hardware::sqrt_f64(x).to_bits(), "{x:e}");
    }

    /// Without optimisation every eleventh.
    #[test]
    fn f32_every_significand() {
        // Two binades hold every significand with either parity of the exponent.
        let step = if cfg!(debug_assertions) { 11 } else { 1 };
        for bits in (1f32.to_bits()..4f32.to_bits()).step_by(step) {
            check_f32(f32::from_bits(bits));
        }
        for bits in (0..=f32::INFINITY.to_bits()).step_by(1009) {
            check_f32(f32::from_bits(bits));
        }
    }

    #[test]
    fn f64_random_and_hard() {
        let mut state = 1u64;
        for _ in 0..share(2_000_000) {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1_442_695_040_888_963_407);
            let bits = (state ^ state >> 29) & (u64::MAX >> 1);
            if f64::from_bits(bits).is_finite() {
                check_f64(f64::from_bits(bits));
                // Squares and their neighbours lie closest to where the rounding turns.
                let root = f64::from_bits(bits >> 12 | 0x3ff0_0000_0000_0000);
                let square = root * root;
                for x in [square.next_down(), square, square.next_up()] {
                    check_f64(x);
                }
            }
        }
    }

    #[test]
    fn special_values() {
        for x in [
            0.0,
            -0.0,
            f32::from_bits(1),
            f32::MIN_POSITIVE,
            f32::MAX,
            f32::INFINITY,
        ] {
            check_f32(x);
        }
        for x in [
            0.0,
            -0.0,
            5e-324,
            f64::MIN_POSITIVE.next_down(),
            f64::MAX,
            f64::INFINITY,
        ] {
            check_f64(x);
        }
        for x in [-1.0, -1e-45, f32::NEG_INFINITY, f32::NAN, -f32::NAN] {
            assert!(software::sqrt_f32(x).is_nan() && hardware::sqrt_f32(x).is_nan());
            assert!(software::sqrt_f64(x.into()).is_nan() && hardware::sqrt_f64(x.into()).is_nan());
        }
    }
}
