//! Axis words of a block, and the places that they give.
use super::block::ValueWord;
use super::frames::{AXES, axes, place};
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;
use super::setup::ZWords;
use crate::ToolPlace;

/// Farthest coordinate, m and rad. Sums of words in G91 have no bound of their own.
const FARTHEST: f64 = 1e6;

/// Axis words of a block.
pub(super) struct AxisWords<'t> {
    /// X, Y and A.
    pub(super) words: [Option<ValueWord<'t>>; 3],
    /// Z, where it is not refused.
    pub(super) z: Option<ValueWord<'t>>,
    /// True for a Z, too.
    pub(super) any: bool,
}

impl<'t> LineRun<'_, 't> {
    /// Collects the axis words. Refuses Z where the setup has no sense for it.
    pub(super) fn axis_words(&mut self) -> Result<AxisWords<'t>, GcodeRefusal> {
        let z = self.block.value(b'Z');
        if let Some(z) = z {
            if self.fixed.z == ZWords::Refused {
                let reason = "the machine has no Z: with --tool-by-z the tool is on at Z0 and below, with --ignore-z words of Z are left out";
                return Err(self.block.refuse(RefusalKind::Unsupported, z.text, reason));
            }
            self.state.program.has_z = true;
        }
        let words = AXES.map(|letter| self.block.value(letter));
        Ok(AxisWords {
            z,
            any: z.is_some() || words.iter().any(Option::is_some),
            words,
        })
    }

    /// Refuses a code without axis words.
    pub(super) fn need_axes(&self, words: &AxisWords<'t>, code: &str) -> Result<(), GcodeRefusal> {
        if words.any {
            return Ok(());
        }
        Err(self.block.refuse(
            RefusalKind::NoAxes,
            code,
            "the code needs an axis word: X, Y or A",
        ))
    }

    /// Goal in the fixed frame. Axes without a word keep their place.
    pub(super) fn goal(
        &self,
        words: &AxisWords<'t>,
        fixed_frame: bool,
    ) -> Result<ToolPlace, GcodeRefusal> {
        let at = axes(self.state.place);
        let zero = match fixed_frame {
            true => [0.0; 3],
            false => axes(self.state.frames.zero(self.state.modal.origin)),
        };
        let incremental = self.state.modal.incremental;
        let goal = self.with_words(words, self.state.place, |axis, value| {
            value + if incremental { at[axis] } else { zero[axis] }
        });
        self.near(goal)
    }

    /// Refuses a motion that is absurdly far away, or not a number.
    pub(super) fn near(&self, goal: ToolPlace) -> Result<ToolPlace, GcodeRefusal> {
        let near = |place| axes(place).iter().all(|value| value.abs() <= FARTHEST);
        if near(goal) && near(self.state.place) {
            return Ok(goal);
        }
        let reason = "the motion is beyond 1,000 km; check the place and the zero points that the machine reports";
        Err(self.block.refuse(RefusalKind::TooLarge, "", reason))
    }

    /// Place with the named axes replaced. `replace` gets the axis and the word in metres or radians.
    pub(super) fn with_words(
        &self,
        words: &AxisWords<'t>,
        old: ToolPlace,
        replace: impl Fn(usize, f64) -> f64,
    ) -> ToolPlace {
        let mut new = axes(old);
        for (axis, (new, word)) in new.iter_mut().zip(&words.words).enumerate() {
            if let Some(word) = word {
                let value = match AXES[axis] {
                    b'A' => word.value.to_radians(),
                    _ => self.state.modal.unit.to_metres(word.value),
                };
                *new = replace(axis, value);
            }
        }
        place(new)
    }
}
