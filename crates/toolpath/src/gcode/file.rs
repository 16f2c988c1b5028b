//! Elements of a file, read as they are asked for.
use super::dialect::{ForeignDialect, LOOKED_AT, told_by};
use super::interpreter::Interpreter;
use super::lines::FileLines;
use super::setup::{GcodeSetup, ZWords};
use super::state::ProgramFacts;
use crate::{Element, PathFault, PathRemark, short};
use std::io::BufRead;

/// Elements of a G-code file, in constant memory. Ends at M2, M30, the second `%`, the end of the file, and behind
/// the first refusal.
///
/// # Errors
///
/// An item is a refusal if its line is refused, cannot be read, is no text, or has words of more than 1,000 bytes.
pub fn elements<R: BufRead>(reader: R, setup: GcodeSetup) -> GcodeFile<R> {
    GcodeFile {
        lines: FileLines::new(reader),
        z: setup.z,
        interpreter: Interpreter::new(setup),
        line: 0,
        text: String::new(),
        told: None,
        remarks: Vec::new(),
        waiting: Vec::new().into_iter(),
        ended: false,
    }
}

/// Iterator over the elements of a file. See [`elements`].
#[derive(Debug)]
pub struct GcodeFile<R> {
    lines: FileLines<R>,
    interpreter: Interpreter,
    /// Number of the last line that was read, and the line.
    line: u32,
    text: String,
    /// Another dialect, with the line and the words that have told it.
    told: Option<(ForeignDialect, u32, String)>,
    remarks: Vec<PathRemark>,
    z: ZWords,
    /// Elements of that line that are still to be handed out.
    waiting: std::vec::IntoIter<Element>,
    ended: bool,
}

impl<R> GcodeFile<R> {
    /// Interpreter as it is behind the last line that was read: modes, tolerance of blending, zero points.
    pub fn interpreter(&self) -> &Interpreter {
        &self.interpreter
    }

    /// Facts about the lines that were read, and remarks about them.
    pub fn remarks(&self) -> GcodeRemarks {
        let facts = self.interpreter.facts();
        let mut remarks = self.remarks.clone();
        if let (ZWords::Tool { on_at_m }, 1..) = (self.z, facts.plunges + facts.ramps) {
            let height = (on_at_m * 1e9).round() / 1e6;
            remarks.push(PathRemark::new(
                0,
                format!(
                    "--tool-by-z: {} of Z alone take no time, and {} switch the tool where they cross Z{height}",
                    counted(facts.plunges, "motion"),
                    counted(facts.ramps, "ramp")
                ),
            ));
        }
        GcodeRemarks { facts, remarks }
    }
}

/// Facts about a program and remarks about its lines.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GcodeRemarks {
    /// Facts.
    pub facts: ProgramFacts,
    /// Remarks, in the order of lines.
    pub remarks: Vec<PathRemark>,
}

fn counted(count: u32, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{plural}")
}

impl<R: BufRead> GcodeFile<R> {
    /// Reads a line and interprets it.
    fn advance(&mut self) -> Result<(), PathFault> {
        self.line = self.line.saturating_add(1);
        let read = self.lines.next(&mut self.text);
        if self.line <= LOOKED_AT {
            self.look();
        }
        match read {
            Ok(true) => {}
            Ok(false) => {
                self.ended = true;
                return self.interpreter.check_end().map_err(|found| found.fault);
            }
            Err(fault) => {
                return Err(self.refused(PathFault {
                    line: self.line,
                    word: short(&self.text),
                    reason: fault.reason(),
                }));
            }
        }
        let work = match self.interpreter.line(self.line, &self.text) {
            Ok(work) => work,
            Err(found) => return Err(self.refused(found.fault)),
        };
        self.ended = work.end.is_some();
        self.waiting = work.elements.into_iter();
        if let Some(change) = work.tool_change {
            self.remarks.push(PathRemark::new(self.line, change));
        }
        Ok(())
    }

    /// Looks whether the line tells another dialect. The first one that does counts.
    fn look(&mut self) {
        if self.told.is_none()
            && let Some((dialect, word)) = told_by(&self.text)
        {
            self.told = Some((dialect, self.line, short(word)));
        }
    }

    /// A refusal, with the dialect of the file, where it has another one.
    fn refused(&mut self, mut fault: PathFault) -> PathFault {
        self.look();
        if let Some((ForeignDialect { name, remedy }, line, word)) = &self.told {
            let told = format!("the file is {name}, by {word:?} in line {line}: {remedy}");
            fault.reason = match *line == fault.line {
                true => told,
                false => format!("{}; {told}", fault.reason),
            };
        }
        fault
    }
}

impl<R: BufRead> Iterator for GcodeFile<R> {
    type Item = Result<Element, PathFault>;

    fn next(&mut self) -> Option<Self::Item> {
        loop {
            if let Some(element) = self.waiting.next() {
                return Some(Ok(element));
            }
            if self.ended {
                return None;
            }
            if let Err(fault) = self.advance() {
                self.ended = true;
                return Some(Err(fault));
            }
        }
    }
}

impl<R: BufRead> std::iter::FusedIterator for GcodeFile<R> {}
