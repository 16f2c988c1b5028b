//! Elements of a file, read as they are asked for.
use super::interpreter::Interpreter;
use super::setup::GcodeSetup;
use super::text::LONGEST;
use crate::{Element, PathFault};
use std::io::{BufRead, Read};

/// Elements of a G-code file, in constant memory. Ends at M2, M30, the second `%`, the end of the file, and behind
/// the first refusal.
///
/// # Errors
///
/// An item is a refusal if its line is refused, cannot be read, is no UTF-8 or is longer than 1,000 bytes.
pub fn elements<R: BufRead>(reader: R, setup: GcodeSetup) -> GcodeFile<R> {
    GcodeFile {
        reader,
        interpreter: Interpreter::new(setup),
        line: 0,
        text: Vec::new(),
        waiting: Vec::new().into_iter(),
        ended: false,
    }
}

/// Iterator over the elements of a file. See [`elements`].
#[derive(Debug)]
pub struct GcodeFile<R> {
    reader: R,
    interpreter: Interpreter,
    /// Number of the last line that was read.
    line: u32,
    text: Vec<u8>,
    /// Elements of that line that are still to be handed out.
    waiting: std::vec::IntoIter<Element>,
    ended: bool,
}

impl<R> GcodeFile<R> {
    /// Interpreter as it is behind the last line that was read: modes, tolerance of blending, zero points.
    pub fn interpreter(&self) -> &Interpreter {
        &self.interpreter
    }
}

impl<R: BufRead> GcodeFile<R> {
    /// Reads a line and interprets it.
    fn advance(&mut self) -> Result<(), PathFault> {
        self.text.clear();
        self.line = self.line.saturating_add(1);
        let line = self.line;
        let refuse = |reason: String| PathFault {
            line,
            word: String::new(),
            reason,
        };
        // One byte more than a line, its end of two bytes, and a byte order mark.
        let most = LONGEST as u64 + 6;
        let read = self
            .reader
            .by_ref()
            .take(most)
            .read_until(b'\n', &mut self.text);
        let length = read.map_err(|error| refuse(format!("the line cannot be read: {error}")))?;
        if length == 0 {
            self.ended = true;
            return self.interpreter.check_end().map_err(|found| found.fault);
        }
        let text = match self.text.strip_suffix(b"\n") {
            Some(text) => text,
            None if self.text.len() > LONGEST => {
                return Err(refuse(
                    "the line is longer than 1,000 bytes; break it into several".to_owned(),
                ));
            }
            None => &self.text,
        };
        let text = str::from_utf8(text)
            .map_err(|_| refuse("the line is no UTF-8; is this a G-code file?".to_owned()))?;
        // Editors put a byte order mark before the first line.
        let text = if line == 1 {
            text.trim_start_matches('\u{feff}')
        } else {
            text
        };
        let work = self
            .interpreter
            .line(line, text)
            .map_err(|found| found.fault)?;
        self.ended = work.end.is_some();
        self.waiting = work.elements.into_iter();
        Ok(())
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
