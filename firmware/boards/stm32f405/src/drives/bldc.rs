//! Amplifiers and encoders: set values from TIM3, counters in TIM1, TIM4 and TIM5, loops called by TIM7.
//!
//! A level at an input of an encoder counts once it was the same in eight samples, one in four periods of the timer's clock (RM0090, 17.4.7). So
//! what is shorter than 0.19 us (TIM1) or 0.38 us (TIM4, TIM5) does not count; `docs/board.md` has the rate of counts that is left.

use super::DriveParts;
use crate::board::{self, FailureInput, SetValue1, SetValue2, SetValue3};
use crate::dividers::set_pwm;
use crate::gpio::Pull;
use crate::parts::Rcc;
use crate::pins::PulledPin;
use crate::timers::SlotCounter;
use crate::wiring::BoardPin;
use stm32f4xx_hal::hal_02::Qei as _;
use stm32f4xx_hal::pac::{TIM1, TIM3, TIM4, TIM5};
use stm32f4xx_hal::prelude::*;
use stm32f4xx_hal::qei::Qei;
use stm32f4xx_hal::timer::{ErasedChannel, Polarity};
use trirrr_app::outputs::OrEmulated;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{
    COMMAND_HZ, ENABLE_HIGH, FAILED_HIGH, LOOP_HZ, MOTORS, PER_TICK, UNITS,
};
use trirrr_drives::bldc::{Bldcs, LoopLine, Loops};
use trirrr_drives::{Active, Enable, ObeyingDrives};
use trirrr_protocol::message::Clock;

/// Least cycles of the core between two samples, some three times those of a sample: fewer would starve the tick.
const LEAST_CYCLES: u32 = 3000;

/// From the tick to the loops.
static LINE: LoopLine = LoopLine::new();

/// Drives, as the tick sees them.
pub(crate) type BldcDrives = OrEmulated<Bldcs<&'static LoopLine>>;

/// Timer that calls the loops, with what they read.
pub(crate) struct SampleTimer {
    loops: Loops<&'static LoopLine, ErasedChannel<TIM3>, <board::Enable as BoardPin>::Output>,
    encoders: (Qei<TIM1>, Qei<TIM4>, Qei<TIM5>),
    failures: [FailureInput; 3],
    timer: SlotCounter,
}

impl SampleTimer {
    /// Runs one sample.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        // First: the write has to reach the timer before the interrupt returns.
        self.timer.clear();
        let (first, second, third) = &self.encoders;
        // The third counts in 32 bits.
        let counters = [first.count(), second.count(), third.count() as u16];
        let failed = match FAILED_HIGH {
            Some(high) => self.failures.each_ref().map(|pin| pin.is_high() == high),
            None => [false; 3],
        };
        self.loops.sample(counters, failed);
    }
}

/// Builds the loops, off, and starts their samples if the core is fast enough. Without samples the drives are silent, and the
/// machine is not enabled.
// A function of its own: its symbol shows that the image holds these drives.
#[inline(never)]
// An inverted pin has the type of the array already.
#[allow(clippy::useless_conversion)]
pub(crate) fn build(parts: DriveParts, rcc: &mut Rcc) -> (BldcDrives, SampleTimer) {
    let (pins, peripherals) = (parts.pins, parts.peripherals);
    let active = Active::at(ENABLE_HIGH);
    let Ok(enable) = Enable::new(pins.enable.output(active.off()), active);

    let (_, (pwm_1, pwm_2, pwm_3, _)) = peripherals.tim3.pwm_hz(COMMAND_HZ.Hz(), rcc);
    set_pwm(parts.clocks.timers, COMMAND_HZ);
    let mut pwm = [
        pwm_1.with(pins.set_value_1.plain()).erase(),
        pwm_2.with(pins.set_value_2.plain()).erase(),
        pwm_3.with(pins.set_value_3.plain()).erase(),
    ];
    let inverted = [
        SetValue1::INVERTED,
        SetValue2::INVERTED,
        SetValue3::INVERTED,
    ];
    for (channel, inverted) in pwm.iter_mut().zip(inverted) {
        if inverted {
            channel.set_polarity(Polarity::ActiveLow);
        }
    }
    // Sets the duties of no current before the outputs start.
    let mut loops = Loops::new(&LINE, &MOTORS, pwm, enable, PER_TICK);
    for channel in loops.outputs() {
        channel.enable();
    }
    let pull = match FAILED_HIGH {
        Some(true) => Pull::Up,
        Some(false) => Pull::Down,
        None => Pull::None,
    };
    let failures = [
        pins.failure_1.input(pull).into(),
        pins.failure_2.input(pull).into(),
        pins.failure_3.input(pull).into(),
    ];
    let encoders = (
        Qei::new(peripherals.tim1, (pins.encoder_a_1, pins.encoder_b_1), rcc),
        Qei::new(peripherals.tim4, (pins.encoder_a_2, pins.encoder_b_2), rcc),
        Qei::new(peripherals.tim5, (pins.encoder_a_3, pins.encoder_b_3), rcc),
    );
    filter_encoders();

    let (timer, clocks) = (SlotCounter::new(peripherals.slots, rcc), parts.clocks);
    let timer = SampleTimer {
        loops,
        encoders,
        failures,
        timer,
    };
    if parts.clock == Clock::Emulated {
        let drives = ObeyingDrives::new(parts.angles);
        return (OrEmulated::Emulated(drives), timer);
    }
    if clocks.core / LOOP_HZ >= LEAST_CYCLES {
        timer.timer.start(clocks.timers, LOOP_HZ);
    } else {
        defmt::error!(
            "{=u32} samples of the loops per second are too many for {=u32} Hz",
            LOOP_HZ,
            clocks.core
        );
    }
    let drives = Bldcs::new::<Scalar>(&LINE, UNITS, parts.angles);
    (OrEmulated::Real(drives), timer)
}

/// Sets the filters at the inputs of the encoders, which the HAL leaves off: each spike would count.
#[allow(unsafe_code)]
fn filter_encoders() {
    const EIGHT_OF_A_FOURTH: u8 = 0b0111;
    // SAFETY: any filter is one, and the interrupt that reads the counters is not on yet.
    unsafe {
        let inputs = (&*TIM1::ptr()).ccmr1_input();
        inputs.modify(|_, w| {
            w.ic1f()
                .bits(EIGHT_OF_A_FOURTH)
                .ic2f()
                .bits(EIGHT_OF_A_FOURTH)
        });
        let inputs = (&*TIM4::ptr()).ccmr1_input();
        inputs.modify(|_, w| {
            w.ic1f()
                .bits(EIGHT_OF_A_FOURTH)
                .ic2f()
                .bits(EIGHT_OF_A_FOURTH)
        });
        let inputs = (&*TIM5::ptr()).ccmr1_input();
        inputs.modify(|_, w| {
            w.ic1f()
                .bits(EIGHT_OF_A_FOURTH)
                .ic2f()
                .bits(EIGHT_OF_A_FOURTH)
        });
    }
}
