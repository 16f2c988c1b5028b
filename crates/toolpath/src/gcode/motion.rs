//! Motions of a block.
use super::arc::{self, Direction};
use super::axis_words::AxisWords;
use super::codes::OnceCode;
use super::frames::{axes, place};
use super::modal::{FeedMode, MotionMode, PathMode, Plane};
use super::refusal::{GcodeRefusal, RefusalKind};
use super::run::LineRun;
use super::setup::ZWords;
use crate::{Act, ToolCurve, ToolMotion, ToolPlace};

/// A motion that goes less far, m and rad, is none.
pub(super) const STAND: f64 = 1e-12;
/// Slowest feed, m/s: a millimetre in eleven days.
const SLOWEST_M_S: f64 = 1e-9;

impl<'t> LineRun<'_, 't> {
    /// Motion of the block, if it has axis words or is a whole circle.
    pub(super) fn motion(
        &mut self,
        words: &AxisWords<'t>,
        named: bool,
    ) -> Result<(), GcodeRefusal> {
        let mode = self.state.modal.motion;
        let fixed_frame = self.once == Some(OnceCode::FixedFrame);
        if fixed_frame {
            self.check_fixed_frame()?;
        }
        let direction = match mode {
            MotionMode::Clockwise => Some(Direction::Clockwise),
            MotionMode::Counterclockwise => Some(Direction::Counterclockwise),
            _ => None,
        };
        let moves = words.any || (named && direction.is_some());
        if !moves {
            return match (
                b"IJKR".iter().find_map(|letter| self.block.value(*letter)),
                direction,
            ) {
                (Some(word), Some(_)) => Err(self.block.refuse(
                    RefusalKind::Unused,
                    word.text,
                    "the arc has no end; give X, Y, or G2 or G3",
                )),
                // G0 and G1 alone set the mode.
                _ => Ok(()),
            };
        }
        if let (false, Some(radius)) = (words.any, self.block.value(b'R')) {
            let reason = "an arc with R ends elsewhere; give X, Y, or I and J for a whole circle";
            return Err(self.block.refuse(RefusalKind::NoAxes, radius.text, reason));
        }
        let goal = self.goal(words, fixed_frame)?;
        self.aim_height(words, fixed_frame)?;
        if words.z.is_some() && words.words.iter().all(Option::is_none) && direction.is_none() {
            self.count_plunge();
        }
        match (mode, direction) {
            (MotionMode::Rapid, _) => self.rapid(goal),
            (_, Some(direction)) if self.state.modal.plane != Plane::Xy => {
                self.arc_across(goal, direction)
            }
            (_, Some(direction)) => self.arc(goal, direction),
            (MotionMode::None, _) => Err(self.block.refuse(
                RefusalKind::NoMotionMode,
                "",
                "the axis words have no motion code; give G0, G1, G2 or G3",
            )),
            _ => self.line(goal),
        }
    }

    /// G28: rapids to the intermediate point and home. With axis words, only the axes that are named go home.
    pub(super) fn home(&mut self, words: &AxisWords<'t>) -> Result<(), GcodeRefusal> {
        let Some(home) = self.fixed.home else {
            return Err(self.block.refuse(
                RefusalKind::Unsupported,
                "G28",
                "the setup has no home place; set it, or use G53 G0 with coordinates",
            ));
        };
        if !words.any {
            self.lift();
            return self.rapid(self.near(home)?);
        }
        let between = self.goal(words, false)?;
        if words.z.is_some() {
            self.lift();
        }
        self.rapid(between)?;
        let mut goal = axes(self.state.place);
        for ((goal, word), home) in goal.iter_mut().zip(&words.words).zip(axes(home)) {
            if word.is_some() {
                *goal = home;
            }
        }
        self.rapid(self.near(place(goal))?)
    }

    fn check_fixed_frame(&self) -> Result<(), GcodeRefusal> {
        if !matches!(
            self.state.modal.motion,
            MotionMode::Rapid | MotionMode::Line
        ) {
            return Err(self.block.refuse(
                RefusalKind::FixedFrame,
                "G53",
                "the code needs G0 or G1",
            ));
        }
        if self.state.modal.incremental {
            return Err(self.block.refuse(
                RefusalKind::FixedFrame,
                "G53",
                "the code needs absolute coordinates: G90",
            ));
        }
        Ok(())
    }

    fn rapid(&mut self, goal: ToolPlace) -> Result<(), GcodeRefusal> {
        let stops = self.stops();
        let motion = ToolMotion {
            curve: ToolCurve::Line,
            to: goal,
            feed_m_s: None,
            stops,
        };
        self.go(motion, ToolUse::Off, 1.0)
    }

    pub(super) fn line(&mut self, goal: ToolPlace) -> Result<(), GcodeRefusal> {
        self.line_to(goal, 1.0)
    }

    /// Line at the feed whose end is `done` of the block's way.
    pub(super) fn line_to(&mut self, goal: ToolPlace, done: f64) -> Result<(), GcodeRefusal> {
        let way = distance(self.state.place, goal);
        let feed = self.feed_of(way)?;
        let stops = self.stops();
        let motion = ToolMotion {
            curve: ToolCurve::Line,
            to: goal,
            feed_m_s: feed,
            stops,
        };
        // Only alpha turns: the tool point stands and has no feed.
        if way <= STAND {
            let turn = ToolMotion {
                feed_m_s: None,
                ..motion
            };
            self.go(turn, ToolUse::AtRest, done)
        } else {
            self.go(motion, ToolUse::AtFeed, done)
        }
    }

    /// Feed of a motion of such a length, m/s.
    pub(super) fn feed_of(&self, way_m: f64) -> Result<Option<f64>, GcodeRefusal> {
        self.need_feed()?;
        let feed = match (self.state.modal.feed_mode, self.inverse_time) {
            (FeedMode::InverseTime, Some(_)) if way_m <= STAND => return Ok(None),
            (FeedMode::InverseTime, per_minute) => per_minute.map(|rate| way_m * rate / 60.0),
            (FeedMode::PerMinute, _) => self.state.modal.feed_m_s,
        };
        match feed {
            Some(feed) if feed < SLOWEST_M_S => Err(self.block.refuse(
                RefusalKind::NoFeed,
                self.feed_word(),
                "the feed is below a nanometre per second; give a greater F",
            )),
            feed => Ok(feed),
        }
    }

    /// Refuses a motion at the feed without one.
    pub(super) fn need_feed(&self) -> Result<(), GcodeRefusal> {
        let (feed, reason) = match self.state.modal.feed_mode {
            FeedMode::PerMinute => (
                self.state.modal.feed_m_s,
                "no feed is set; give F before the motion or in it",
            ),
            FeedMode::InverseTime => (
                self.inverse_time,
                "with G93 each motion at the feed needs a positive F in its line",
            ),
        };
        match feed {
            Some(_) => Ok(()),
            None => Err(self.block.refuse(RefusalKind::NoFeed, "", reason)),
        }
    }

    fn feed_word(&self) -> &'t str {
        self.block.value(b'F').map_or("", |word| word.text)
    }

    /// Motions end at rest.
    pub(super) fn stops(&self) -> bool {
        self.state.modal.path != PathMode::Blend
    }

    /// Emits a motion that ends `done` of the block's way. One that goes nowhere is left out, and the path stays at its place to the last
    /// bit.
    pub(super) fn go(
        &mut self,
        motion: ToolMotion,
        tool: ToolUse,
        done: f64,
    ) -> Result<(), GcodeRefusal> {
        let turns = (motion.to.alpha_rad - self.state.place.alpha_rad).abs() > STAND;
        let curved = motion.curve != ToolCurve::Line;
        if !curved && !turns && distance(self.state.place, motion.to) <= STAND {
            return Ok(());
        }
        let start = std::mem::replace(&mut self.state.place, motion.to);
        if let ZWords::Tool { on_at_m } = self.fixed.z {
            self.push_by_height(start, motion, tool, (on_at_m, done));
            return Ok(());
        }
        let work = match tool {
            ToolUse::Off => None,
            ToolUse::AtFeed => self.tool_at_feed(),
            ToolUse::AtRest => self.tool_at_rest(),
        };
        if tool == ToolUse::AtFeed && work.is_some() && self.fixed.z == ZWords::Ignored {
            self.check_lifted()?;
        }
        self.push(work, Act::Motion(motion));
        Ok(())
    }
}

/// Tool in a motion.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum ToolUse {
    Off,
    AtFeed,
    AtRest,
}

pub(super) fn distance(a: ToolPlace, b: ToolPlace) -> f64 {
    arc::distance(a.position_m, b.position_m)
}
