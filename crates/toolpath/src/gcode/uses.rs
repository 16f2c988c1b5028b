//! Words and the codes of the block that use them.
use super::block::ValueWord;
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
        if !arc {
            for letter in *b"IJR" {
                refuse(
                    self.block.value(letter),
                    "the word needs G2 or G3 in the line or before it",
                )?;
            }
        }
        // Some programs write the third distance of the centre, which is 0 in the plane.
        let is_in_plane = |word: &ValueWord<'_>| !(arc && word.value == 0.0);
        refuse(
            self.block.value(b'K').filter(is_in_plane),
            "the centre of an arc lies in the plane: I and J alone",
        )?;
        if self.once != Some(OnceCode::SetOrigin) && self.input.is_none() {
            refuse(
                self.block.value(b'L'),
                "the word needs G10 or M66 in its line",
            )?;
        }
        if self.input.is_none() {
            // No other code has such a letter.
            let reason = "the word needs M66 in its line; with G64 give P alone";
            if let Some(word) = self.block.value(b'Q') {
                return Err(self
                    .block
                    .refuse(RefusalKind::Unsupported, word.text, reason));
            }
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
