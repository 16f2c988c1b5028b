//! One block, carried out on a copy of the state.
use super::block::{Block, ValueWord};
use super::codes::{GeneralCode, MiscCode, OTHER_PLANE, OnceCode, ProgramEnd};
use super::modal::{FeedMode, LaserMode, Modal, MotionMode, PathMode, Plane};
use super::refusal::{GcodeRefusal, RefusalKind, refusal};
use super::setup::{FixedSetup, ZWords};
use super::state::GcodeState;
use crate::{Act, Element, InputAct, InputChange, OutputAct, ToolPlace, ToolWork};

/// Reason to refuse an output that waits for a motion which does not come.
pub(super) const NO_MOTION: &str =
    "no motion follows with which the output would change; M64 and M65 change it at once";

/// M62 to M65 of a block.
#[derive(Clone, Copy)]
pub(super) struct OutputCode<'t> {
    on: bool,
    with_motion: bool,
    text: &'t str,
}

/// Block under way.
pub(super) struct LineRun<'b, 't> {
    pub(super) block: &'b Block<'t>,
    pub(super) fixed: FixedSetup,
    pub(super) state: GcodeState,
    elements: Vec<Element>,
    pub(super) once: Option<OnceCode>,
    /// Motion that the block itself names.
    pub(super) named: Option<MotionMode>,
    /// Inverse time of the block, 1/min.
    pub(super) inverse_time: Option<f64>,
    /// G64 stands in the block.
    pub(super) blend: bool,
    /// Change of an output.
    pub(super) output: Option<OutputCode<'t>>,
    /// M66, as it was written.
    pub(super) input: Option<&'t str>,
    pause: bool,
    /// M6 stands in the block.
    change: bool,
    /// Number of a tool for which the program waits.
    pub(super) awaited: Option<u32>,
    /// Heights at the start and the end of the block's way, m, and the part of it that is behind.
    pub(super) heights: [f64; 2],
    pub(super) done: f64,
    end: Option<ProgramEnd>,
}

impl<'b, 't> LineRun<'b, 't> {
    pub(super) fn new(block: &'b Block<'t>, fixed: FixedSetup, state: GcodeState) -> Self {
        Self {
            block,
            fixed,
            state,
            elements: Vec::new(),
            once: None,
            named: None,
            inverse_time: None,
            blend: false,
            output: None,
            input: None,
            pause: false,
            change: false,
            awaited: None,
            heights: [f64::INFINITY; 2],
            done: 0.0,
            end: None,
        }
    }

    /// State behind the block, its elements, and the end of the program.
    pub(super) fn done(self) -> (GcodeState, Vec<Element>, Option<ProgramEnd>) {
        (self.state, self.elements, self.end)
    }

    /// Carries the block out: modes, then F, S, T, laser, outputs, inputs, dwell, coordinate systems, motion, and the end.
    pub(super) fn block(&mut self) -> Result<(), GcodeRefusal> {
        self.state.begun = true;
        self.modes()?;
        self.feed()?;
        self.power()?;
        self.tool()?;
        self.change();
        self.tolerance()?;
        self.output()?;
        self.input()?;
        let axes = self.axis_words()?;
        match self.once {
            Some(OnceCode::Dwell) => self.dwell()?,
            Some(OnceCode::SetOrigin) => self.set_origin(&axes)?,
            Some(OnceCode::Home) => self.home(&axes)?,
            Some(OnceCode::Shift) => self.shift(&axes)?,
            Some(OnceCode::ClearShift) => self.state.frames.shift = ToolPlace::default(),
            Some(OnceCode::FixedFrame) | None => {}
        }
        if !self.once.is_some_and(OnceCode::takes_axes) {
            self.motion(&axes, self.named.is_some())?;
        }
        self.check_uses()?;
        if self.pause {
            // The tool is off while the machine waits: a laser that stands burns.
            self.push(None, Act::Pause);
        }
        if self.end.is_some() {
            if let Some(line) = self.state.waiting {
                return Err(refusal(RefusalKind::Unsupported, line, "", NO_MOTION));
            }
            self.end_program();
        }
        Ok(())
    }

    /// Puts an element behind the others of the block.
    pub(super) fn push(&mut self, tool: Option<ToolWork>, act: Act) {
        if let Act::Motion(motion) = &act {
            self.state.waiting = None;
            if motion.feed_m_s.is_some() {
                self.state.mounted.get_or_insert(self.state.modal.tool);
            }
        }
        self.elements.push(Element {
            line: self.block.number,
            tool,
            act,
        });
    }

    /// Work of the tool in a motion at the feed.
    pub(super) fn tool_at_feed(&self) -> Option<ToolWork> {
        let Modal { laser, s, .. } = self.state.modal;
        let power = s / self.fixed.full_power;
        let on = laser != LaserMode::Off && power > 0.0;
        on.then_some(ToolWork {
            power,
            follows_speed: laser == LaserMode::FollowsSpeed,
        })
    }

