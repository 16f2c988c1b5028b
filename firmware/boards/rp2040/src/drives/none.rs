//! No drive: nothing but telemetry leaves the board.

use super::Parts;

pub(crate) use trirrr_app::outputs::NoOutputs as Drives;

/// No work between two ticks.
pub(crate) type Slot = ();

/// Takes no part.
pub(crate) fn build(_: Parts) -> (Drives, Slot) {
    (Drives, ())
}
