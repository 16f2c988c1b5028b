//! Constants of an image as Rust source.
//!
//! A build script computes the coefficients of a scene on the host and writes them as an expression.
//! The image compiles that expression as a constant: it holds the same bits, and no code that builds
//! any. Every type stands with its full path. A float stands with the digits that tell it from all
//! other floats.

use core::fmt::{self, Write};
use core::marker::PhantomData;
use nalgebra::{Vector2, Vector3};

/// Values that a build script can write as Rust source. [`to_source!`](crate::to_source) implements
/// the trait for structs and enums.
pub trait ToSource {
    /// Writes the path of the type, with its parameters.
    ///
    /// # Errors
    /// Error of `out`.
    fn write_type(out: &mut dyn Write) -> fmt::Result;

    /// Writes a constant expression that gives the same bits.
    ///
    /// # Errors
    /// Error of `out`.
    fn write_value(&self, out: &mut dyn Write) -> fmt::Result;
}

macro_rules! primitives {
    ($($primitive:ident)+) => {$(
        impl ToSource for $primitive {
            fn write_type(out: &mut dyn Write) -> fmt::Result {
                out.write_str(stringify!($primitive))
            }

            fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
                // The shortest digits that are read back as the same bits.
                write!(out, "{self:?}")
            }
        }
    )+};
}

primitives!(bool u8 u16 u32 u64 i32 i64 f32 f64);

impl<T: ToSource, const COUNT: usize> ToSource for [T; COUNT] {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("[")?;
        T::write_type(out)?;
        write!(out, "; {COUNT}]")
    }

    fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
        out.write_str("[")?;
        for (index, item) in self.iter().enumerate() {
            out.write_str(if index == 0 { "" } else { ", " })?;
            item.write_value(out)?;
        }
        out.write_str("]")
    }
}

impl<T: ToSource> ToSource for Option<T> {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("Option<")?;
        T::write_type(out)?;
        out.write_str(">")
    }

    fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
        let Some(value) = self else {
            return out.write_str("None");
        };
        out.write_str("Some(")?;
        value.write_value(out)?;
        out.write_str(")")
    }
}

impl<T> ToSource for PhantomData<T> {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("core::marker::PhantomData<_>")
    }

    fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
        out.write_str("core::marker::PhantomData")
    }
}

impl<T: ToSource> ToSource for Vector2<T> {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("nalgebra::Vector2<")?;
        T::write_type(out)?;
        out.write_str(">")
    }

    fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
        out.write_str("nalgebra::Vector2::new(")?;
        self[0].write_value(out)?;
        out.write_str(", ")?;
        self[1].write_value(out)?;
        out.write_str(")")
    }
}

impl<T: ToSource> ToSource for Vector3<T> {
    fn write_type(out: &mut dyn Write) -> fmt::Result {
        out.write_str("nalgebra::Vector3<")?;
        T::write_type(out)?;
        out.write_str(">")
    }

    fn write_value(&self, out: &mut dyn Write) -> fmt::Result {
        out.write_str("nalgebra::Vector3::new(")?;
        for (index, item) in self.iter().enumerate() {
            out.write_str(if index == 0 { "" } else { ", " })?;
            item.write_value(out)?;
        }
        out.write_str(")")
    }
}

