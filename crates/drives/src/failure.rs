//! Failure of a drive, as the service takes it.

use trirrr_core::number::Number;
use trirrr_protocol::message::{DriveFault, FaultCode};

/// Failure of a drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure<N> {
    /// Kind of the failure.
    pub what: DriveFault,
    /// Index of the drive, if a single one has failed.
    pub drive: Option<u8>,
    /// Value that belongs to [`DriveFault`]; 0 without one.
    pub value: N,
    /// Limit that the value broke; 0 without one.
    pub limit: N,
}

impl<N: Number> Failure<N> {
    pub(crate) fn of(what: DriveFault, drive: Option<u8>) -> Self {
        Self {
            what,
            drive,
            value: N::ZERO,
            limit: N::ZERO,
        }
    }

    /// Fault code to latch.
    pub fn code(&self) -> FaultCode {
        FaultCode::Drive(self.what)
    }
}
