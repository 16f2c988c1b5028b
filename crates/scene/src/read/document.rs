//! The text of a scene and the list of what was found wrong with it so far.

use crate::error::{Problem, SceneError};
use std::cell::{Cell, RefCell};
use std::ops::Range;

/// Values quoted in a message are cut to this many characters.
const LONGEST_QUOTE: usize = 60;

/// Problems that are told one by one. A file of another kind has as many as lines.
const MOST_PROBLEMS: usize = 100;

/// A place in the file that a message can point at: key, line, and value if there is one.
#[derive(Clone, Debug)]
pub struct Place {
    /// Line in the file, from 1.
    pub line: usize,
    /// Column in the line, in characters from 1.
    pub column: usize,
    /// Path of the key.
    pub key: String,
    /// The value as the file has it, on one line.
    pub value: Option<String>,
}

/// Part of a text, behind the file of the scene.
#[derive(Clone, Debug)]
pub(crate) struct TextPart {
    /// Offset of its begin: that of a line.
    pub(crate) begin: usize,
    /// Name in messages.
    pub(crate) name: String,
    /// It has lines: false for an argument.
    pub(crate) has_lines: bool,
}

/// The text of a scene. Problems are collected, so that one reading reports all of them.
///
/// The text may be put together of parts: the scene, the file of its machine, arguments. Spans and lines count through all
/// of them; a problem names the part and the line in it.
pub struct Document<'t> {
    text: &'t str,
    /// Parts behind the first one, in the order of the text.
    parts: Vec<TextPart>,
    /// Offsets of the line ends: a job of a million moves asks for as many lines.
    line_ends: Vec<usize>,
    /// Keys that stand before the first table, for whoever writes one after it.
    pub(super) top_keys: &'static [&'static str],
    problems: RefCell<Vec<Problem>>,
    /// Problems beyond [`MOST_PROBLEMS`].
    more: Cell<usize>,
}

