//! From the tick to the drives.

use crate::inputs::Angle;
use crate::scene::Scalar;
use core::ops::Deref;
use embedded_hal::digital::OutputPin;
use trirrr_core::number::Arithmetic;
use trirrr_drives::bldc::{Bldcs, LoopLine};
use trirrr_drives::can::{Bus, CanDrives, Protocol};
use trirrr_drives::stepper::{Steppers, StepsPerTurn};
use trirrr_drives::tool::{ToolLine, ToolOutput};
use trirrr_drives::{Failure, ObeyingDrives};
use trirrr_protocol::message::{DriveReading, State};

/// Content of what the drives tell in a tick.
pub type Readings = trirrr_service::board::Readings<Scalar>;

/// Output of a tick.
pub type Output = trirrr_service::Output<Scalar>;

/// Steps in a turn of each joint, and the motors that turn against theirs.
pub type Steps = ([StepsPerTurn; 3], [bool; 3]);

/// Sink of a tick's output: the drives of a board.
pub trait Outputs {
    /// Returns what the drives tell, before a tick. Drives that tell nothing are silent.
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        [DriveReading::unheard(Scalar::angle(Scalar::ZERO)); 3]
    }

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

impl Outputs for NoOutputs {
    fn apply(&mut self, _: &Output) -> Result<(), Failure<Scalar>> {
        Ok(())
    }
}

/// Work between two ticks of a scene whose drives need none.
pub type NoDriveTimer = ();

// `inline`: compiled for speed in the board's crate.

impl Outputs for Steppers<'_, Scalar> {
    // Without a host for size, as the tick.
    #[cfg_attr(autonomous, inline(never))]
    #[cfg_attr(not(autonomous), inline(always))]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        Steppers::apply(self, output)
    }

    #[cfg_attr(autonomous, inline(never))]
    #[cfg_attr(not(autonomous), inline)]
    fn angles(&self) -> Option<[Angle; 3]> {
        Some(Steppers::angles(self))
    }

    #[cfg_attr(autonomous, inline(never))]
    #[cfg_attr(not(autonomous), inline)]
    fn shift(&mut self, by: [Angle; 3]) {
        Steppers::shift(self, by);
    }
}

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
pub enum OrEmulated<D> {
    /// Those of the board.
    Real(D),
    /// Those of an emulated board.
    Emulated(ObeyingDrives<Scalar>),
}

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

/// Output beside the drives: a brake, a tool, a lamp, spare outputs. `()` is none.
pub trait OutputPart {
    /// Carries out the output of a tick, before the drives do.
    #[inline(always)]
    fn apply(&mut self, output: &Output) {
        let _ = output;
    }

    /// As [`Outputs::work`].
    #[inline(always)]
    fn work(&mut self, power: Scalar, runs: bool) {
        let _ = (power, runs);
    }

    /// As [`Outputs::switch`].
    #[inline(always)]
    fn switch(&mut self, outputs: u8) {
        let _ = outputs;
    }

    /// As [`Outputs::show`].
    #[inline(always)]
    fn show(&mut self, state: State) {
        let _ = state;
    }
}

impl OutputPart for () {}

impl<A: OutputPart, B: OutputPart, C: OutputPart, D: OutputPart> OutputPart for (A, B, C, D) {
    #[inline(always)]
    fn apply(&mut self, output: &Output) {
        self.0.apply(output);
        self.1.apply(output);
        self.2.apply(output);
        self.3.apply(output);
    }

    #[inline(always)]
    fn work(&mut self, power: Scalar, runs: bool) {
        self.0.work(power, runs);
        self.1.work(power, runs);
        self.2.work(power, runs);
        self.3.work(power, runs);
    }

    #[inline(always)]
    fn switch(&mut self, outputs: u8) {
        self.0.switch(outputs);
        self.1.switch(outputs);
        self.2.switch(outputs);
        self.3.switch(outputs);
    }

    #[inline(always)]
    fn show(&mut self, state: State) {
        self.0.show(state);
        self.1.show(state);
        self.2.show(state);
        self.3.show(state);
    }
}

/// Drives `D` and the parts `P` beside them.
pub struct WithParts<D, P> {
    /// Drives.
    pub drives: D,
    /// Everything beside them.
    pub parts: P,
}

impl<D: Outputs, P: OutputPart> Outputs for WithParts<D, P> {
    #[inline(always)]
    fn measure(&mut self) -> Readings {
        self.drives.measure()
    }

    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        self.parts.apply(output);
        self.drives.apply(output)
    }

    #[inline(always)]
    fn angles(&self) -> Option<[Angle; 3]> {
        self.drives.angles()
    }

    #[inline(always)]
    fn shift(&mut self, by: [Angle; 3]) {
        self.drives.shift(by);
    }

    #[inline(always)]
    fn work(&mut self, power: Scalar, runs: bool) {
        self.parts.work(power, runs);
    }

    #[inline(always)]
    fn switch(&mut self, outputs: u8) {
        self.parts.switch(outputs);
    }

    #[inline(always)]
    fn show(&mut self, state: State) {
        self.parts.show(state);
    }
}

/// Pin of a brake, which is high while the brake is released.
pub struct BrakePin<P>(P);

impl<P: OutputPin> BrakePin<P> {
    /// Puts the brake on.
    pub fn new(mut pin: P) -> Self {
        // A pin of the chip itself does not fail.
        let _ = pin.set_low();
        Self(pin)
    }
}

impl<P: OutputPin> OutputPart for BrakePin<P> {
    #[inline(always)]
    fn apply(&mut self, output: &Output) {
        let _ = self.0.set_state(output.brake_released.into());
    }
}

impl<T: ToolOutput, const DELAY: usize> OutputPart for ToolLine<T, DELAY> {
    #[inline(always)]
    fn work(&mut self, power: Scalar, runs: bool) {
        self.apply(power, runs);
    }
}
