//! From the tick to the drives.

use crate::inputs::Angle;
use crate::scene::Scalar;
use crate::service::Output;
use trirrr_drives::Failure;

/// Sink of a tick's output: the drives of a board.
pub trait Outputs {
    /// Carries out the output of a tick, once per tick. Drives and tool are off unless `output.enabled`.
    ///
    /// # Errors
    /// A failure of one drive, to be latched as a fault.
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>>;

    /// Joint angles after a failure, for drives that count: a stepper stands short of the angles that the
    /// tick commanded.
    fn angles(&self) -> Option<[Angle; 3]> {
        None
    }

    /// Follows a new zero of the joint angles: all are greater `by` so much from now on, without a motion.
    fn shift(&mut self, by: [Angle; 3]) {
        let _ = by;
    }
}

/// Outputs of a scene without drives: nothing but telemetry leaves the board.
pub struct NoOutputs;

impl Outputs for NoOutputs {
    fn apply(&mut self, _: &Output) -> Result<(), Failure<Scalar>> {
        Ok(())
    }
}
