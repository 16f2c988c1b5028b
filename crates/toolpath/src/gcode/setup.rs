//! Settings of an interpreter.
use crate::ToolPlace;

/// Number of work coordinate systems, G54 to G59.
pub const ORIGINS: usize = 6;

/// Sense of words of Z. The machine moves in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ZWords {
    /// They are refused.
    #[default]
    Refused,
    /// They have no effect. A motion in which the tool would be on where the program lifts it is refused.
    Ignored,
    /// The tool is on at a height and below it, and off above, also in G0. Before the first motion of Z, and behind G28 and G53 with Z,
    /// it is off. Its power is that of S, or all where there is no S yet; a program with M3 or M4 switches it by M5, too.
    Tool {
        /// Height in work coordinates, m.
        on_at_m: f64,
    },
}

/// Settings that an interpreter begins with.
#[derive(Clone, Debug, PartialEq)]
pub struct GcodeSetup {
    /// Place of the machine at the start, in the fixed frame.
    pub start: ToolPlace,
    /// Zero points of G54 to G59 in the fixed frame; `alpha_rad` is the zero of A.
    pub origins: [ToolPlace; ORIGINS],
    /// S word of full power ($30 of GRBL), positive. S words are refused if `full_power` is not positive.
    pub full_power: f64,
    /// Goal of G28 in the fixed frame. None: G28 is refused.
    pub home: Option<ToolPlace>,
    /// Sense of words of Z.
    pub z: ZWords,
    /// Outputs of the machine, of the numbers from 0 on; at most 8.
    pub outputs: u8,
    /// Inputs of the machine, of the numbers from 0 on; at most 8.
    pub inputs: u8,
}

impl Default for GcodeSetup {
    /// All zero points at the origin of the fixed frame, S1000 for full power, no G28, no Z, no outputs and inputs.
    fn default() -> Self {
        Self {
            start: ToolPlace::default(),
            origins: [ToolPlace::default(); ORIGINS],
            full_power: 1000.0,
            home: None,
            z: ZWords::Refused,
            outputs: 0,
            inputs: 0,
        }
    }
}

/// Part of the setup that no line changes.
#[derive(Clone, Copy, Debug)]
pub(super) struct FixedSetup {
    pub(super) full_power: f64,
    pub(super) home: Option<ToolPlace>,
    pub(super) z: ZWords,
    pub(super) outputs: u8,
    pub(super) inputs: u8,
}
