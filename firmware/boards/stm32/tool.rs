//! Tool: a pin is its level, or its PWM, another one enables it. An image holds the output that its scene names.

use crate::board::{Tool, ToolEnable};
use crate::clock::Clocks;
use crate::parts::Rcc;
use crate::timers::ToolCounter;
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
    pub(super) counter: ToolCounter,
    pub(super) clocks: Clocks,
}

#[cfg(tool = "duty")]
mod duty {
    use super::{INVERTED, Rcc, Tool, ToolEnable, ToolParts};
    use crate::timers::ToolTimer;
    use crate::wiring::BoardPin;
    use trirrr_app::scene::tool::{CUTS, ENABLE, FREQUENCY_HZ, SPAN};
    use trirrr_drives::Enable;
    use trirrr_drives::tool::DutyOutput;

    /// Output to the tool.
    pub(crate) type DutyPin = DutyOutput<ToolTimer, <ToolEnable as BoardPin>::Output>;

    /// Builds the output, off.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub(crate) fn build(parts: ToolParts, rcc: &mut Rcc) -> DutyPin {
        let pin = parts.enable;
        let enable = ENABLE.map(|active| {
            let Ok(enable) = Enable::new(pin.output(active.off()), active);
            enable
        });
        let timer = ToolTimer::start(
            parts.counter,
            (parts.clocks.timers, FREQUENCY_HZ),
            CUTS,
            Tool::INVERTED,
            rcc,
        );
        let output = DutyOutput::new(timer, enable, SPAN, INVERTED);
        // The pin is an input up to here, and the wiring holds the tool off.
        let _ = parts.tool.plain().into_alternate::<1>();
        output
    }
}

#[cfg(tool = "level")]
mod level {
    use super::{INVERTED, Rcc, Tool, ToolParts};
    use crate::wiring::BoardPin;
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
