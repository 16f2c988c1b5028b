//! Arcs of a block: G2 and G3.
use super::arc::{self, ArcFault, ArcPart, Direction};
use super::block::ValueWord;
use super::motion::ToolUse;
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;
use crate::{ToolCurve, ToolMotion, ToolPlace};

/// Most turns of an arc: a line of a file has bounded memory.
const TURNS_MAX: f64 = 1000.0;

/// Arc words of a block with the place in the program that they refer to.
struct ArcWords<'t> {
    goal: ToolPlace,
    direction: Direction,
    whole_turns: f64,
    radius: Option<ValueWord<'t>>,
}

impl<'t> LineRun<'_, 't> {
    /// Arc to the goal, in one motion or a few.
    pub(super) fn arc(
        &mut self,
        goal: ToolPlace,
        direction: Direction,
    ) -> Result<(), GcodeRefusal> {
        let whole_turns = self.whole_turns()?;
        let words = ArcWords {
            goal,
            direction,
            whole_turns,
            radius: self.block.value(b'R'),
        };
        self.need_feed()?;
        let start = self.state.place;
        let parts = self.arc_parts(start, &words)?;
        if parts.is_empty() {
            // All of it lies within the smallest radius.
            return self.line(goal);
        }
        let parts = arc::in_turns(start.position_m, parts);
        let feed = self.feed_of(arc::way(&parts))?;
        let last = parts.len().saturating_sub(1);
        for (
            index,
            ArcPart {
                centre,
                turn,
                to,
                done,
            },
        ) in parts.into_iter().enumerate()
        {
            let alpha_rad = if index == last {
                goal.alpha_rad
            } else {
                start.alpha_rad + done * (goal.alpha_rad - start.alpha_rad)
            };
            let curve = ToolCurve::Arc {
                centre_m: centre,
                turn_rad: turn,
            };
            let to = ToolPlace {
                position_m: to,
                alpha_rad,
            };
            let stops = self.stops() && index == last;
            let motion = ToolMotion {
                curve,
                to,
                feed_m_s: feed,
                stops,
            };
            let done = if index == last { 1.0 } else { done };
            self.go(motion, ToolUse::AtFeed, done)?;
        }
        Ok(())
    }

    /// Turns of an arc beyond the one that it begins (P).
    pub(super) fn whole_turns(&self) -> Result<f64, GcodeRefusal> {
        match self.block.value(b'P') {
            Some(word) if word.value > TURNS_MAX => {
                let reason = format!(
                    "an arc has at most {TURNS_MAX} turns: write several of them, or play the job with --repeat"
                );
                Err(self.block.refuse(RefusalKind::TooLarge, word.text, &reason))
            }
            Some(word) if word.value >= 1.0 && word.value.fract() == 0.0 => Ok(word.value - 1.0),
            Some(word) => Err(self.block.refuse(
                RefusalKind::Unused,
                word.text,
                "P of an arc is a whole number of turns from 1",
            )),
            None => Ok(0.0),
        }
    }

    fn arc_parts(
        &self,
        start: ToolPlace,
        words: &ArcWords<'t>,
    ) -> Result<Vec<ArcPart>, GcodeRefusal> {
        let ArcWords {
            goal,
            direction,
            whole_turns,
            radius,
        } = words;
        let (i, j) = (self.block.value(b'I'), self.block.value(b'J'));
        let unit = self.state.modal.unit;
        let (from, to) = (start.position_m, goal.position_m);
        let parts = match (radius, i.or(j)) {
            (Some(word), Some(_)) => {
                return Err(self.block.refuse(
                    RefusalKind::Unused,
                    word.text,
                    "an arc has R, or I and J, not both",
                ));
            }
            (None, None) => {
                return Err(self.block.refuse(
                    RefusalKind::NoCentre,
                    "",
                    "the arc has no centre; give I and J, or R",
                ));
            }
            (Some(word), None) => arc::with_radius(
                from,
                to,
                unit.to_metres(word.value),
                *direction,
                *whole_turns,
            ),
            (None, Some(word)) => {
                let base = if !self.state.modal.absolute_centres {
                    from
                } else if i.is_some() && j.is_some() {
                    self.state.frames.zero(self.state.modal.origin).position_m
                } else {
                    return Err(self.block.refuse(
                        RefusalKind::NoCentre,
                        word.text,
                        "with G90.1 an arc needs both I and J",
                    ));
                };
                let metres = |word: Option<ValueWord<'_>>| {
                    word.map_or(0.0, |word| unit.to_metres(word.value))
                };
                arc::about(
                    from,
                    to,
                    [base[0] + metres(i), base[1] + metres(j)],
                    *direction,
                    *whole_turns,
                )
            }
        };
        parts.map_err(|fault| {
            let word = radius.or(i).or(j).map_or("", |word| word.text);
            let (kind, reason) = arc_reason(fault);
            self.block.refuse(kind, word, &reason)
        })
    }
}

pub(super) fn arc_reason(fault: ArcFault) -> (RefusalKind, String) {
    let mm = |metres: f64| metres * 1000.0;
    let kind = match fault {
        ArcFault::RadiiDiffer(..) | ArcFault::OnePoint => RefusalKind::ArcTarget,
        ArcFault::TooFar(_) => RefusalKind::ArcRadius,
    };
    let reason = match fault {
        ArcFault::RadiiDiffer(start, end) => format!(
            "the radius is {:.4} mm at the start and {:.4} mm at the end of the arc; they may differ by 0.005 mm or \
             by 0.1 %, and by 0.5 mm at most",
            mm(start),
            mm(end)
        ),
        ArcFault::TooFar(chord) => {
            format!(
                "the end is {:.4} mm from the start, more than two radii; give a greater R",
                mm(chord)
            )
        }
        ArcFault::OnePoint => {
            "the arc ends where it starts; give I and J for a whole circle".to_owned()
        }
    };
    (kind, reason)
}
