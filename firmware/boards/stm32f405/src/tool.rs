//! Tool: a pin is its level, or its PWM from TIM2, another one enables it. An image holds the output that its scene names.

use crate::board::{Tool, ToolEnable};
use crate::clock::Clocks;
use stm32f4xx_hal::pac::TIM2;
use stm32f4xx_hal::rcc::Rcc;
use trirrr_app::scene::tool::INVERTED;

#[cfg(tool = "duty")]
pub(super) use duty::{DutyPin as ToolPin, build};
#[cfg(tool = "level")]
pub(super) use level::{LevelPin as ToolPin, build};

/// Parts of the board for the tool.
// Each kind of output takes some of them.
#[allow(dead_code)]
pub(super) struct ToolParts {
    pub(super) tool: Tool,
    pub(super) enable: ToolEnable,
    pub(super) tim2: TIM2,
    pub(super) clocks: Clocks,
}

#[cfg(tool = "duty")]
mod duty {
    use super::{INVERTED, Rcc, TIM2, Tool, ToolEnable, ToolParts};
    use crate::dividers::counts;
    use crate::pins::BoardPin;
    use core::convert::Infallible;
    use stm32f4xx_hal::hal::pwm::{ErrorType, SetDutyCycle};
    use stm32f4xx_hal::rcc::{Enable as _, Reset};
    use trirrr_app::scene::tool::{CUTS, ENABLE, FREQUENCY_HZ, SPAN};
    use trirrr_drives::Enable;
    use trirrr_drives::tool::DutyOutput;

    /// Output to the tool.
    pub(crate) type DutyPin = DutyOutput<ToolTimer, <ToolEnable as BoardPin>::Output>;

    /// Channel 1 of TIM2. Not that of the HAL: its duty waits for the end of a period, and a tool goes off at once.
    pub(crate) struct ToolTimer {
        timer: TIM2,
        full: u16,
    }

    impl ToolTimer {
        /// Starts the timer, which counts at `timer_hz`, with no duty.
        fn start(timer: TIM2, timer_hz: u32, rcc: &mut Rcc) -> Self {
            TIM2::enable(rcc);
            TIM2::reset(rcc);
            let (prescaler, last) = counts(timer_hz, FREQUENCY_HZ);
            timer.psc().write(|w| w.psc().set(prescaler));
            timer.arr().write(|w| w.arr().set(last.into()));
            // Without the preload a duty counts at once (RM0090, 18.4.7).
            timer
                .ccmr1_output()
                .write(|w| w.oc1m().pwm_mode1().oc1pe().bit(!CUTS));
            timer
                .ccer()
                .write(|w| w.cc1e().set_bit().cc1p().bit(Tool::INVERTED));
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

    /// Builds the output, off.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub(crate) fn build(parts: ToolParts, rcc: &mut Rcc) -> DutyPin {
        let pin = parts.enable;
        let enable = ENABLE.map(|active| {
            let Ok(enable) = Enable::new(pin.output(active.off()), active);
            enable
        });
        let timer = ToolTimer::start(parts.tim2, parts.clocks.timers, rcc);
        let output = DutyOutput::new(timer, enable, SPAN, INVERTED);
        // The pin is an input up to here, and the wiring holds the tool off.
        let _ = parts.tool.plain().into_alternate::<1>();
        output
    }
}

#[cfg(tool = "level")]
mod level {
    use super::{INVERTED, Rcc, Tool, ToolParts};
    use crate::pins::BoardPin;
    use trirrr_drives::Active;
    use trirrr_drives::tool::LevelOutput;

    /// Output to the tool.
    pub(crate) type LevelPin = LevelOutput<<Tool as BoardPin>::Output>;

    /// Builds the output, off.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub(crate) fn build(parts: ToolParts, _: &mut Rcc) -> LevelPin {
        let on = Active::at(!INVERTED);
        LevelOutput::new(parts.tool.output(on.off()), on)
    }
}