    /// Work of the tool while the tool point stands: that of M3 between motions at the feed, as GRBL.
    pub(super) fn tool_at_rest(&self) -> Option<ToolWork> {
        if let Some(tool) = self.tool_by_height() {
            return tool;
        }
        let cutting = self.state.modal.motion.at_feed();
        self.tool_at_feed()
            .filter(|tool| cutting && !tool.follows_speed)
    }

    fn modes(&mut self) -> Result<(), GcodeRefusal> {
        let Self {
            state: GcodeState { modal, program, .. },
            block,
            fixed,
            ..
        } = self;
        for word in block.general() {
            match word.code {
                GeneralCode::Once(once) => self.once = Some(once),
                GeneralCode::Motion(motion) => {
                    modal.motion = motion;
                    self.named = Some(motion);
                }
                GeneralCode::Distance { incremental } => modal.incremental = incremental,
                GeneralCode::Centres { absolute } => modal.absolute_centres = absolute,
                GeneralCode::Feed(feed_mode) => {
                    // A number of the other mode has another unit.
                    if modal.feed_mode != feed_mode {
                        modal.feed_m_s = None;
                    }
                    modal.feed_mode = feed_mode;
                }
                GeneralCode::Unit(unit) => modal.unit = unit,
                GeneralCode::Origin(origin) => modal.origin = origin,
                GeneralCode::Path(path) => {
                    modal.path = path;
                    modal.blend_m = None;
                    self.blend = path == PathMode::Blend;
                }
                GeneralCode::Plane(plane) => {
                    if plane != Plane::Xy && fixed.z == ZWords::Refused {
                        let kind = RefusalKind::Unsupported;
                        return Err(block.refuse(kind, word.text, OTHER_PLANE));
                    }
                    modal.plane = plane;
                }
                GeneralCode::Compensation | GeneralCode::ToolLength => {}
            }
        }
        for word in block.miscellaneous() {
            match word.code {
                MiscCode::Pause => self.pause = true,
                MiscCode::End(end) => self.end = Some(end),
                MiscCode::Laser(laser) => {
                    modal.laser = laser;
                    if laser != LaserMode::Off {
                        program.laser.get_or_insert(block.number);
                    }
                }
                MiscCode::ToolChange => self.change = true,
                MiscCode::Coolant => {}
                MiscCode::Input => self.input = Some(word.text),
                MiscCode::Output { on, with_motion } => {
                    self.output = Some(OutputCode {
                        on,
                        with_motion,
                        text: word.text,
                    });
                }
            }
        }
        Ok(())
    }

    fn feed(&mut self) -> Result<(), GcodeRefusal> {
        let Some(word) = self.block.value(b'F') else {
            return Ok(());
        };
        // F0 takes the feed away: the next motion at the feed is refused.
        let feed = (word.value > 0.0).then_some(word.value);
        match self.state.modal.feed_mode {
            FeedMode::InverseTime => self.inverse_time = feed,
            FeedMode::PerMinute => {
                let unit = self.state.modal.unit;
                self.state.modal.feed_m_s = feed.map(|feed| unit.to_metres(feed) / 60.0);
            }
        }
        Ok(())
    }

    fn power(&mut self) -> Result<(), GcodeRefusal> {
        let Some(word) = self.block.value(b'S') else {
            return Ok(());
        };
        let full = self.fixed.full_power;
        if !(full > 0.0 && full.is_finite()) {
            return Err(self.block.refuse(
                RefusalKind::Unsupported,
                word.text,
                "the setup has no positive full power; set it",
            ));
        }
        self.state.modal.s = word.value.min(full);
        self.state.program.has_s = true;
        self.state.program.has_power |= word.value > 0.0;
        Ok(())
    }

    fn tool(&mut self) -> Result<(), GcodeRefusal> {
        let Some(word) = self.block.value(b'T') else {
            return Ok(());
        };
        if word.value.fract() != 0.0 {
            let reason = "the number of a tool is whole";
            let kind = RefusalKind::Unsupported;
            return Err(self.block.refuse(kind, word.text, reason));
        }
        // Not negative, and at most a million.
        self.state.modal.tool = word.value as u32;
        Ok(())
    }

    /// M6. The first tool is mounted, and T0 is none: the program waits for another one alone.
    fn change(&mut self) {
        let tool = self.state.modal.tool;
        if !self.change || tool == 0 {
            return;
        }
        if self
            .state
            .mounted
            .replace(tool)
            .is_some_and(|mounted| mounted != tool)
        {
            self.awaited = Some(tool);
            self.push(None, Act::Pause);
        }
    }

