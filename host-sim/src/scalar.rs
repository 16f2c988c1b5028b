//! The number types on the command line.

use crate::failure::Failure;
use clap::ValueEnum;
use std::fmt;
use trirrr_scene::NumberType;

/// A number type by name, whether this build has it or not.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Scalar {
    /// IEEE binary64
    F64,
    /// IEEE binary32
    F32,
    /// 32-bit fixed point (not in this build)
    Fixed,
    /// binary32 with micromath's coarse functions
    Micromath,
}

/// A number type that this build computes in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Available {
    /// IEEE binary64.
    F64,
    /// IEEE binary32.
    F32,
    /// binary32 with micromath's coarse functions.
    Micromath,
}

impl Scalar {
    /// The number type itself.
    ///
    /// # Errors
    /// Refused, naming the types there are, if this build has no such type.
    pub fn available(self) -> Result<Available, Failure> {
        match self {
            Scalar::F64 => Ok(Available::F64),
            Scalar::F32 => Ok(Available::F32),
            Scalar::Micromath => Ok(Available::Micromath),
            Scalar::Fixed => Err(Failure::Refused(format!(
                "number type {self} is not in this build; --scalar can be f64, f32 or micromath"
            ))),
        }
    }
}

impl From<NumberType> for Scalar {
    fn from(number: NumberType) -> Self {
        match number {
            NumberType::F64 => Scalar::F64,
            NumberType::F32 => Scalar::F32,
            NumberType::Fixed => Scalar::Fixed,
            NumberType::Micromath => Scalar::Micromath,
        }
    }
}

impl fmt::Display for Scalar {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Scalar::F64 => "f64",
            Scalar::F32 => "f32",
            Scalar::Fixed => "fixed",
            Scalar::Micromath => "micromath",
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_not_there_is_refused_with_what_is() {
        assert_eq!(Scalar::F32.available().unwrap(), Available::F32);
        let failure = Scalar::Fixed.available().unwrap_err();
        assert_eq!(failure.exit_code(), 2);
        let text = failure.to_string();
        assert!(
            text.contains("fixed") && text.contains("f64, f32 or micromath"),
            "{text}"
        );
    }
}
