//! State of a program between two lines.
use super::frames::WorkFrames;
use super::height::Height;
use super::modal::Modal;
use crate::ToolPlace;

/// Facts about a program, up to a line.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ProgramFacts {
    /// First line with M3 or M4.
    pub laser: Option<u32>,
    /// A line has S,
    pub has_s: bool,
    /// and one above 0.
    pub has_power: bool,
    /// A line has Z.
    pub has_z: bool,
    /// Motions of Z alone that switch the tool, where Z is the tool,
    pub plunges: u32,
    /// and motions in the plane on whose way the tool changes.
    pub ramps: u32,
}

/// Everything that a line may change.
#[derive(Clone, Debug)]
pub(super) struct GcodeState {
    pub(super) modal: Modal,
    pub(super) frames: WorkFrames,
    /// Place of the path in the fixed frame.
    pub(super) place: ToolPlace,
    /// Words came since the start or the last end of a program.
    pub(super) begun: bool,
    /// Height of the tool.
    pub(super) height: Height,
    /// Facts about the program under way,
    pub(super) program: ProgramFacts,
    /// and about the one that has ended last.
    pub(super) ended: Option<ProgramFacts>,
    /// Number of the tool that is mounted, once the program has changed it or cuts.
    pub(super) mounted: Option<u32>,
    /// Line of an M62 or M63 that waits for a motion.
    pub(super) waiting: Option<u32>,
}
