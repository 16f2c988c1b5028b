//! Timers of slots, of samples and of the tool.
// An image uses those of its scene's drives.
#![allow(dead_code)]

use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use stm32_metapac::timer::vals::Ocm;
use stm32_metapac::{TIM2, TIM7};

/// Prescaler and reload value of a timer of 16 bits, both less by one.
pub(crate) const fn counts(timer_hz: u32, rate_hz: u32) -> (u16, u16) {
    let counts = timer_hz / rate_hz;
    let prescaler = (counts - 1) / 0x1_0000;
    (prescaler as u16, (counts / (prescaler + 1) - 1) as u16)
}

const _: () = {
    assert!(matches!(counts(84_000_000, 20_000), (0, 4199)));
    assert!(matches!(counts(84_000_000, 1000), (1, 41_999)));
    assert!(matches!(counts(16_000_000, 100), (2, 53_332)));
};

/// TIM7, which calls slots of steppers, or samples of loops.
pub(crate) struct SlotCounter;

impl SlotCounter {
    /// Starts the timer, which counts at `timer_hz`, with `rate_hz` interrupts per second.
    pub(crate) fn start(&self, timer_hz: u32, rate_hz: u32) {
        let (prescaler, last) = counts(timer_hz, rate_hz);
        TIM7.psc().write_value(prescaler);
        TIM7.arr().write(|w| w.set_arr(last));
        TIM7.egr().write(|w| w.set_ug(true));
        // The forced update is no period.
        self.clear();
        TIM7.dier().write(|w| w.set_uie(true));
        TIM7.cr1().write(|w| w.set_cen(true));
    }

    /// Clears the interrupt.
    #[inline(always)]
    pub(crate) fn clear(&self) {
        TIM7.sr().write(|w| w.set_uif(false));
    }
}

/// Channel 1 of TIM2, the tool's.
pub(crate) struct ToolTimer {
    full: u16,
}

impl ToolTimer {
    /// Starts the timer with no duty. `rates` are those at which the timer counts and of the periods, Hz. A duty that
    /// `cuts` counts at once.
    pub(crate) fn start(rates: (u32, u32), cuts: bool, inverted: bool) -> Self {
        let (prescaler, last) = counts(rates.0, rates.1);
        TIM2.psc().write_value(prescaler);
        TIM2.arr().write_value(last.into());
        // Without the preload a duty counts at once (RM0090, 18.4.7): a tool goes off before the end of a period.
        TIM2.ccmr_output(0).write(|w| {
            w.set_ocm(0, Ocm::PWM_MODE1);
            w.set_ocpe(0, !cuts);
        });
        TIM2.ccer().write(|w| {
            w.set_cce(0, true);
            w.set_ccp(0, inverted);
        });
        TIM2.egr().write(|w| w.set_ug(true));
        TIM2.cr1().write(|w| w.set_cen(true));
        let full = last.saturating_add(1);
        Self { full }
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
        TIM2.ccr(0).write_value(duty.into());
        Ok(())
    }
}
