//! Words and the codes of the block that use them.
use super::block::{NO_TABLE, ValueWord};
use super::codes::OnceCode;
use super::modal::MotionMode;
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;

impl LineRun<'_, '_> {
    /// Refuses words that no code of the block uses, and those that two would use.
    pub(super) fn check_uses(&self) -> Result<(), GcodeRefusal> {
        let arc = matches!(
            self.state.modal.motion,
            MotionMode::Clockwise | MotionMode::Counterclockwise
        ) && !self.once.is_some_and(OnceCode::takes_axes);
        let refuse = |word: Option<ValueWord<'_>>, reason: &str| match word {
            Some(word) => Err(self.block.refuse(RefusalKind::Unused, word.text, reason)),
            None => Ok(()),
        };
        // The distance of the centre across the plane of an arc has no effect: many programs write all three.
        if !arc {
            for letter in *b"IJKR" {
                refuse(
                    self.block.value(letter),
                    "the word needs G2 or G3 in the line or before it",
                )?;
            }
        }
        if self.once != Some(OnceCode::SetOrigin) && self.input.is_none() {
            refuse(
                self.block.value(b'L'),
                "the word needs G10 or M66 in its line",
            )?;
        }
        if self.input.is_none() {
            // Q of G64 lets LinuxCNC leave out points. Here no point is left out.
            let reason = "the word needs M66 or G64 in its line";
            if let (Some(word), false) = (self.block.value(b'Q'), self.blend) {
                return Err(self
                    .block
                    .refuse(RefusalKind::Unsupported, word.text, reason));
            }
        }
        if let (Some(word), false) = (self.block.value(b'H'), self.length) {
            let kind = RefusalKind::Unsupported;
            return Err(self.block.refuse(kind, word.text, NO_TABLE));
        }
        let dwell_or_origin = matches!(self.once, Some(OnceCode::Dwell | OnceCode::SetOrigin));
        // A dwell under a modal arc has P for itself, unless there is an arc in its line.
        let arc_in_line = arc && (self.named.is_some() || self.has_axes());
        let uses = [
            dwell_or_origin,
            self.blend,
            arc_in_line,
            self.output.is_some(),
            self.input.is_some(),
        ];
        match uses.map(u8::from).iter().sum() {
            0 => refuse(
                self.block.value(b'P'),
                "the word needs G2, G3, G4, G10, G64, M62 to M65 or M66 in its line",
            )?,
            1 => {}
            _ => refuse(
                self.block.value(b'P'),
                "two codes of the line have a P; use a line for each",
            )?,
        }
        Ok(())
    }

    fn has_axes(&self) -> bool {
        b"XYZA"
            .iter()
            .any(|letter| self.block.value(*letter).is_some())
    }
}
