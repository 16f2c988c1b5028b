//! Tool: GP16 is its level, or its PWM from slice 0; GP18 enables it. An image holds the output that its scene names.

use crate::drives::Unused;
use rp2040_hal::gpio::bank0::{Gpio16, Gpio18};
use rp2040_hal::gpio::{FunctionSioOutput, Pin, PullDown};
use rp2040_hal::pwm::{FreeRunning, Pwm0, Slice};
use trirrr_app::scene::tool::INVERTED;

#[cfg(tool = "duty")]
pub(super) use duty::{DutyPin as ToolPin, build};
#[cfg(tool = "level")]
pub(super) use level::{LevelPin as ToolPin, build};

type OutputOf<P> = Pin<P, FunctionSioOutput, PullDown>;

/// Parts of the board for the tool.
// Each kind of output takes some of them.
#[allow(dead_code)]
pub(super) struct ToolParts {
    pub(super) pin: Unused<Gpio16>,
    pub(super) enable: Unused<Gpio18>,
    pub(super) slice: Slice<Pwm0, FreeRunning>,
}

#[cfg(tool = "duty")]
mod duty {
    use super::{
        FreeRunning, Gpio16, Gpio18, INVERTED, OutputOf, Pin, PullDown, Pwm0, Slice, ToolParts,
    };
    use crate::clock::CORE_HZ;
    use core::convert::Infallible;
    use embedded_hal::pwm::{ErrorType, SetDutyCycle};
    use rp2040_hal::gpio::{FunctionPwm, OutputOverride};
    use trirrr_app::scene::tool::{ENABLE, FREQUENCY_HZ, SPAN};
    use trirrr_drives::Enable;
    use trirrr_drives::tool::DutyOutput;

    /// Output to the tool.
    pub(crate) type DutyPin = DutyOutput<ToolSlice, OutputOf<Gpio18>>;

    /// Divider in front of the timer, whose counts have 16 bits.
    const DIVIDER: u8 = {
        let divider = (CORE_HZ / FREQUENCY_HZ).div_ceil(1 << 16);
        // The reader of scenes takes no frequency below 10 Hz.
        assert!(divider <= 255);
        divider as u8
    };

    /// Last count of a period. One less than the most: the full duty is one more.
    const TOP: u16 = {
        let last = CORE_HZ / FREQUENCY_HZ / DIVIDER as u32 - 1;
        if last < u16::MAX as u32 {
            last as u16
        } else {
            u16::MAX - 1
        }
    };

    /// Channel A of slice 0. A duty waits for the end of a period; none and all of it are made by the pin, at once.
    pub(crate) struct ToolSlice {
        slice: Slice<Pwm0, FreeRunning>,
        pin: Pin<Gpio16, FunctionPwm, PullDown>,
    }

    impl ErrorType for ToolSlice {
        type Error = Infallible;
    }

    impl SetDutyCycle for ToolSlice {
        fn max_duty_cycle(&self) -> u16 {
            TOP + 1
        }

        #[inline(always)]
        fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
            self.pin.set_output_override(match duty {
                0 => OutputOverride::AlwaysLow,
                _ if duty > TOP => OutputOverride::AlwaysHigh,
                _ => OutputOverride::DontInvert,
            });
            self.slice.channel_a.set_duty_cycle(duty)
        }
    }

    /// Builds the output, off.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub(crate) fn build(parts: ToolParts) -> DutyPin {
        let pin = parts.enable;
        let enable = ENABLE.map(|active| {
            let off = active.off().into();
            let Ok(enable) = Enable::new(pin.into_push_pull_output_in_state(off), active);
            enable
        });
        let mut pin = parts.pin;
        // Before the pin is that of the slice.
        pin.set_output_override(match INVERTED {
            true => OutputOverride::AlwaysHigh,
            false => OutputOverride::AlwaysLow,
        });
        let mut slice = parts.slice;
        slice.set_div_int(DIVIDER);
        slice.set_top(TOP);
        let pin = slice.channel_a.output_to(pin);
        slice.enable();
        DutyOutput::new(ToolSlice { slice, pin }, enable, SPAN, INVERTED)
    }
}

#[cfg(tool = "level")]
mod level {
    use super::{Gpio16, INVERTED, OutputOf, ToolParts};
    use trirrr_drives::Active;
    use trirrr_drives::tool::LevelOutput;

    /// Output to the tool.
    pub(crate) type LevelPin = LevelOutput<OutputOf<Gpio16>>;

    /// Builds the output, off.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub(crate) fn build(parts: ToolParts) -> LevelPin {
        let on = Active::at(!INVERTED);
        LevelOutput::new(
            parts.pin.into_push_pull_output_in_state(on.off().into()),
            on,
        )
    }
}
