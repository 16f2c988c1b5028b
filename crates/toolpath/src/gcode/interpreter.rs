//! Interpreter: state, and order of what a line asks for.
use super::block::Block;
use super::codes::ProgramEnd;
use super::frames::WorkFrames;
use super::height::Height;
use super::modal::Modal;
use super::pins::NO_MOTION;
use super::refusal::{GcodeRefusal, RefusalKind, refusal};
use super::run::LineRun;
use super::setup::{FixedSetup, GcodeSetup};
use super::state::{GcodeState, ProgramFacts};
use super::text::{LineKind, plain};
use super::words;
use crate::{Element, ToolPlace, short};

/// Interpreter of G-code, line by line.
#[derive(Clone, Debug)]
pub struct Interpreter {
    fixed: FixedSetup,
    state: GcodeState,
    /// Words of the line under way. Kept between lines for its memory alone.
    scratch: String,
    /// Comment of the line before, if it stands there alone.
    note: Option<String>,
}

/// Demands of a line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LineWork {
    /// Elements of the path, in their order.
    pub elements: Vec<Element>,
    /// End of the program.
    pub end: Option<ProgramEnd>,
    /// Text of a `(MSG, ...)` comment.
    pub message: Option<String>,
    /// Tool for which the program waits, with its comment.
    pub tool_change: Option<String>,
}

impl Interpreter {
    /// Interpreter at the start of a program.
    pub fn new(setup: GcodeSetup) -> Self {
        let GcodeSetup {
            start,
            origins,
            full_power,
            home,
            z,
            outputs,
            inputs,
        } = setup;
        let frames = WorkFrames {
            origins,
            shift: ToolPlace::default(),
        };
        let state = GcodeState {
            modal: Modal::default(),
            frames,
            place: start,
            begun: false,
            waiting: None,
            height: Height::default(),
            program: ProgramFacts::default(),
            ended: None,
            mounted: None,
        };
        Self {
            fixed: FixedSetup {
                full_power,
                home,
                z,
                outputs,
                inputs,
            },
            state,
            scratch: String::new(),
            note: None,
        }
    }

    /// Interprets one line, without its end. `number` counts lines from 1 and comes back in elements and refusals.
    ///
    /// # Errors
    ///
    /// Refuses a line with anything that is not supported, see the module's table. A refused line changes nothing.
    pub fn line(&mut self, number: u32, text: &str) -> Result<LineWork, GcodeRefusal> {
        // The text leaves the interpreter while its words are borrowed.
        let mut scratch = std::mem::take(&mut self.scratch);
        let work = self.line_with(number, text, &mut scratch);
        self.scratch = scratch;
        work
    }

    /// Place of the path in the fixed frame.
    pub fn place(&self) -> ToolPlace {
        self.state.place
    }

    /// Sets the place of the path in the fixed frame, after the machine moved by other means or a path was broken off.
    pub fn set_place(&mut self, at: ToolPlace) {
        self.state.place = at;
    }

    /// Modal state.
    pub fn modal(&self) -> &Modal {
        &self.state.modal
    }

    /// Zero point in the fixed frame of G54 (index 0) to G59 (5). Beyond: that of G59.
    pub fn origin(&self, index: usize) -> ToolPlace {
        self.state.frames.origin(index)
    }

    /// Shift of G92: added to the zero point of every coordinate system.
    pub fn shift(&self) -> ToolPlace {
        self.state.frames.shift
    }

    /// Sets the zero point in the fixed frame of G54 (index 0) to G59 (5). Beyond: no effect.
    pub fn set_origin(&mut self, index: usize, origin: ToolPlace) {
        self.state.frames.set_origin(index, origin);
    }

    /// Brings the modal state back to that of start-up and drops the shift of G92. Place and zero points stay.
    pub fn reset(&mut self) {
        self.state.modal = Modal::default();
        self.state.frames.shift = ToolPlace::default();
        self.state.begun = false;
        self.state.waiting = None;
        self.state.height = Height::default();
        self.state.program = ProgramFacts::default();
        self.state.mounted = None;
    }

    /// Facts about the program that has ended last, or else about the one under way.
    pub fn facts(&self) -> ProgramFacts {
        self.state.ended.unwrap_or(self.state.program)
    }

    /// Refuses the end of a program in which an M62 or M63 waits for a motion: it would have no effect.
    pub(super) fn check_end(&self) -> Result<(), GcodeRefusal> {
        match self.state.waiting {
            Some(line) => Err(refusal(RefusalKind::Unsupported, line, "", NO_MOTION)),
            None => Ok(()),
        }
    }

    /// Coordinates in the active system of a place in the fixed frame.
    pub fn work_place(&self, at: ToolPlace) -> ToolPlace {
        self.state.frames.work(self.state.modal.origin, at)
    }

    fn line_with(
        &mut self,
        number: u32,
        text: &str,
        scratch: &mut String,
    ) -> Result<LineWork, GcodeRefusal> {
        let line = plain(number, text, scratch)?;
        let mut work = LineWork {
            message: line.message,
            ..LineWork::default()
        };
        match line.kind {
            LineKind::Deleted => {}
            LineKind::Percent => {
                // The first one opens a program, the next one closes it.
                if self.state.begun {
                    self.check_end()?;
                    self.state.begun = false;
                    work.end = Some(ProgramEnd::Percent);
                }
            }
            LineKind::Words => {
                let block = words::read(number, text, scratch)?;
                if block.is_empty() {
                    self.note = line.comment.map(str::to_owned).or(self.note.take());
                } else {
                    let tool = self.block(&block, &mut work)?;
                    let comment = line.comment.or(self.note.as_deref());
                    let comment =
                        comment.map_or(String::new(), |text| format!(" ({})", short(text)));
                    work.tool_change = tool.map(|tool| format!("change to tool {tool}{comment}"));
                    self.note = None;
                }
            }
        }
        Ok(work)
    }

    /// Runs a block on a copy of the state, which stays only if the whole block holds. Returns the number of a tool for which the program
    /// waits.
    fn block(
        &mut self,
        block: &Block<'_>,
        work: &mut LineWork,
    ) -> Result<Option<u32>, GcodeRefusal> {
        let mut run = LineRun::new(block, self.fixed, self.state.clone());
        run.block()?;
        let awaited = run.awaited;
        (self.state, work.elements, work.end) = run.done();
        Ok(awaited)
    }
}
