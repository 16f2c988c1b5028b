//! Amplifiers and encoders: set values from TIM3, counters in TIM1, TIM4 and TIM5, loops called by TIM7.
//!
//! A level at an input of an encoder counts once it was the same in eight samples, one in four periods of the timer's clock (RM0090, 17.4.7). So
//! what is shorter than 0.19 us (TIM1) or 0.38 us (TIM4, TIM5) does not count; `docs/board.md` has the rate of counts that is left.
#![allow(unsafe_code)]

pub(crate) use self::{BldcDrives as Drives, SampleTimer as DriveTimer};
use super::DriveParts;
pub(crate) use super::no_bus::{Inbox, no_frames, report};
use crate::board::{self, FailureInput, SetValue1, SetValue2, SetValue3};
use crate::gpio::Pull;
use crate::pins::PulledPin;
use crate::timers::{SlotCounter, counts};
use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use stm32_metapac::common::{RW, Reg};
use stm32_metapac::timer::TimGp16;
use stm32_metapac::timer::regs::Ccr1ch;
use stm32_metapac::timer::vals::{CcmrInputCcs, FilterValue, Ocm, Sms};
use stm32_metapac::{TIM1, TIM3, TIM4, TIM5};
use trirrr_app::outputs::OrEmulated;
use trirrr_app::scene::Scalar;
use trirrr_app::scene::drive::{
    COMMAND_HZ, ENABLE_HIGH, FAILED_HIGH, LOOP_HZ, MOTORS, PER_TICK, UNITS,
};
use trirrr_boards::BoardPin;
use trirrr_drives::bldc::{Bldcs, LoopLine, Loops};
use trirrr_drives::{Active, Enable, ObeyingDrives};
use trirrr_protocol::message::Clock;

/// Least cycles of the core between two samples, some three times those of a sample: fewer would starve the tick.
const LEAST_CYCLES: u32 = 3000;

/// From the tick to the loops.
static LINE: LoopLine = LoopLine::new();

/// Drives, as the tick sees them.
pub(crate) type BldcDrives = OrEmulated<Bldcs<&'static LoopLine>>;

/// Timers of the encoders: the registers of each that are used here are those of a timer of 16 bits. TIM5 counts as many.
// SAFETY: each of them has these registers at the same places (RM0090, chapters 17 and 18).
const ENCODERS: [TimGp16; 3] = unsafe {
    [
        TimGp16::from_ptr(TIM1.as_ptr()),
        TIM4,
        TimGp16::from_ptr(TIM5.as_ptr()),
    ]
};

/// Channel of TIM3.
pub(crate) struct PwmChannel {
    duty: Reg<Ccr1ch, RW>,
    full: u16,
}

impl ErrorType for PwmChannel {
    type Error = Infallible;
}

impl SetDutyCycle for PwmChannel {
    fn max_duty_cycle(&self) -> u16 {
        self.full
    }

    #[inline(always)]
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.duty.write(|w| w.set_ccr(duty));
        Ok(())
    }
}

/// Timer that calls the loops, with what they read.
pub(crate) struct SampleTimer {
    loops: Loops<&'static LoopLine, PwmChannel, <board::Enable as BoardPin>::Output>,
    failures: [FailureInput; 3],
    timer: SlotCounter,
}

impl SampleTimer {
    /// Runs one sample.
    #[inline(always)]
    pub(crate) fn run(&mut self) {
        // First: the write has to reach the timer before the interrupt returns.
        self.timer.clear();
        let counters = ENCODERS.map(|timer| timer.cnt().read().cnt());
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
pub(crate) fn build(parts: DriveParts) -> (BldcDrives, SampleTimer) {
    let pins = parts.pins;
    let active = Active::at(ENABLE_HIGH);
    let Ok(enable) = Enable::new(pins.enable.output(active.off()), active);

    let pwm = start_pwm(parts.clocks.timers);
    let _ = (
        pins.set_value_1.plain().into_alternate::<2>(),
        pins.set_value_2.plain().into_alternate::<2>(),
        pins.set_value_3.plain().into_alternate::<2>(),
    );
    // Sets the duties of no current before the outputs start.
    let loops = Loops::new(&LINE, &MOTORS, pwm, enable, PER_TICK);
    TIM3.ccer()
        .modify(|w| (0..3).for_each(|channel| w.set_cce(channel, true)));
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
    let _ = (
        pins.encoder_a_1.into_alternate::<1>(),
        pins.encoder_b_1.into_alternate::<1>(),
        pins.encoder_a_2.into_alternate::<2>(),
        pins.encoder_b_2.into_alternate::<2>(),
        pins.encoder_a_3.into_alternate::<2>(),
        pins.encoder_b_3.into_alternate::<2>(),
    );
    ENCODERS.into_iter().for_each(start_encoder);

    let clocks = parts.clocks;
    let timer = SampleTimer {
        loops,
        failures,
        timer: SlotCounter,
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

/// Starts TIM3 without an output: the channels of the set values.
fn start_pwm(timer_hz: u32) -> [PwmChannel; 3] {
    let (prescaler, last) = counts(timer_hz, COMMAND_HZ);
    TIM3.psc().write_value(prescaler);
    TIM3.arr().write(|w| w.set_arr(last));
    let inverted = [
        SetValue1::INVERTED,
        SetValue2::INVERTED,
        SetValue3::INVERTED,
    ];
    for (channel, inverted) in inverted.into_iter().enumerate() {
        TIM3.ccmr_output(channel / 2).modify(|w| {
            w.set_ocm(channel % 2, Ocm::PWM_MODE1);
            w.set_ocpe(channel % 2, true);
        });
        TIM3.ccer().modify(|w| w.set_ccp(channel, inverted));
    }
    // An update loads both.
    TIM3.egr().write(|w| w.set_ug(true));
    TIM3.cr1().write(|w| {
        w.set_arpe(true);
        w.set_cen(true);
    });
    [0, 1, 2].map(|channel| PwmChannel {
        duty: TIM3.ccr(channel),
        full: last.wrapping_add(1),
    })
}

/// Starts a timer that counts the edges of both inputs, each behind its filter: without, each spike would count.
fn start_encoder(timer: TimGp16) {
    timer.ccmr_input(0).write(|w| {
        for channel in [0, 1] {
            // Its own input.
            w.set_ccs(channel, CcmrInputCcs::TI4);
            w.set_icf(channel, FilterValue::FDTS_DIV4_N8);
        }
    });
    timer.ccer().write(|w| {
        w.set_cce(0, true);
        w.set_cce(1, true);
    });
    timer.smcr().write(|w| w.set_sms(Sms::ENCODER_MODE_3));
    timer.arr().write(|w| w.set_arr(u16::MAX));
    timer.cr1().write(|w| w.set_cen(true));
}
