//! Timers of slots and of the tool.
// An image uses those of its scene's drives.
#![allow(dead_code)]

use crate::counts::counts;
use crate::parts::Rcc;
use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use stm32_metapac::timer::vals::Ocm;
use stm32_metapac::timer::{TimBasic, TimGp32};

/// Registers of TIM7.
pub(crate) type SlotRegisters = TimBasic;

/// TIM7, which calls slots of steppers.
pub(crate) struct SlotCounter(TimBasic);

impl SlotCounter {
    /// Takes the timer, which stands still.
    pub(crate) fn new(timer: SlotRegisters, _: &mut Rcc) -> Self {
        Self(timer)
    }

    /// Starts the timer, which counts at `timer_hz`, with `rate_hz` interrupts per second.
    pub(crate) fn start(&self, timer_hz: u32, rate_hz: u32) {
        let (prescaler, last) = counts(timer_hz, rate_hz);
        self.0.psc().write_value(prescaler);
        self.0.arr().write(|w| w.set_arr(last));
        self.0.egr().write(|w| w.set_ug(true));
        // The forced update is no period.
        self.clear();
        self.0.dier().write(|w| w.set_uie(true));
        self.0.cr1().write(|w| w.set_cen(true));
    }

    /// Clears the interrupt.
    #[inline(always)]
    pub(crate) fn clear(&self) {
        self.0.sr().write(|w| w.set_uif(false));
    }
}

/// Timer of the tool, TIM2.
pub(crate) type ToolCounter = TimGp32;

/// Channel 1 of TIM2.
pub(crate) struct ToolTimer {
    timer: TimGp32,
    full: u16,
}

impl ToolTimer {
    /// Starts the timer with no duty. `rates` are those at which the timer counts and of the periods, Hz. A duty that
    /// `cuts` counts at once.
    pub(crate) fn start(
        timer: ToolCounter,
        rates: (u32, u32),
        cuts: bool,
        inverted: bool,
        _: &mut Rcc,
    ) -> Self {
        let (prescaler, last) = counts(rates.0, rates.1);
        timer.psc().write_value(prescaler);
        timer.arr().write_value(last.into());
        // Without the preload a duty counts at once.
        timer.ccmr_output(0).write(|w| {
            w.set_ocm(0, Ocm::PWM_MODE1);
            w.set_ocpe(0, !cuts);
        });
        timer.ccer().write(|w| {
            w.set_cce(0, true);
            w.set_ccp(0, inverted);
        });
        timer.egr().write(|w| w.set_ug(true));
        timer.cr1().write(|w| w.set_cen(true));
        let full = last.saturating_add(1);
        Self { timer, full }
    }
}

impl ErrorType for ToolTimer {
    type Error = Infallible;
}

impl SetDutyCycle for ToolTimer {
    fn max_duty_cycle(&self) -> u16 {
        self.full
    }

    #[inline(always)]
    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        self.timer.ccr(0).write_value(duty.into());
        Ok(())
    }
}
