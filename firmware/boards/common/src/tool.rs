//! Tool: a pin is its level, or its PWM, which each board has of its own; another one enables it. An image holds the output that its scene names.

/// Tool at the level of a pin.
#[cfg(tool = "level")]
pub mod level {
    use crate::BoardPin;
    use trirrr_app::scene::tool::INVERTED;
    use trirrr_app::tool::{SceneTool, tool_line};
    use trirrr_drives::Active;
    use trirrr_drives::tool::LevelOutput;

    /// Line to the tool at the pin `P`.
    pub type LevelPart<P> = SceneTool<LevelOutput<<P as BoardPin>::Output>>;

    /// Builds the output, off. No other pin, nor the board's PWM, takes part.
    // A function of its own: its symbol shows that the image holds it.
    #[inline(never)]
    pub fn build<P: BoardPin, E, W>(((tool, _), _): ((P, E), W)) -> LevelPart<P> {
        let on = Active::at(!INVERTED);
        tool_line(LevelOutput::new(tool.output(on.off()), on))
    }
}

/// No tool.
pub mod none {
    use trirrr_app::outputs::OutputPart;

    /// Line to no tool.
    pub struct NoTool;

    impl OutputPart for NoTool {}

    /// Takes no pin.
    pub fn build<P>(_: P) -> NoTool {
        NoTool
    }
}
