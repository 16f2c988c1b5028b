//! Coordinate systems: G10 and G92.
use super::axis_words::AxisWords;
use super::block::ValueWord;
use super::frames::{axes, each};
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;

impl<'t> LineRun<'_, 't> {
    /// G10: sets the zero point of a system.
    pub(super) fn set_origin(&mut self, words: &AxisWords<'t>) -> Result<(), GcodeRefusal> {
        self.need_axes(words, "G10")?;
        let by_place = match self.block.value(b'L') {
            Some(ValueWord { value: 2.0, .. }) => false,
            Some(ValueWord { value: 20.0, .. }) => true,
            Some(word) => {
                return Err(self.block.refuse(
                    RefusalKind::Unsupported,
                    word.text,
                    "G10 knows L2 and L20",
                ));
            }
            None => {
                return Err(self.block.refuse(
                    RefusalKind::MissingWord,
                    "G10",
                    "the code needs L2 or L20",
                ));
            }
        };
        let index = match self.block.value(b'P') {
            Some(ValueWord { value: 0.0, .. }) => self.state.modal.origin,
            Some(word) => [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]
                .iter()
                .position(|number| *number == word.value)
                .ok_or_else(|| {
                    self.block.refuse(
                        RefusalKind::NoSystem,
                        word.text,
                        "P is 1 to 6 for G54 to G59, or 0 for the active one",
                    )
                })?,
            None => {
                return Err(self.block.refuse(
                    RefusalKind::MissingWord,
                    "G10",
                    "the code needs P1 to P6, or P0 for the active system",
                ));
            }
        };
        let old = self.state.frames.origin(index);
        // L20: the path's place gets these coordinates. The shift of G92 lies between it and the zero point.
        let base = each(self.state.place, self.state.frames.shift, |at, shift| {
            at - shift
        });
        let new = self.with_words(words, old, |axis, value| {
            if by_place {
                axes(base)[axis] - value
            } else {
                value
            }
        });
        self.state.frames.set_origin(index, new);
        if let (Some(z), true) = (words.z, by_place && index == self.state.modal.origin) {
            let z_m = self.state.modal.unit.to_metres(z.value);
            self.state.height.shift_to(z_m);
        }
        Ok(())
    }

    /// G92: the path's place gets these coordinates in the active system, and with it in all others.
    pub(super) fn shift(&mut self, words: &AxisWords<'t>) -> Result<(), GcodeRefusal> {
        self.need_axes(words, "G92")?;
        let origin = self.state.frames.origin(self.state.modal.origin);
        let base = axes(each(self.state.place, origin, |at, origin| at - origin));
        self.state.frames.shift = self.with_words(words, self.state.frames.shift, |axis, value| {
            base[axis] - value
        });
        if let Some(z) = words.z {
            let z_m = self.state.modal.unit.to_metres(z.value);
            self.state.height.shift_to(z_m);
        }
        Ok(())
    }
}
