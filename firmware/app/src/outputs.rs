//! From the tick to the drives.

use crate::inputs::Angle;
use crate::scene::Scalar;
use crate::service::Output;
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use trirrr_drives::Failure;
use trirrr_drives::bldc::{BldcMotor, Bldcs};
use trirrr_drives::can::{Bus, CanDrives, Protocol};
use trirrr_drives::stepper::Steppers;

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

/// Work between two ticks of a scene without steppers: none.
pub type NoStepTimer = ();

// `inline`: compiled for speed in the board's crate.

impl Outputs for Steppers<'_, Scalar> {
    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        Steppers::apply(self, output)
    }

    #[inline]
    fn angles(&self) -> Option<[Angle; 3]> {
        Some(Steppers::angles(self))
    }

    #[inline]
    fn shift(&mut self, by: [Angle; 3]) {
        Steppers::shift(self, by);
    }
}

impl<W: SetDutyCycle, D: OutputPin, E: OutputPin> Outputs for Bldcs<BldcMotor<Scalar, W, D>, E> {
    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        Bldcs::apply(self, output)
    }
}

impl<P: Protocol, B: Bus> Outputs for CanDrives<Scalar, P, B> {
    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        CanDrives::apply(self, output)
    }
}
