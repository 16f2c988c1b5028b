//! The lesser and the greater of two bounds, and a bound that nothing reaches.

use trirrr_core::number::Arithmetic;

pub(crate) fn lesser<B: PartialOrd>(a: B, b: B) -> B {
    if b < a { b } else { a }
}

pub(crate) fn greater<B: PartialOrd>(a: B, b: B) -> B {
    if b > a { b } else { a }
}

/// A bound of x that no limit of a machine reaches.
pub(crate) fn unbounded<B: Arithmetic>() -> B {
    B::ONE.div(B::UNIT_ROUNDOFF * B::UNIT_ROUNDOFF)
}
