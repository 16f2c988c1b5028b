//! Timers of slots and of the tool. Those of the HAL start at rates made of the clock of the reset.
#![allow(unsafe_code)]
// An image uses those of its scene's drives.
#![allow(dead_code)]

use crate::counts::counts;
use core::convert::Infallible;
use stm32f4xx_hal::hal::pwm::{ErrorType, SetDutyCycle};
use stm32f4xx_hal::pac::{TIM2, TIM7};
use stm32f4xx_hal::rcc::{Enable as _, Rcc, Reset};

/// TIM7, which calls slots of steppers, or samples of loops.
pub(crate) struct SlotCounter(TIM7);

impl SlotCounter {
    /// Takes the timer, which stands still.
    pub(crate) fn new(timer: TIM7, rcc: &mut Rcc) -> Self {
        TIM7::enable(rcc);
        TIM7::reset(rcc);
        Self(timer)
    }

    /// Starts the timer, which counts at `timer_hz`, with `rate_hz` interrupts per second.
    pub(crate) fn start(&self, timer_hz: u32, rate_hz: u32) {
        let (prescaler, last) = counts(timer_hz, rate_hz);
        self.0.psc().write(|w| w.psc().set(prescaler));
        self.0.arr().write(|w| w.arr().set(last));
        self.0.egr().write(|w| w.ug().set_bit());
        // The forced update is no period.
        self.clear();
        self.0.dier().write(|w| w.uie().set_bit());
        self.0.cr1().write(|w| w.cen().set_bit());
    }

    /// Clears the interrupt.
    #[inline(always)]
    pub(crate) fn clear(&self) {
        self.0.sr().write(|w| w.uif().clear_bit());
    }
}

/// Timer of the tool.
pub(crate) type ToolCounter = TIM2;

/// Channel 1 of TIM2. Not that of the HAL: its duty waits for the end of a period, and a tool goes off at once.
pub(crate) struct ToolTimer {
    timer: TIM2,
    full: u16,
}

impl ToolTimer {
    /// Starts the timer with no duty. `rates` are those at which the timer counts and of the periods, Hz. A duty that
    /// `cuts` counts at once.
    pub(crate) fn start(
        timer: TIM2,
        rates: (u32, u32),
        cuts: bool,
        inverted: bool,
        rcc: &mut Rcc,
    ) -> Self {
        TIM2::enable(rcc);
        TIM2::reset(rcc);
        let (prescaler, last) = counts(rates.0, rates.1);
        timer.psc().write(|w| w.psc().set(prescaler));
        timer.arr().write(|w| w.arr().set(last.into()));
        // Without the preload a duty counts at once (RM0090, 18.4.7).
        timer
            .ccmr1_output()
            .write(|w| w.oc1m().pwm_mode1().oc1pe().bit(!cuts));
        timer
            .ccer()
            .write(|w| w.cc1e().set_bit().cc1p().bit(inverted));
        timer.egr().write(|w| w.ug().set_bit());
        timer.cr1().write(|w| w.cen().set_bit());
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
        self.timer.ccr1().write(|w| w.ccr().set(duty.into()));
        Ok(())
    }
}
