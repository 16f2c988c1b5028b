//! Horner's scheme.

/// `c0 + x (c1 + x (c2 + ...))`, unrolled, one multiplication and one addition per coefficient.
macro_rules! horner {
    ($x:expr; $last:expr) => {
        $last
    };
    ($x:expr; $first:expr, $($rest:expr),+) => {
        $first + $x * $crate::arithmetic::polynomial::horner!($x; $($rest),+)
    };
}
pub(super) use horner;
