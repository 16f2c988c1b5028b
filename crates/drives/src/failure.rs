//! What went wrong, as the service takes it.

use trirrr_core::number::Number;
use trirrr_protocol::message::{DriveFault, FaultCode};

/// What a drive did not do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Failure<N> {
    /// What.
    pub what: DriveFault,
    /// Which drive, where it is one.
    pub drive: Option<u8>,
    /// The value, as [`DriveFault`] says; 0 where there is none.
    pub value: N,
    /// The limit that it broke; 0 where there is none.
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

    /// The code to latch.
    pub fn code(&self) -> FaultCode {
        FaultCode::Drive(self.what)
    }
}
