//! What a number type needs that rounds every step and whose quotients are divisions: it is its own
//! sum of products and its own factor.

/// Defines the items of [`Number`](super::Number) for such a type.
#[doc(hidden)]
#[macro_export]
macro_rules! rounds_every_step {
    () => {
        type Sum = Self;
        type Factor = Self;
        type Count = u32;
        type Length = Self;

        const SPREADS: bool = true;

        #[inline(always)]
        fn count(ticks: u32) -> u32 {
            ticks
        }
        #[inline(always)]
        fn fraction(numerator: u32, count: &u32) -> Self {
            Self::ratio(numerator, *count)
        }
        #[inline(always)]
        fn factor_from_f64(x: f64) -> Self {
            Self::from_f64(x)
        }
        #[inline(always)]
        fn factor_to_f64(factor: Self) -> f64 {
            factor.to_f64()
        }
        #[inline(always)]
        fn quotient(numerator: u32, denominator: u32) -> Self {
            Self::ratio(numerator, denominator)
        }
        #[inline(always)]
        fn factor_over(f: Self, g: Self) -> Self {
            f.div(g)
        }
        #[inline(always)]
        fn reciprocal(self) -> Self {
            Self::ONE.div(self)
        }
        #[inline(always)]
        fn scaled(self, f: Self) -> Self {
            self * f
        }
        #[inline(always)]
        fn scaled_twice(self, f: Self, g: Self) -> Self {
            self * f * g
        }
        #[inline(always)]
        fn length_from_f64(x: f64) -> Self {
            Self::from_f64(x)
        }
        #[inline(always)]
        fn length(length: &Self) -> Self {
            *length
        }
        #[inline(always)]
        fn sum_from_f64(x: f64) -> Self {
            Self::from_f64(x)
        }
        #[inline(always)]
        fn widen(self) -> Self {
            self
        }
        #[inline(always)]
        fn product(a: Self, b: Self) -> Self {
            a * b
        }
        #[inline(always)]
        fn sum_ab_plus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
            Self::ab_plus_cd(a, b, c, d)
        }
        #[inline(always)]
        fn sum_ab_minus_cd(a: Self, b: Self, c: Self, d: Self) -> Self {
            Self::ab_minus_cd(a, b, c, d)
        }
        #[inline(always)]
        fn round(sum: Self) -> Self {
            sum
        }
        #[inline(always)]
        fn round_scaled(sum: Self, f: Self) -> Self {
            sum * f
        }
        #[inline(always)]
        fn apex(
            triangle: &$crate::number::Triangle<Self>,
            base: nalgebra::Vector2<Self>,
        ) -> Result<$crate::number::Apex<Self>, $crate::number::OutOfReach> {
            $crate::number::triangle::apex_by_division(triangle, base)
        }
    };
}
pub use rounds_every_step;
