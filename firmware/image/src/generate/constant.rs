//! Values as Rust source.

use trirrr_core::source::ToSource;

/// Returns `value` as a constant expression that gives the same bits.
pub(super) fn constant(value: &impl ToSource) -> String {
    let mut text = String::new();
    value.write_value(&mut text).expect(INFALLIBLE);
    text
}

/// Returns the path of the type `T`.
pub(super) fn path<T: ToSource>() -> String {
    let mut text = String::new();
    T::write_type(&mut text).expect(INFALLIBLE);
    text
}

const INFALLIBLE: &str = "a String takes all text";
