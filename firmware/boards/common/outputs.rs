//! Outputs of the tick: the drives, and beside them brake, tool, lamp and spare outputs, where the scene has them.

use crate::drives::Drives;
#[cfg(any(brake, lamp))]
use crate::wiring::BoardPin;
use trirrr_app::outputs::WithParts;

#[cfg(brake)]
type BrakePart = trirrr_app::outputs::BrakePin<<crate::board::Brake as BoardPin>::Output>;
#[cfg(not(brake))]
type BrakePart = ();
#[cfg(not(tool = "none"))]
type ToolPart = trirrr_app::outputs::SceneTool<crate::tool::ToolPin>;
#[cfg(tool = "none")]
type ToolPart = ();
#[cfg(lamp)]
type LampPart = trirrr_app::LampPin<<crate::board::Lamp as BoardPin>::Output>;
#[cfg(not(lamp))]
type LampPart = ();
#[cfg(digital)]
type SparePart = crate::digital::SpareOutputPins;
#[cfg(not(digital))]
type SparePart = ();

/// Outputs of this image.
pub(crate) type BoardOutputs = WithParts<Drives, (BrakePart, ToolPart, LampPart, SparePart)>;

/// Drives and tool, which are off, and the pins beside them.
pub(crate) struct OutputPins {
    pub(crate) drives: Drives,
    #[cfg(brake)]
    pub(crate) brake: crate::board::Brake,
    #[cfg(not(tool = "none"))]
    pub(crate) tool: crate::tool::ToolPin,
    #[cfg(lamp)]
    pub(crate) lamp: crate::board::Lamp,
    #[cfg(digital)]
    pub(crate) spare: crate::digital::OutputPins,
}

/// Joins the outputs, all off.
pub(crate) fn build(pins: OutputPins) -> BoardOutputs {
    WithParts {
        drives: pins.drives,
        parts: (
            #[cfg(brake)]
            BrakePart::new(pins.brake.output(false)),
            #[cfg(not(brake))]
            (),
            #[cfg(not(tool = "none"))]
            trirrr_app::outputs::tool_line(pins.tool),
            #[cfg(tool = "none")]
            (),
            #[cfg(lamp)]
            LampPart::new(pins.lamp.output(false)),
            #[cfg(not(lamp))]
            (),
            #[cfg(digital)]
            crate::digital::outputs(pins.spare),
            #[cfg(not(digital))]
            (),
        ),
    }
}
