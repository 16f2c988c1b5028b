//! Number types that a scene may name.

use std::fmt;
use std::str::FromStr;

/// The number types of the pipeline. A scene may name any; whoever runs it says if it cannot.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NumberType {
    /// binary64.
    F64,
    /// binary32.
    F32,
    /// 32-bit fixed point.
    Fixed,
    /// binary32 with the coarse functions of the micromath crate.
    Micromath,
}

/// Runs an expression with the Rust type that a [`NumberType`] names.
///
/// ```
/// use trirrr_core::number::Arithmetic;
/// use trirrr_scene::{NumberType, in_number_type};
///
/// let third = in_number_type!(NumberType::F32, N => N::from_f64(1.0 / 3.0).to_f64());
/// assert_eq!(third, f64::from(1.0f32 / 3.0));
/// ```
#[macro_export]
macro_rules! in_number_type {
    ($number:expr, $type:ident => $expression:expr) => {{
        macro_rules! of {
            ($rust:ty) => {{
                type $type = $rust;
                $expression
            }};
        }
        match $number {
            $crate::NumberType::F64 => of!(f64),
            $crate::NumberType::F32 => of!(f32),
            $crate::NumberType::Fixed => of!($crate::trirrr_core::number::Fixed),
            $crate::NumberType::Micromath => of!($crate::trirrr_core::number::Coarse),
        }
    }};
}

impl NumberType {
    /// All number types.
    pub const ALL: [Self; 4] = [Self::F64, Self::F32, Self::Fixed, Self::Micromath];

    /// All of them, by the names that scenes use.
    pub(crate) const NAMES: [(&'static str, Self); 4] = [
        ("f64", Self::F64),
        ("f32", Self::F32),
        ("fixed", Self::Fixed),
        ("micromath", Self::Micromath),
    ];

    /// Returns true if every result is a binary32 number, false if binary64 is needed.
    pub fn is_binary32(self) -> bool {
        matches!(self, Self::F32 | Self::Micromath)
    }

    /// Name in scenes and on the command line.
    pub fn name(self) -> &'static str {
        let named = Self::NAMES.iter().find(|(_, number)| *number == self);
        named.map_or("", |(name, _)| name)
    }
}

impl fmt::Display for NumberType {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

impl FromStr for NumberType {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let found = Self::NAMES.iter().find(|(name, _)| *name == text);
        let (_, number) = found.ok_or("expected f64, f32, fixed or micromath")?;
        Ok(*number)
    }
}