/// Implements [`ToSource`](crate::source::ToSource) for a type, whose public path follows `in`.
///
/// | form | for | the source is |
/// |---|---|---|
/// | `[N: Number] Name [N] in path { field: Type, .. }` | private fields | a call of `from_coefficients`, which the macro adds |
/// | `pub [N: Number] Name [N] in path { field, .. }` | public fields | a struct expression |
/// | `pub Name in path; 0` | a struct of one public, unnamed field | a call of its constructor |
/// | `pub Name in path: A, B` | an enum without fields | the variant |
#[macro_export]
macro_rules! to_source {
    ([$($bounds:tt)*] $name:ident [$($argument:ty),*] in $module:path {
        $($field:ident: $type:ty),* $(,)?
    }) => {
        impl<$($bounds)*> $name<$($argument),*> {
            /// Puts coefficients together that a build script has written.
            #[doc(hidden)]
            #[allow(clippy::too_many_arguments, unreachable_pub)]
            pub const fn from_coefficients($($field: $type),*) -> Self {
                Self { $($field),* }
            }
        }

        $crate::to_source!(@impl [$($bounds)*] $name [$($argument),*] in $module; self, out => {
            out.write_str("::from_coefficients(")?;
            $(
                self.$field.write_value(out)?;
                out.write_str(", ")?;
            )*
            out.write_str(")")
        });
    };
    (pub [$($bounds:tt)*] $name:ident [$($argument:ty),*] in $module:path {
        $($field:ident),* $(,)?
    }) => {
        $crate::to_source!(@impl [$($bounds)*] $name [$($argument),*] in $module; self, out => {
            out.write_str(" { ")?;
            $(
                out.write_str(concat!(stringify!($field), ": "))?;
                self.$field.write_value(out)?;
                out.write_str(", ")?;
            )*
            out.write_str("}")
        });
    };
    (pub $name:ident in $module:path; 0) => {
        $crate::to_source!(@impl [] $name [] in $module; self, out => {
            out.write_str("(")?;
            self.0.write_value(out)?;
            out.write_str(")")
        });
    };
    (pub $name:ident in $module:path: $($variant:ident),+) => {
        $crate::to_source!(@impl [] $name [] in $module; self, out => {
            out.write_str(match self {
                $(Self::$variant => concat!("::", stringify!($variant)),)+
            })
        });
    };
    (@impl [$($bounds:tt)*] $name:ident [$($argument:ty),*] in $module:path;
        $self:ident, $out:ident => $value:block
    ) => {
        impl<$($bounds)*> $crate::source::ToSource for $name<$($argument),*> {
            fn write_type(out: &mut dyn ::core::fmt::Write) -> ::core::fmt::Result {
                out.write_str(concat!(stringify!($module), "::", stringify!($name)))?;
                let arguments: &[fn(&mut dyn ::core::fmt::Write) -> ::core::fmt::Result] =
                    &[$(<$argument as $crate::source::ToSource>::write_type),*];
                for (index, argument) in arguments.iter().enumerate() {
                    out.write_str(if index == 0 { "<" } else { ", " })?;
                    argument(out)?;
                }
                out.write_str(if arguments.is_empty() { "" } else { ">" })
            }

            fn write_value(&$self, $out: &mut dyn ::core::fmt::Write) -> ::core::fmt::Result {
                #[allow(unused_imports)]
                use $crate::source::ToSource;
                $out.write_str(concat!(stringify!($module), "::", stringify!($name)))?;
                $value
            }
        }
    };
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::number::Fixed;
    use std::string::String;

    #[derive(Clone, Copy)]
    enum Side {
        Left,
        Right,
    }

    to_source!(pub Side in here: Left, Right);

    struct Hidden<N> {
        values: [N; 2],
        side: Option<Side>,
    }

    to_source!([N: ToSource] Hidden [N] in here::room { values: [N; 2], side: Option<Side> });

    struct Open {
        at: Vector2<Fixed>,
    }

    to_source!(pub [] Open [] in here { at });

    fn source<T: ToSource>(value: &T) -> [String; 2] {
        let mut both = [String::new(), String::new()];
        T::write_type(&mut both[0]).unwrap();
        value.write_value(&mut both[1]).unwrap();
        both
    }

    #[test]
    fn writes_paths_and_digits() {
        let hidden = Hidden::from_coefficients([0.1f32, -0.0], Some(Side::Right));
        let [of, value] = source(&hidden);
        assert_eq!(of, "here::room::Hidden<f32>");
        let expected =
            "here::room::Hidden::from_coefficients([0.1, -0.0], Some(here::Side::Right), )";
        assert_eq!(value, expected);
        let [of, value] = source(&Open {
            at: Vector2::new(Fixed(1), Fixed(-2)),
        });
        assert_eq!(of, "here::Open");
        let fixed = "trirrr_core::number::Fixed";
        let expected =
            std::format!("here::Open {{ at: nalgebra::Vector2::new({fixed}(1), {fixed}(-2)), }}");
        assert_eq!(value, expected);
        assert_eq!(
            source(&[Some(Side::Left), None])[0],
            "[Option<here::Side>; 2]"
        );
    }
}
