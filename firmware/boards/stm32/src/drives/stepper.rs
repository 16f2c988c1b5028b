//! Steppers: TIM7 calls the slots.

pub(crate) use self::{CheckedSteppers as Drives, SlotTimer as DriveTimer};
use super::DriveParts;
pub(crate) use super::no_bus::{Inbox, no_frames, report};
use crate::board::{self, DirectionOutput, StepOutput};
use crate::clock::FAST;
use crate::timers::SlotCounter;
use trirrr_app::Output;
use trirrr_app::inputs::Angle;
use trirrr_app::outputs::Outputs;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{ENABLE_HIGH, MOST_PER_TICK};
use trirrr_app::slots::{LINE, PER_TICK, SLOT_HZ, steps};
use trirrr_boards::BoardPin;
use trirrr_core::number::Arithmetic;
use trirrr_drives::stepper::{Axis, Slots, Steppers};
use trirrr_drives::{Active, Enable, Failure};
use trirrr_protocol::message::DriveFault;

/// Least cycles of the core between two slots: fewer would starve the tick, and cut pulses short. The slot that takes new positions runs
/// for up to 555 (`cargo xtask bench --g474 inputs/guarded`).
const LEAST_CYCLES: u32 = 800;

const _: () = assert!(
    FAST.core / SLOT_HZ >= LEAST_CYCLES,
    "step_rate_limit_hz of the scene: the core is too slow for two slots for each step and two more in each tick"
);

/// Drives, as the tick sees them.
pub(crate) struct CheckedSteppers {
    steppers: Steppers<'static, Scalar>,
    /// The core is fast enough for the slots.
    runs: bool,
}

impl Outputs for CheckedSteppers {
    #[inline(always)]
    fn apply(&mut self, output: &Output) -> Result<(), Failure<Scalar>> {
        if output.is_on() && !self.runs {
            return Err(too_slow());
        }
        Outputs::apply(&mut self.steppers, output)
    }

    fn angles(&self) -> Option<[Angle; 3]> {
        Outputs::angles(&self.steppers)
    }

    fn shift(&mut self, by: [Angle; 3]) {
        Outputs::shift(&mut self.steppers, by);
    }
}

/// Failure of a board on which neither crystal nor PLL starts: the slots of a fast stepper are too many.
#[cold]
fn too_slow() -> Failure<Scalar> {
    Failure {
        what: DriveFault::StepRate,
        drive: None,
        value: Scalar::ZERO,
        limit: Scalar::ONE,
    }
}

/// Timer that calls the slots.
pub(crate) struct SlotTimer {
    slots: Slots<'static, StepOutput, DirectionOutput, <board::Enable as BoardPin>::Output>,
    timer: SlotCounter,
}

impl SlotTimer {
    /// Runs one slot.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        // First: the write has to reach the timer before the interrupt returns.
        self.timer.clear();
        let Ok(()) = self.slots.slot();
    }
}

/// Builds the drives, off, and starts the slots if the core is fast enough.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
// An inverted pin has the type of the array already.
#[allow(clippy::useless_conversion)]
pub(crate) fn build(parts: DriveParts) -> (CheckedSteppers, SlotTimer) {
    let pins = parts.pins;
    let active = Active::at(ENABLE_HIGH);
    let Ok(enable) = Enable::new(pins.enable.output(active.off()), active);
    let (per_turn, [r1, r2, r3]) = steps();
    let Ok(axis_1) = Axis::new(
        pins.step_1.output(false).into(),
        pins.direction_1.output(false).into(),
        r1,
    );
    let Ok(axis_2) = Axis::new(
        pins.step_2.output(false).into(),
        pins.direction_2.output(false).into(),
        r2,
    );
    let Ok(axis_3) = Axis::new(
        pins.step_3.output(false).into(),
        pins.direction_3.output(false).into(),
        r3,
    );
    let axes = [axis_1, axis_2, axis_3];
    let slots = Slots::new(&LINE, axes, enable, PER_TICK);

    let (timer, clocks) = (SlotCounter, parts.clocks);
    let runs = clocks.core / SLOT_HZ >= LEAST_CYCLES;
    if runs {
        timer.start(clocks.timers, SLOT_HZ);
    } else {
        // Without a host there is no log.
        #[cfg(not(autonomous))]
        defmt::error!(
            "{=u32} slots per second are too many for {=u32} Hz",
            SLOT_HZ,
            clocks.core
        );
    }
    let steppers = Steppers::new(per_turn, MOST_PER_TICK, parts.angles, &LINE);
    (
        CheckedSteppers { steppers, runs },
        SlotTimer { slots, timer },
    )
}
