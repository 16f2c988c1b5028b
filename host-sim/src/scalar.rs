//! The number types on the command line.

use clap::ValueEnum;
use std::fmt;
use trirrr_scene::NumberType;

/// A number type by name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Scalar {
    /// IEEE binary64
    F64,
    /// IEEE binary32
    F32,
    /// 32-bit fixed point, in units chosen for the machine and its job
    Fixed,
    /// binary32 with micromath's coarse functions
    Micromath,
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
