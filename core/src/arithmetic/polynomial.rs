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

/// Two polynomials of one variable and one degree, step by step beside each other, so that neither waits for its own
/// result.
macro_rules! horner_pair {
    ($x:expr; ($last_a:expr, $last_b:expr)) => {
        ($last_a, $last_b)
    };
    ($x:expr; ($a:expr, $b:expr), $($rest:tt),+) => {{
        let (a, b) = $crate::arithmetic::polynomial::horner_pair!($x; $($rest),+);
        let (a, b) = ($x * a, $x * b);
        ($a + a, $b + b)
    }};
}
pub(super) use horner_pair;
