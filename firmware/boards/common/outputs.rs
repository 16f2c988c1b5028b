//! Outputs of the tick: the drives, and beside them brake, tool, lamp and spare outputs, where the scene has them.

use crate::board::OutputPins;
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

/// Joins the outputs, all off, as drives and tool are. An image has the pins of its scene.
pub(crate) fn build(
    drives: Drives,
    #[cfg(not(tool = "none"))] tool: crate::tool::ToolPin,
    pins: OutputPins,
) -> BoardOutputs {
    #[cfg(not(any(brake, lamp, digital)))]
    let OutputPins {} = pins;
    WithParts {
        drives,
        parts: (
            #[cfg(brake)]
            BrakePart::new(pins.brake.output(false)),
            #[cfg(not(brake))]
            (),
            #[cfg(not(tool = "none"))]
            trirrr_app::outputs::tool_line(tool),
            #[cfg(tool = "none")]
            (),
            #[cfg(lamp)]
            LampPart::new(pins.lamp.output(false)),
            #[cfg(not(lamp))]
            (),
            #[cfg(digital)]
            crate::digital::outputs((
                pins.output_1,
                pins.output_2,
                pins.output_3,
                pins.output_4,
                pins.output_5,
                pins.output_6,
                pins.output_7,
                pins.output_8,
            )),
            #[cfg(not(digital))]
            (),
        ),
    }
}
