//! From the tick to the drives.

use crate::station::Output;

/// What a tick's output goes to.
pub(crate) trait Outputs {
    /// Carries out what the tick gave, once per tick. Where `output.enabled` is not set, the drives
    /// and the tool are off.
    fn apply(&mut self, output: &Output);
}

/// No drive: telemetry is all that leaves the board.
pub(crate) struct NoOutputs;

impl Outputs for NoOutputs {
    fn apply(&mut self, _: &Output) {}
}
