//! Tool: a pin is its level, or its PWM; another one enables it. An image holds the output that its scene names.

use crate::board::{Tool, ToolEnable, ToolPwm};
use rp2040_hal::pwm::{FreeRunning, Slice};
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
    pub(super) slice: Slice<ToolPwm, FreeRunning>,
}

#[cfg(tool = "duty")]
mod duty {
    use super::{FreeRunning, INVERTED, Slice, Tool, ToolEnable, ToolParts, ToolPwm};
    use crate::clock::CORE_HZ;
    use crate::wiring::BoardPin;
    use core::convert::Infallible;
    use embedded_hal::pwm::{ErrorType, SetDutyCycle};
    use rp2040_hal::gpio::{AnyPin, FunctionPwm, OutputOverride, Pin, PullDown};
    use trirrr_app::scene::tool::{ENABLE, FREQUENCY_HZ, SPAN};
    use trirrr_drives::Enable;
    use trirrr_drives::tool::DutyOutput;

    /// Output to the tool.
    pub(crate) type DutyPin = DutyOutput<ToolSlice, <ToolEnable as BoardPin>::Output>;

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

    type ToolId = <<Tool as BoardPin>::Plain as AnyPin>::Id;

    /// Override of the pin for a constant level, as the tool sees it,
    const fn constant(high: bool) -> OutputOverride {
        match high != Tool::INVERTED {
            true => OutputOverride::AlwaysHigh,
            false => OutputOverride::AlwaysLow,
        }
    }

    /// and for pulses.
    const PULSES: OutputOverride = match Tool::INVERTED {
        true => OutputOverride::Invert,
        false => OutputOverride::DontInvert,
    };

    /// Channel A of the pin's slice. A duty waits for the end of a period; none and all of it are made by the pin, at once.
    pub(crate) struct ToolSlice {
        slice: Slice<ToolPwm, FreeRunning>,
        pin: Pin<ToolId, FunctionPwm, PullDown>,
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
                0 => const { constant(false) },
                _ if duty > TOP => const { constant(true) },
                _ => PULSES,
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
            let Ok(enable) = Enable::new(pin.output(active.off()), active);
            enable
        });
        let mut pin = parts.tool.plain();
        // Before the pin is that of the slice.
        pin.set_output_override(constant(INVERTED));
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
    use super::{INVERTED, Tool, ToolParts};
    use crate::wiring::BoardPin;
    use trirrr_drives::Active;
    use trirrr_drives::tool::LevelOutput;

    /// Output to the tool.
    pub(crate) type LevelPin = LevelOutput<<Tool as BoardPin>::Output>;

    /// Builds the output, off.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub(crate) fn build(parts: ToolParts) -> LevelPin {
        let on = Active::at(!INVERTED);
        LevelOutput::new(parts.tool.output(on.off()), on)
    }
}