    /// P of G64.
    fn tolerance(&mut self) -> Result<(), GcodeRefusal> {
        if !self.blend {
            return Ok(());
        }
        if let Some(word) = self.block.value(b'P') {
            self.state.modal.blend_m = Some(self.state.modal.unit.to_metres(word.value));
        }
        Ok(())
    }

    /// M62 to M65.
    fn output(&mut self) -> Result<(), GcodeRefusal> {
        let Some(OutputCode {
            on,
            with_motion,
            text,
        }) = self.output
        else {
            return Ok(());
        };
        let Some(word) = self.block.value(b'P') else {
            let reason = "an output needs P with its number";
            return Err(self.block.refuse(RefusalKind::MissingWord, text, reason));
        };
        let index = self.pin(word, self.fixed.outputs, "output")?;
        if with_motion {
            self.state.waiting = Some(self.block.number);
        }
        // As in a dwell: a gripper must not let go for it.
        let tool = self.tool_at_rest();
        self.push(
            tool,
            Act::Output(OutputAct {
                index,
                on,
                with_motion,
            }),
        );
        Ok(())
    }

    /// M66.
    fn input(&mut self) -> Result<(), GcodeRefusal> {
        let Some(text) = self.input else {
            return Ok(());
        };
        let [number, change, timeout] = [b'P', b'L', b'Q'].map(|letter| self.block.value(letter));
        let missing = |reason| self.block.refuse(RefusalKind::MissingWord, text, reason);
        let number = number.ok_or_else(|| missing("a wait needs P with the number of an input"))?;
        let change = change.ok_or_else(|| {
            missing(
                "a wait needs L: L1 until the input goes on, L2 off, L3 until it is on, L4 is off",
            )
        })?;
        let until = match change.value {
            1.0 => InputChange::Rise,
            2.0 => InputChange::Fall,
            3.0 => InputChange::High,
            4.0 => InputChange::Low,
            0.0 => {
                let reason = "no parameter takes the level of an input; L1 to L4 wait for one";
                return Err(self
                    .block
                    .refuse(RefusalKind::Unsupported, change.text, reason));
            }
            _ => {
                let reason = "the wait ends with L1, the input goes on, L2, off, L3, it is on, or L4, is off";
                return Err(self
                    .block
                    .refuse(RefusalKind::Unsupported, change.text, reason));
            }
        };
        let timeout =
            timeout.ok_or_else(|| missing("a wait needs Q with the seconds that it may last"))?;
        if timeout.value <= 0.0 {
            let reason = "the seconds of a wait are positive";
            return Err(self
                .block
                .refuse(RefusalKind::Unsupported, timeout.text, reason));
        }
        let index = self.pin(number, self.fixed.inputs, "input")?;
        // The tool is off while the machine waits: a laser that stands burns.
        self.push(
            None,
            Act::Input(InputAct {
                index,
                until,
                timeout_s: timeout.value,
            }),
        );
        Ok(())
    }

    /// Number of a spare output or input in a word; `count` is how many there are, `kind` which.
    fn pin(&self, word: ValueWord<'_>, count: u8, kind: &str) -> Result<u8, GcodeRefusal> {
        (0..count)
            .find(|number| f64::from(*number) == word.value)
            .ok_or_else(|| {
                let reason = match count {
                    0 => format!("there are no {kind}s: [[io.{kind}s]] of the scene names them"),
                    _ => format!(
                        "there is no such {kind}; they have the numbers 0 to {}",
                        count - 1
                    ),
                };
                self.block
                    .refuse(RefusalKind::Unsupported, word.text, &reason)
            })
    }

    fn dwell(&mut self) -> Result<(), GcodeRefusal> {
        let Some(word) = self.block.value(b'P') else {
            return Err(self.block.refuse(
                RefusalKind::MissingWord,
                "G4",
                "a dwell needs P with its seconds",
            ));
        };
        if word.value > 0.0 {
            let tool = self.tool_at_rest();
            self.push(
                tool,
                Act::Dwell {
                    seconds: word.value,
                },
            );
        }
        Ok(())
    }

    /// Effects of M2 and M30 on the modal state. Units, feed, blending and the shift of G92 stay.
    fn end_program(&mut self) {
        let Modal {
            unit,
            path,
            blend_m,
            feed_m_s,
            s,
            tool,
            ..
        } = self.state.modal;
        let feed_m_s = feed_m_s.filter(|_| self.state.modal.feed_mode == FeedMode::PerMinute);
        let motion = MotionMode::Line;
        self.state.modal = Modal {
            motion,
            unit,
            path,
            blend_m,
            feed_m_s,
            s,
            tool,
            ..Modal::default()
        };
        self.state.begun = false;
        self.state.ended = Some(std::mem::take(&mut self.state.program));
        self.state.height.end_program();
        self.state.mounted = None;
    }
}
