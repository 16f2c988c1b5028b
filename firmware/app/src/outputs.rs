//! From the tick to the drives.

use crate::inputs::Angle;
use crate::scene::Scalar;
use crate::service::{Output, Readings};
#[cfg(brake)]
use embedded_hal::digital::OutputPin;
use trirrr_drives::Failure;
#[cfg(not(feedback))]
use trirrr_drives::stepper::Steppers;
#[cfg(not(tool = "none"))]
use trirrr_drives::tool::{ToolLine, ToolOutput};
use trirrr_protocol::message::State;
#[cfg(feedback)]
use {
    core::ops::Deref,
    trirrr_drives::ObeyingDrives,
    trirrr_drives::bldc::{Bldcs, LoopLine},
    trirrr_drives::can::{Bus, CanDrives, Protocol},
};

/// Sink of a tick's output: the drives of a board.
pub trait Outputs {
    /// Returns what the drives tell, before a tick. Without `[feedback]` in the scene they tell nothing.
    #[cfg(not(feedback))]
    #[inline(always)]
    fn measure(&mut self) -> Readings {}

    /// Returns what the drives tell, before a tick.
    #[cfg(feedback)]
    fn measure(&mut self) -> Readings;

    /// Carries out the output of a tick, once per tick. Drives are off unless [`is_on`](trirrr_service::Output::is_on).
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

    /// Hands the `power` of a tick on to the tool, 0 to 1. `runs` is true while a job runs. Once per tick; also where a fault
    /// comes behind the tick, so that the tool is off before the next one.
    #[inline(always)]
    fn work(&mut self, power: Scalar, runs: bool) {
        let _ = (power, runs);
    }

    /// Switches the spare outputs, a bit for each. As [`work`](Self::work), also behind a tick with a fault.
    #[cfg(digital)]
    #[inline(always)]
    fn switch(&mut self, outputs: u8) {
        let _ = outputs;
    }

    /// Shows the state of the machine on a lamp. Once per tick.
    #[inline(always)]
    fn show(&mut self, state: State) {
        let _ = state;
    }
}

/// Outputs of a scene without drives: nothing but telemetry leaves the board.
pub struct NoOutputs;

#[cfg(not(feedback))]
impl Outputs for NoOutputs {
    fn apply(&mut self, _: &Output) -> Result<(), Failure<Scalar>> {
        Ok(())
    }
}

/// Work between two ticks of a scene whose drives need none.
pub type NoDriveTimer = ();

// `inline`: compiled for speed in the board's crate.

#[cfg(not(feedback))]
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

#[cfg(feedback)]
impl<L: Deref<Target = LoopLine>> Outputs for Bldcs<L> {
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        Bldcs::measure(self)
    }

    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        Bldcs::apply(self, output);
        Ok(())
    }

    #[inline]
    fn shift(&mut self, by: [Angle; 3]) {
        Bldcs::shift::<Scalar>(self, by);
    }
}

#[cfg(feedback)]
impl<P: Protocol, B: Bus> Outputs for CanDrives<Scalar, P, B> {
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        CanDrives::measure(self)
    }

    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        CanDrives::apply(self, output)
    }

    #[inline]
    fn shift(&mut self, by: [Angle; 3]) {
        CanDrives::shift(self, by);
    }
}

/// Drives of a board, or of an emulated one, which has neither bus nor encoders.
#[cfg(feedback)]
pub enum OrEmulated<D> {
    /// Those of the board.
    Real(D),
    /// Those of an emulated board.
    Emulated(ObeyingDrives<Scalar>),
}

#[cfg(feedback)]
impl<D: Outputs> Outputs for OrEmulated<D> {
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        match self {
            Self::Real(drives) => drives.measure(),
            Self::Emulated(drives) => drives.measure(),
        }
    }

    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        match self {
            Self::Real(drives) => drives.apply(output),
            Self::Emulated(drives) => {
                drives.apply(output);
                Ok(())
            }
        }
    }

    fn shift(&mut self, by: [Angle; 3]) {
        match self {
            Self::Real(drives) => drives.shift(by),
            Self::Emulated(drives) => drives.shift(by),
        }
    }
}

/// Outputs beside the pin of a brake, which is high while the brake is released.
#[cfg(brake)]
pub struct Braked<O, P> {
    outputs: O,
    pin: P,
}

#[cfg(brake)]
impl<O: Outputs, P: OutputPin> Braked<O, P> {
    /// Puts the brake on.
    pub fn new(outputs: O, mut pin: P) -> Self {
        // A pin of the chip itself does not fail.
        let _ = pin.set_low();
        Self { outputs, pin }
    }
}

#[cfg(brake)]
impl<O: Outputs, P: OutputPin> Outputs for Braked<O, P> {
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        self.outputs.measure()
    }

    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        let _ = match output.brake_released {
            true => self.pin.set_high(),
            false => self.pin.set_low(),
        };
        self.outputs.apply(output)
    }

    #[inline(always)]
    fn angles(&self) -> Option<[Angle; 3]> {
        self.outputs.angles()
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.outputs.shift(by);
    }
}

/// Outputs beside that of the tool.
#[cfg(not(tool = "none"))]
pub struct Tooled<O, T> {
    outputs: O,
    tool: ToolLine<T, { crate::scene::tool::DELAY }>,
}

#[cfg(not(tool = "none"))]
impl<O: Outputs, T: ToolOutput> Tooled<O, T> {
    /// Joins the outputs with that of the tool, which is off.
    pub fn new(outputs: O, tool: T) -> Self {
        Self {
            outputs,
            tool: ToolLine::new(tool, crate::scene::tool::HOLDS),
        }
    }
}

#[cfg(not(tool = "none"))]
impl<O: Outputs, T: ToolOutput> Outputs for Tooled<O, T> {
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        self.outputs.measure()
    }

    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        self.outputs.apply(output)
    }

    #[inline(always)]
    fn angles(&self) -> Option<[Angle; 3]> {
        self.outputs.angles()
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.outputs.shift(by);
    }

    #[inline(always)]
    fn work(&mut self, power: Scalar, runs: bool) {
        self.tool.apply(power, runs);
    }
}
