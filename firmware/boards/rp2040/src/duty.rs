//! Tool at a PWM: the slice of its pin, and a pin that enables it.

use crate::board::{Tool, ToolEnable, ToolPins, ToolPwm, ToolSlice};
use crate::clock::CORE_HZ;
use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use rp2040_hal::gpio::{AnyPin, FunctionPwm, OutputOverride, Pin, PullDown};
use rp2040_hal::pwm::{FreeRunning, Slice};
use trirrr_app::scene::tool::{ENABLE, FREQUENCY_HZ, INVERTED, SPAN};
use trirrr_app::tool::{SceneTool, tool_line};
use trirrr_boards::BoardPin;
use trirrr_drives::Enable;
use trirrr_drives::tool::DutyOutput;

/// Line to the tool.
pub(crate) type DutyPart = SceneTool<DutyOutput<DutySlice, <ToolEnable as BoardPin>::Output>>;

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
pub(crate) struct DutySlice {
    slice: Slice<ToolPwm, FreeRunning>,
    pin: Pin<ToolId, FunctionPwm, PullDown>,
}

impl ErrorType for DutySlice {
    type Error = Infallible;
}

impl SetDutyCycle for DutySlice {
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
pub(crate) fn build((pins, mut slice): (ToolPins, ToolSlice)) -> DutyPart {
    let (tool, pin) = pins;
    let enable = ENABLE.map(|active| {
        let Ok(enable) = Enable::new(pin.output(active.off()), active);
        enable
    });
    let mut pin = tool.plain();
    // Before the pin is that of the slice.
    pin.set_output_override(constant(INVERTED));
    slice.set_div_int(DIVIDER);
    slice.set_top(TOP);
    let pin = slice.channel_a.output_to(pin);
    slice.enable();
    tool_line(DutyOutput::new(
        DutySlice { slice, pin },
        enable,
        SPAN,
        INVERTED,
    ))
}
