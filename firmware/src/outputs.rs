//! From the tick to the drives.

use trirrr_core::number::Number;
use trirrr_drives::Failure;
use trirrr_station::Output;
use trirrr_station::scene::Scalar;

type Angle = <Scalar as Number>::Angle;

/// What a tick's output goes to.
pub(crate) trait Outputs {
    /// Carries out what the tick gave, once per tick. Where `output.enabled` is not set, the drives
    /// and the tool are off.
    ///
    /// # Errors
    /// What a drive does not do.
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>>;

    /// Where the motors are after a failure, for drives that know it: not where the tick wanted them.
    fn angles(&self) -> Option<[Angle; 3]> {
        None
    }

    /// The motors stand where they are, and their angles turn out to be by so much more than they were
    /// thought to be.
    fn shift(&mut self, _by: [Angle; 3]) {}
}

/// No drive: telemetry is all that leaves the board.
#[cfg(drive = "none")]
pub(crate) struct NoOutputs;

#[cfg(drive = "none")]
impl Outputs for NoOutputs {
    fn apply(&mut self, _: &Output) -> Result<(), Failure<Scalar>> {
        Ok(())
    }
}
