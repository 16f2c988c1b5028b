//! From numbers to counts of the hardware.

use trirrr_core::number::fixed::Turns;
use trirrr_core::number::{Coarse, Fixed, Number};

/// Number type whose angles and fractions become counts.
pub trait Countable: Number {
    /// Angle within its turn, in 2^-32 of a turn. A difference read as `i32` is the short way round. `angle`
    /// has to be within three half turns of 0. Precise to the number type, at best 2^-30 of a turn for 32 bits.
    /// Not a number gives 0.
    fn turn(angle: Self::Angle) -> u32;

    /// abs(self) times `full`, to the nearest, at most `full`. Not a number gives 0.
    fn parts(self, full: u16) -> u16;

    /// Nearest binary32 number.
    fn to_f32(self) -> f32;

    /// Number nearest to `value`, or the largest of its sign. Not a number gives 0 in fixed point.
    fn from_f32(value: f32) -> Self;

    /// Angle of `turn`, in 2^-32 of a turn: from half a turn back to half a turn ahead.
    fn angle_of(turn: u32) -> Self::Angle;
}

/// A turn in the units of [`Countable::turn`].
const TURN: f64 = 4_294_967_296.0;

impl Countable for f64 {
    #[inline(always)]
    fn turn(angle: f64) -> u32 {
        (angle * (TURN / core::f64::consts::TAU)) as i64 as u32
    }

    #[inline(always)]
    fn parts(self, full: u16) -> u16 {
        // The cast cuts, and saturates at 0 and 2^32 - 1.
        ((self.abs() * f64::from(full) + 0.5) as u32).min(full.into()) as u16
    }

    #[inline(always)]
    fn to_f32(self) -> f32 {
        self as f32
    }

    #[inline(always)]
    fn from_f32(value: f32) -> f64 {
        value.into()
    }

    #[inline(always)]
    fn angle_of(turn: u32) -> f64 {
        f64::from(turn as i32) * (core::f64::consts::TAU / TURN)
    }
}

impl Countable for f32 {
    #[inline(always)]
    fn turn(angle: f32) -> u32 {
        const PARTS: f32 = (1_073_741_824.0 / core::f64::consts::TAU) as f32;
        // Two turns of either sign fit 32 bits.
        ((angle * PARTS) as i32 as u32) << 2
    }

    #[inline(always)]
    fn parts(self, full: u16) -> u16 {
        ((self.abs() * f32::from(full) + 0.5) as u32).min(full.into()) as u16
    }

    #[inline(always)]
    fn to_f32(self) -> f32 {
        self
    }

    #[inline(always)]
    fn from_f32(value: f32) -> f32 {
        value
    }

    #[inline(always)]
    fn angle_of(turn: u32) -> f32 {
        turn as i32 as f32 * ((core::f64::consts::TAU / TURN) as f32)
    }
}

impl Countable for Coarse {
    #[inline(always)]
    fn turn(angle: Self) -> u32 {
        f32::turn(angle.0)
    }

    #[inline(always)]
    fn parts(self, full: u16) -> u16 {
        self.0.parts(full)
    }

    #[inline(always)]
    fn to_f32(self) -> f32 {
        self.0
    }

    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        Self(value)
    }

    #[inline(always)]
    fn angle_of(turn: u32) -> Self {
        Self(f32::angle_of(turn))
    }
}

impl Countable for Fixed {
    #[inline(always)]
    fn turn(angle: Self::Angle) -> u32 {
        angle.0 as u32
    }

    #[inline(always)]
    fn parts(self, full: u16) -> u16 {
        let parts = (u64::from(self.0.unsigned_abs()) * u64::from(full) + (1 << 28)) >> 29;
        // A `Fixed` is less than 4.
        (parts as u32).min(full.into()) as u16
    }

    #[inline(always)]
    fn to_f32(self) -> f32 {
        self.0 as f32 * Self::UNIT as f32
    }

    #[inline(always)]
    fn from_f32(value: f32) -> Self {
        const PER_ONE: f32 = (1.0 / Fixed::UNIT) as f32;
        let half = if value < 0.0 { -0.5 } else { 0.5 };
        // The cast cuts, and saturates.
        Self((value * PER_ONE + half) as i32)
    }

    #[inline(always)]
    fn angle_of(turn: u32) -> Self::Angle {
        Turns((turn as i32).into())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f64::consts::{PI, TAU};
    use trirrr_core::number::Arithmetic;

    /// Difference between `turn` and `angle`, in turns.
    fn off<N: Countable>(angle: f64) -> f64 {
        let turn = f64::from(N::turn(N::angle_from_f64(angle))) / 4_294_967_296.0;
        let off = turn - angle / TAU;
        off - off.round()
    }

    #[test]
    fn a_turn_is_the_angle_whichever_way_it_is_wound() {
        for part in -1000..=1000 {
            let angle = f64::from(part) * 3e-3 * PI;
            // One unit cut off, and the rounding of angle, factor and product.
            assert!(off::<f64>(angle).abs() <= 2.0 / 4_294_967_296.0, "{angle}");
            assert!(off::<Fixed>(angle).abs() <= 1.0 / 4_294_967_296.0);
            let rounding = 3.0 * angle.abs() / TAU / 16_777_216.0;
            let cut = 1.0 / 1_073_741_824.0;
            assert!(off::<f32>(angle).abs() <= rounding + cut, "{angle}");
            assert_eq!(
                Coarse::turn(Coarse::angle_from_f64(angle)),
                f32::turn(angle as f32)
            );
        }
        assert_eq!((f32::turn(f32::NAN), f64::turn(f64::NAN)), (0, 0));
    }

    #[test]
    fn an_angle_is_its_turn_again() {
        fn check<N: Countable>(unit: f64) {
            for step in -500..=499 {
                let part = f64::from(step) / 1000.0;
                let turn = (part * TURN) as i64 as u32;
                let angle = N::angle_to_f64(N::angle_of(turn));
                assert!((angle - part * TAU).abs() <= unit, "{step}: {angle}");
            }
            for value in [0.0, 0.3, -1.7, 1e-5] {
                let kept = N::from_f32(value).to_f64();
                assert!((kept - f64::from(value)).abs() <= unit, "{value}: {kept}");
            }
        }
        // A unit of the turn, and half a unit of the type at half a turn.
        check::<f64>(2e-9);
        check::<f32>(4e-7);
        check::<Coarse>(4e-7);
        check::<Fixed>(4e-9);
        assert!(Fixed::from_f32(1e9).to_f64() > 3.9 && Fixed::from_f32(-1e9).to_f64() < -3.9);
    }

    #[test]
    fn parts_are_the_nearest_and_no_more_than_all() {
        fn check<N: Countable>() {
            for (x, full, expected) in [
                (0.0, 8400, 0),
                (0.5, 8400, 4200),
                (-0.5, 8400, 4200),
                (1.0, 8400, 8400),
                (-1.0, 65_535, 65_535),
                (1.5, 65_535, 65_535),
                (0.25, 3, 1), // 0.75
                (0.125, 3, 0),
            ] {
                assert_eq!(N::from_f64(x).parts(full), expected, "{x} of {full}");
            }
        }
        check::<f64>();
        check::<f32>();
        check::<Coarse>();
        check::<Fixed>();
        assert_eq!(f32::NAN.parts(100), 0);
    }

    #[test]
    fn binary32_is_exact_where_the_type_is_no_wider() {
        for x in [0.0, -1.5, 0.123] {
            assert_eq!((x as f32).to_f32(), x as f32);
            assert!((Fixed::from_f64(x).to_f32() - x as f32).abs() <= 1e-7);
        }
    }
}
