//! From the machine to the tick: what its switches, or drives that stall, say.

/// For each motor, whether its switch is closed or its drive stalls.
#[cfg(homing)]
pub(crate) type Closed = [bool; 3];

/// Nobody asks.
#[cfg(not(homing))]
pub(crate) type Closed = ();

/// Where a tick's inputs come from.
pub(crate) trait Inputs {
    /// As they are now.
    fn read(&mut self) -> Closed;
}

/// No input.
#[cfg(not(homing))]
pub(crate) struct NoInputs;

#[cfg(not(homing))]
impl Inputs for NoInputs {
    fn read(&mut self) -> Closed {}
}
