//! Steppers: PWM slice 7, without an output, calls the slots.

pub(crate) use self::{SlotTimer as DriveTimer, StepperDrives as Drives};
use super::DriveParts;
use crate::clock::CORE_HZ;
use crate::pins::AnyOutput;
use rp2040_hal::pwm::{FreeRunning, Pwm7, Slice};
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{ENABLE_HIGH, MOST_PER_TICK, PER_TURN, REVERSED};
use trirrr_app::slots::{LINE, PER_TICK, SLOT_HZ};
use trirrr_boards::BoardPin;
use trirrr_drives::stepper::{Axis, Slots, Steppers};
use trirrr_drives::{Active, Enable};

/// Cycles of the core from one slot to the next.
const CYCLES: u32 = CORE_HZ / SLOT_HZ;

/// Least cycles between two slots, twice the instructions of one: fewer would starve the tick.
const LEAST_CYCLES: u32 = 1200;

const _: () = assert!(
    CYCLES >= LEAST_CYCLES,
    "step_rate_limit_hz of the scene: the RP2040 has at most 104,000 slots per second, two for each \
     step and two more in each tick"
);

/// Divider in front of the timer, whose counts have 16 bits.
const DIVIDER: u8 = {
    let divider = CYCLES.div_ceil(1 << 16);
    // Slots of the slowest ticks take fewer.
    assert!(divider <= 255);
    divider as u8
};

/// Last count of a slot; cut, so that there are enough slots.
const TOP: u16 = (CYCLES / DIVIDER as u32 - 1) as u16;

/// Drives, as the tick sees them.
pub(crate) type StepperDrives = Steppers<'static, Scalar>;

/// Timer that calls the slots.
pub(crate) struct SlotTimer {
    slots: Slots<'static, AnyOutput, AnyOutput, AnyOutput>,
    timer: Slice<Pwm7, FreeRunning>,
}

impl SlotTimer {
    /// Runs one slot.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        self.timer.clear_interrupt();
        let Ok(()) = self.slots.slot();
    }
}

/// Builds the drives, off, and starts the slots.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
pub(crate) fn build(parts: DriveParts) -> (StepperDrives, SlotTimer) {
    let active = Active::at(ENABLE_HIGH);
    let pins = parts.pins;
    let Ok(enable) = Enable::new(pins.enable.output(active.off()).into_dyn_pin(), active);
    let [r1, r2, r3] = REVERSED;
    let Ok(axis_1) = Axis::new(
        pins.step_1.output(false).into_dyn_pin(),
        pins.direction_1.output(false).into_dyn_pin(),
        r1,
    );
    let Ok(axis_2) = Axis::new(
        pins.step_2.output(false).into_dyn_pin(),
        pins.direction_2.output(false).into_dyn_pin(),
        r2,
    );
    let Ok(axis_3) = Axis::new(
        pins.step_3.output(false).into_dyn_pin(),
        pins.direction_3.output(false).into_dyn_pin(),
        r3,
    );
    let slots = Slots::new(&LINE, [axis_1, axis_2, axis_3], enable, PER_TICK);

    let mut timer = parts.slots;
    timer.set_div_int(DIVIDER);
    timer.set_top(TOP);
    timer.clear_interrupt();
    timer.enable_interrupt();
    timer.enable();
    let steppers = Steppers::new(PER_TURN, MOST_PER_TICK, parts.angles, &LINE);
    (steppers, SlotTimer { slots, timer })
}
