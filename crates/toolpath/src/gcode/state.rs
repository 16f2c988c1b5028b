//! State of a program between two lines.
use super::frames::WorkFrames;
use super::modal::Modal;
use crate::ToolPlace;

/// Everything that a line may change.
#[derive(Clone, Debug)]
pub(super) struct GcodeState {
    pub(super) modal: Modal,
    pub(super) frames: WorkFrames,
    /// Place of the path in the fixed frame.
    pub(super) place: ToolPlace,
    /// Words came since the start or the last end of a program.
    pub(super) begun: bool,
    /// Line of an M62 or M63 that waits for a motion.
    pub(super) waiting: Option<u32>,
}
