//! No drive: telemetry is all that leaves the board.

use super::Parts;

pub(crate) use crate::outputs::NoOutputs as Drives;

/// Nothing to do between two ticks.
pub(crate) type Slot = ();

/// Nothing to build.
pub(crate) fn build(_: Parts) -> (Drives, Slot) {
    (Drives, ())
}
