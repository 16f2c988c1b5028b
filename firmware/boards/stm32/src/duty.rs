//! Tool at a PWM: TIM2, and a pin that enables it.

use crate::board::{Tool, ToolEnable, ToolPins};
use crate::clock::Clocks;
use crate::timers::ToolTimer;
use trirrr_app::scene::tool::{CUTS, ENABLE, FREQUENCY_HZ, INVERTED, SPAN};
use trirrr_app::tool::{SceneTool, tool_line};
use trirrr_boards::BoardPin;
use trirrr_drives::Enable;
use trirrr_drives::tool::DutyOutput;

/// Line to the tool.
pub(crate) type DutyPart = SceneTool<DutyOutput<ToolTimer, <ToolEnable as BoardPin>::Output>>;

/// Builds the output, off.
// A function of its own: its symbol shows that the image holds it.
#[inline(never)]
pub(crate) fn build((pins, clocks): (ToolPins, Clocks)) -> DutyPart {
    let (tool, pin) = pins;
    let enable = ENABLE.map(|active| {
        let Ok(enable) = Enable::new(pin.output(active.off()), active);
        enable
    });
    let timer = ToolTimer::start((clocks.timers, FREQUENCY_HZ), CUTS, Tool::INVERTED);
    let output = DutyOutput::new(timer, enable, SPAN, INVERTED);
    // The pin is an input up to here, and the wiring holds the tool off.
    let _ = tool.plain().into_alternate::<1>();
    tool_line(output)
}
