//! One block, carried out on a copy of the state.
use super::block::Block;
use super::codes::{GeneralCode, MiscCode, NO_LENGTH, OTHER_PLANE, OnceCode, ProgramEnd};
use super::modal::{FeedMode, LaserMode, Modal, MotionMode, PathMode, Plane};
use super::pins::{NO_MOTION, OutputCode};
use super::refusal::{GcodeRefusal, RefusalKind, refusal};
use super::setup::{FixedSetup, ZWords};
use super::state::GcodeState;
use crate::{Act, Element, ToolPlace, ToolWork};

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
    /// G43 does.
    pub(super) length: bool,
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
            length: false,
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
                // A cycle that ends in the line of a motion leaves the motion.
                GeneralCode::Motion(MotionMode::None) if self.named.is_some() => {}
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
                GeneralCode::ToolLength { of_table: true } if fixed.z == ZWords::Refused => {
                    return Err(block.refuse(RefusalKind::Unsupported, word.text, NO_LENGTH));
                }
                GeneralCode::ToolLength { of_table } => self.length = of_table,
                GeneralCode::Compensation => {}
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