impl<'t> Document<'t> {
    /// A document of `text`. `top_keys` are the keys that stand before its first table.
    pub fn new(text: &'t str, top_keys: &'static [&'static str]) -> Self {
        let bytes = text.bytes().enumerate();
        let ends = bytes.filter_map(|(offset, byte)| (byte == b'\n').then_some(offset));
        Self {
            text,
            parts: Vec::new(),
            line_ends: ends.collect(),
            top_keys,
            problems: RefCell::default(),
            more: Cell::default(),
        }
    }

    /// The document, of which `parts` stand behind the first part of the text.
    pub(crate) fn with_parts(self, parts: Vec<TextPart>) -> Self {
        Self { parts, ..self }
    }

    /// Line, from 1, of a byte offset.
    pub(super) fn line(&self, offset: usize) -> usize {
        1 + self.line_ends.partition_point(|end| *end < offset)
    }

    /// Column, in characters from 1, of a byte offset.
    pub(super) fn column(&self, offset: usize) -> usize {
        let before = self.line_ends.partition_point(|end| *end < offset);
        let begin = before
            .checked_sub(1)
            .map_or(0, |end| self.line_ends[end] + 1);
        let text = self.text.get(begin..offset).unwrap_or_default();
        1 + text.chars().count()
    }

    /// Line and column of a byte offset.
    pub(super) fn position(&self, offset: usize) -> [usize; 2] {
        [self.line(offset), self.column(offset)]
    }

    /// Returns true if a key on the line has a number with a decimal comma.
    pub(super) fn has_decimal_comma(&self, line: usize) -> bool {
        let text = self.text.lines().nth(line.saturating_sub(1));
        let value = text.and_then(|text| text.split_once('='));
        let parts = value.and_then(|(_, value)| value.trim().split_once(','));
        let is_number = |text: &str| {
            let digits = text.strip_prefix(['-', '+']).unwrap_or(text);
            !digits.is_empty() && digits.bytes().all(|byte| byte.is_ascii_digit())
        };
        parts.is_some_and(|(whole, rest)| {
            is_number(whole) && rest.starts_with(|first: char| first.is_ascii_digit())
        })
    }

    /// The text of a value, on one line.
    pub(super) fn quote(&self, span: Range<usize>) -> String {
        let whole = self.text.get(span).unwrap_or_default();
        let words = whole.split_whitespace().flat_map(|word| [" ", word]);
        // No further than the cut: a list may be as long as the file.
        let mut characters = words.skip(1).flat_map(str::chars);
        let mut quote: String = characters.by_ref().take(LONGEST_QUOTE).collect();
        if characters.next().is_some() {
            quote.push_str("...");
        }
        quote
    }

    /// Adds a problem at `place`.
    pub fn refuse(&self, place: &Place, reason: impl Into<String>) {
        if self.counts_on() {
            return;
        }
        let parts = self.parts.iter().rev();
        let part = parts
            .map(|part| (part, self.line(part.begin)))
            .find(|(_, first)| *first <= place.line);
        let line = match part {
            None => place.line,
            Some((part, first)) if part.has_lines => place.line - first + 1,
            Some(_) => 0,
        };
        self.problems.borrow_mut().push(Problem {
            source: part.map(|(part, _)| part.name.clone()),
            line,
            column: place.column,
            key: place.key.clone(),
            value: place.value.clone(),
            reason: reason.into(),
        });
    }

    /// Counts one problem more, and returns true, if there are so many that no other is told.
    pub(super) fn counts_on(&self) -> bool {
        let is_full = self.problems.borrow().len() >= MOST_PROBLEMS;
        self.more.set(self.more.get() + usize::from(is_full));
        is_full
    }

    /// Returns true if nothing was found wrong so far.
    pub fn is_clean(&self) -> bool {
        self.problems.borrow().is_empty()
    }

    /// The error with everything found so far, in the order of the file. Call it only after a
    /// problem was found.
    pub fn into_error(self, file: &str) -> SceneError {
        let mut problems = self.problems.into_inner();
        problems.sort_by_key(|problem| {
            let names = |part: &TextPart| Some(&part.name) == problem.source.as_ref();
            let part = self.parts.iter().position(names);
            (part.map(|part| part + 1), problem.line)
        });
        // At the place of the last one that is told: a page shows each beside its line.
        if let Some(last) = problems.last().filter(|_| self.more.get() > 0).cloned() {
            problems.push(Problem {
                key: String::new(),
                value: None,
                reason: format!("and {} more like these", self.more.get()),
                ..last
            });
        }
        SceneError::Refused {
            file: file.to_owned(),
            problems,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn problems_beyond_a_hundred_are_counted() {
        let document = Document::new("", &[]);
        let place = Place {
            line: 1,
            column: 1,
            key: "a".into(),
            value: None,
        };
        (0..250).for_each(|_| document.refuse(&place, "unknown key"));
        let error = document.into_error("a.toml").to_string();
        assert_eq!(error.lines().count(), 101);
        assert!(error.ends_with("and 150 more like these"), "{error}");
    }

    #[test]
    fn lines_are_counted_from_one() {
        let document = Document::new("a\nb\n\nc", &[]);
        let lines: Vec<usize> = (0..=8).map(|offset| document.line(offset)).collect();
        assert_eq!(lines, [1, 1, 2, 2, 3, 4, 4, 4, 4]);
    }

    #[test]
    fn columns_are_counted_in_characters_from_one() {
        let document = Document::new("a = 1\n\u{e4} = 2\n", &[]);
        let columns: Vec<usize> = [0, 4, 5, 6, 8, 11, 12, 99]
            .map(|offset| document.column(offset))
            .into();
        assert_eq!(columns, [1, 5, 6, 1, 2, 5, 6, 1]);
    }

    #[test]
    fn a_quote_is_one_short_line_and_never_cuts_a_character() {
        let text = format!("[1,\n  2]{}", "\u{e4}".repeat(200));
        let document = Document::new(&text, &[]);
        assert_eq!(document.quote(0..8), "[1, 2]");
        assert_eq!(document.quote(8..408).chars().count(), LONGEST_QUOTE + 3);
        assert_eq!(
            document.quote(0..9),
            "",
            "a span that is no character boundary"
        );
    }
}
