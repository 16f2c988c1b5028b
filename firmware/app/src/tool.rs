//! Line to the tool, of a scene that has one.

use crate::scene::tool::{DELAY, HOLDS};
use trirrr_drives::tool::{ToolLine, ToolOutput};

/// Line to the tool at the output `T`.
pub type SceneTool<T> = ToolLine<T, DELAY>;

/// Starts the line to a tool that is off.
pub fn tool_line<T: ToolOutput>(tool: T) -> SceneTool<T> {
    ToolLine::new(tool, HOLDS)
}
