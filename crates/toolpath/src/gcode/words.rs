//! Words of a line. The kept parser `gcode` splits the line; here each character is accounted for.
//!
//! The parser goes on after what it does not understand. So every call of the parser must begin where the last one
//! ended: a gap is refused. Values are read again from the text, because the parser has 32-bit floats.
use super::block::{Block, GREATEST};
use super::refusal::{GcodeRefusal, RefusalKind, refusal};
use super::text::SENDERS_LINE;
use gcode::core::{
    self as parser, BlockVisitor, CommandVisitor, ControlFlow, Diagnostics, Number, ProgramVisitor,
    Span, TokenType, Value,
};

/// Most digits of a code number. The parser multiplies the number by ten in 32 bits.
const MOST_DIGITS: usize = 6;

/// Greatest line number. Figure of GRBL.
const GREATEST_LINE: u64 = 10_000_000;

/// Reads the words of a `line`, whose `text` has no white space and no comments.
pub(super) fn read<'a>(number: u32, line: &str, text: &'a str) -> Result<Block<'a>, GcodeRefusal> {
    check_exponents(number, line)?;
    check_decimal_signs(number, text)?;
    let text = behind_line_number(number, text)?;
    // The number of a program names it, and does no more.
    if let Some(digits) = text.strip_prefix(['O', 'o', ':'])
        && !digits.is_empty()
        && digits.bytes().all(|byte| byte.is_ascii_digit())
    {
        return Ok(Block::new(number));
    }
    check_code_numbers(number, text)?;
    let mut words = Words {
        text,
        at: 0,
        block: Block::new(number),
        fault: None,
    };
    parser::parse(text, &mut words);
    if words.at < text.len() {
        words.refuse_gap(text.len());
    }
    match words.fault {
        Some(fault) => Err(fault),
        None => Ok(words.block),
    }
}

/// Refuses numbers of G, M and T that would overflow in the parser.
fn check_code_numbers(number: u32, text: &str) -> Result<(), GcodeRefusal> {
    for (at, _) in text.match_indices(is_code) {
        let word = word_at(text, at);
        if word[1..].starts_with('-') && !text[at..].starts_with(['G', 'g', 'M', 'm']) {
            let reason = "the number of a tool is not negative";
            return Err(refusal(RefusalKind::Negative, number, word, reason));
        }
        if word.len() > MOST_DIGITS + 1 {
            return Err(refusal(
                RefusalKind::Unsupported,
                number,
                word,
                "the number of a code is too long",
            ));
        }
    }
    Ok(())
}

/// Text behind the line number that it begins with, if it has one. Refuses a number that is negative, or greater than GRBL's.
fn behind_line_number(number: u32, text: &str) -> Result<&str, GcodeRefusal> {
    let Some(digits) = text.strip_prefix(['N', 'n']) else {
        return Ok(text);
    };
    let word = word_at(text, 0);
    if digits.starts_with('-') {
        let reason = "a line number is not negative";
        return Err(refusal(RefusalKind::Negative, number, word, reason));
    }
    let length = |text: &str| text.bytes().take_while(u8::is_ascii_digit).count();
    let (whole, rest) = digits.split_at(length(digits));
    match whole.parse::<u64>() {
        Ok(value) if value <= GREATEST_LINE => {}
        // The parser refuses it.
        Err(_) if whole.is_empty() => return Ok(text),
        _ => {
            let reason = "a line number is 10,000,000 at most";
            return Err(refusal(RefusalKind::LineNumber, number, word, reason));
        }
    }
    Ok(match rest.strip_prefix('.') {
        Some(fraction) => &fraction[length(fraction)..],
        None => rest,
    })
}

/// Refuses numbers with an exponent, as other programs write them. White space tells them from a word E.
fn check_exponents(number: u32, line: &str) -> Result<(), GcodeRefusal> {
    let mut in_comment = false;
    for (at, c) in line.char_indices() {
        match c {
            ';' => break,
            '(' | ')' => in_comment = c == '(',
            'e' | 'E' if !in_comment => {
                if let Some((word, digits)) = with_exponent(line, at) {
                    let reason = match digits.parse::<f64>() {
                        Ok(value) if value.abs() <= GREATEST => {
                            format!("numbers have no exponent; write {}{value}", &word[..1])
                        }
                        Ok(_) => {
                            "numbers have no exponent, and this one is beyond 1,000,000".into()
                        }
                        Err(_) => "this is not a number".into(),
                    };
                    return Err(refusal(RefusalKind::Unsupported, number, word, &reason));
                }
            }
            _ => {}
        }
    }
    Ok(())
}

/// Returns the word whose number has the exponent at `at`, and the number.
fn with_exponent(line: &str, at: usize) -> Option<(&str, &str)> {
    let before = line[..at].trim_end_matches(|c: char| c.is_ascii_digit() || "+-.".contains(c));
    let exponent = line[at + 1..].trim_start_matches(['+', '-']);
    let signs = line.len() - at - 1 - exponent.len();
    let digits = exponent.len()
        - exponent
            .trim_start_matches(|c: char| c.is_ascii_digit())
            .len();
    let letter = before
        .strip_suffix(|c: char| c.is_ascii_alphabetic())?
        .len();
    let word = &line[letter..at + 1 + signs + digits];
    let has_digits = line[letter + 1..at].contains(|c: char| c.is_ascii_digit());
    (has_digits && signs <= 1 && digits > 0).then_some((word, &word[1..]))
}

/// Refuses numbers with a comma, as many languages write them.
fn check_decimal_signs(number: u32, text: &str) -> Result<(), GcodeRefusal> {
    let Some(comma) = text.find(',') else {
        return Ok(());
    };
    let in_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | ',' | '+' | '-');
    let start = text[..comma].trim_end_matches(in_number).len();
    let letter = text[..start].char_indices().next_back();
    let Some((start, _)) = letter.filter(|(_, letter)| letter.is_ascii_alphabetic()) else {
        return Ok(());
    };
    let digits = text[start + 1..].split(|c| !in_number(c)).next();
    let word = &text[start..=start + digits.unwrap_or_default().len()];
    let (before, after) = word.split_once(',').unwrap_or_default();
    if !before.contains(|c: char| c.is_ascii_digit())
        && !after.contains(|c: char| c.is_ascii_digit())
    {
        return Ok(());
    }
    let reason = match word.contains('.') || after.contains(',') {
        true => {
            "a number has one decimal sign, a point, and nothing between its other digits".into()
        }
        false => format!("the decimal sign is a point, not a comma: {before}.{after}"),
    };
    let kind = match before.contains(|c: char| c.is_ascii_digit()) {
        true => RefusalKind::Letter,
        false => RefusalKind::Number,
    };
    Err(refusal(kind, number, word, &reason))
}

fn is_code(letter: char) -> bool {
    matches!(letter.to_ascii_uppercase(), 'G' | 'M' | 'T')
}

/// Letter at `at` with the digits, points and signs behind it.
fn word_at(text: &str, at: usize) -> &str {
    let rest = text.get(at..).unwrap_or_default();
    let in_number = |c: char| c.is_ascii_digit() || matches!(c, '.' | '+' | '-');
    let letter = rest.chars().next().map_or(0, char::len_utf8);
    let end = rest[letter..]
        .find(|c| !in_number(c))
        .map_or(rest.len(), |end| letter + end);
    &rest[..end]
}

/// Collects what the parser finds, up to the first fault.
struct Words<'a> {
    text: &'a str,
    /// End of what is accounted for.
    at: usize,
    block: Block<'a>,
    fault: Option<GcodeRefusal>,
}

impl<'a> Words<'a> {
    /// Refuses the text from what is accounted for to `end`. The first refusal of a line stays.
    fn refuse(&mut self, kind: RefusalKind, end: usize, reason: &str) {
        if self.fault.is_none() {
            let word = self.text.get(self.at..end).unwrap_or(self.text);
            self.fault = Some(refusal(kind, self.block.number, word, reason));
        }
    }

    /// Accounts for a word that the parser has found at `start`.
    fn take(&mut self, start: usize, end: usize) {
        if self.fault.is_some() {
            return;
        }
        if start != self.at {
            return self.refuse_gap(start);
        }
        let word = self.text.get(start..end).unwrap_or_default();
        match self.block.add(word) {
            Ok(()) => self.at = end,
            Err(fault) => self.fault = Some(fault),
        }
    }

    /// Accounts for a code. The parser does not say its place: it follows what is accounted for.
    fn take_code(&mut self, letter: u8) {
        let word = word_at(self.text, self.at);
        if word.as_bytes().first().map(u8::to_ascii_uppercase) == Some(letter) {
            self.take(self.at, self.at + word.len());
        } else {
            self.refuse_gap(self.at + word.len());
        }
    }

    /// Refuses what the parser has left out, up to `end` at most.
    fn refuse_gap(&mut self, end: usize) {
        // The parser reports a code that is no number with a type that has no public name, so not to us.
        let word = word_at(self.text, self.at);
        if word.starts_with(is_code) {
            let kind = match word.len() {
                1 => RefusalKind::Number,
                _ => RefusalKind::NotWhole,
            };
            self.refuse(
                kind,
                self.at + word.len(),
                "codes are whole numbers, or have one digit behind the point",
            );
        } else {
            self.refuse(
                RefusalKind::Letter,
                end.max(self.at),
                "the text is not understood as words of G-code",
            );
        }
    }
}

/// Kind of a line number that does not stand first: a second one, or one that is out of place.
fn line_number_kind(text: &str) -> RefusalKind {
    match text.starts_with(['N', 'n']) {
        true => RefusalKind::Repeated,
        false => RefusalKind::LineNumber,
    }
}

/// View of the collection that the parser holds for a block or a command.
struct Part<'s, 'a>(&'s mut Words<'a>);

impl ProgramVisitor for Words<'_> {
    fn start_block(&mut self) -> ControlFlow<impl BlockVisitor + '_> {
        ControlFlow::Continue(Part(self))
    }
}

impl BlockVisitor for Part<'_, '_> {
    fn line_number(&mut self, _number: u32, span: Span) {
        // That of the line was taken off.
        self.0.refuse(
            line_number_kind(self.0.text),
            span.end(),
            "the line number stands first in its line",
        );
    }

    fn program_number(&mut self, _number: u32, span: Span) {
        self.0.refuse(RefusalKind::Unsupported, span.end(), O_WORD);
    }

    fn program_delimiter(&mut self, span: Span) {
        self.0.refuse(
            RefusalKind::Letter,
            span.end(),
            "% stands alone on its line",
        );
    }

    fn word_address(&mut self, _letter: char, _value: Value<'_>, span: Span) {
        self.0.take(span.start, span.end());
    }

    fn start_general_code(&mut self, _number: Number) -> ControlFlow<impl CommandVisitor + '_> {
        self.0.take_code(b'G');
        ControlFlow::Continue(Part(self.0))
    }

    fn start_miscellaneous_code(
        &mut self,
        _number: Number,
    ) -> ControlFlow<impl CommandVisitor + '_> {
        self.0.take_code(b'M');
        ControlFlow::Continue(Part(self.0))
    }

    fn start_tool_change_code(&mut self, _number: Number) -> ControlFlow<impl CommandVisitor + '_> {
        self.0.take_code(b'T');
        ControlFlow::Continue(Part(self.0))
    }
}

impl CommandVisitor for Part<'_, '_> {
    fn argument(&mut self, _letter: char, _value: Value<'_>, span: Span) {
        self.0.take(span.start, span.end());
    }
}

impl Diagnostics for Words<'_> {
    fn emit_unknown_content(&mut self, text: &str, span: Span) {
        self.refuse(RefusalKind::Letter, span.end(), unknown(text));
    }

    fn emit_unexpected(&mut self, actual: &str, expected: &[TokenType], span: Span) {
        use RefusalKind::{Letter, Number, Unsupported};
        let (kind, reason) = match actual.chars().next() {
            Some('N' | 'n') if self.at > 0 => (
                line_number_kind(self.text),
                "the line number stands first in its line",
            ),
            Some('O' | 'o') => (Unsupported, O_WORD),
            Some('#' | '[' | ']') => (Letter, unknown(actual)),
            Some('/') => (
                Letter,
                "/ deletes a block as the first character of its line; there are no expressions",
            ),
            Some('+' | '-') if expected.contains(&TokenType::Letter) => {
                (Letter, "a sign needs a letter before it")
            }
            Some(c) if c.is_ascii_alphabetic() => match self.text.get(span.end()..) {
                Some(rest) if rest.starts_with(['#', '[']) => (Number, unknown(rest)),
                _ => (Number, "a number must follow the letter"),
            },
            Some(c) if c.is_ascii_digit() && expected.contains(&TokenType::Letter) => {
                (Letter, "a number needs a letter before it")
            }
            _ => match word_at(self.text, self.at).get(1..) {
                // A number, and something behind it.
                Some(rest) if rest.starts_with(|c: char| c.is_ascii_digit()) => {
                    (Letter, "this is not a number")
                }
                _ => (Number, "this is not a number"),
            },
        };
        self.refuse(kind, span.end(), reason);
    }

    fn emit_parse_int_error(&mut self, _: &str, _: std::num::ParseIntError, span: Span) {
        self.refuse(
            RefusalKind::LineNumber,
            span.end(),
            "this is not a line number",
        );
    }
}

impl Diagnostics for Part<'_, '_> {
    fn emit_unknown_content(&mut self, text: &str, span: Span) {
        self.0.emit_unknown_content(text, span);
    }

    fn emit_unexpected(&mut self, actual: &str, expected: &[TokenType], span: Span) {
        self.0.emit_unexpected(actual, expected, span);
    }

    fn emit_parse_int_error(&mut self, value: &str, error: std::num::ParseIntError, span: Span) {
        self.0.emit_parse_int_error(value, error, span);
    }
}

const O_WORD: &str = "O words are not supported but for the number of a program, alone in its line; write subprograms out";

fn unknown(text: &str) -> &'static str {
    match text.chars().next() {
        Some('#') => "parameters are not supported; write the number",
        Some('[' | ']') => "expressions are not supported; write the number",
        Some(',') => {
            "a comma has no meaning in G-code; the decimal sign is a point, and words stand side by side"
        }
        Some('$' | '?' | '!' | '~') => SENDERS_LINE,
        _ => {
            "the character has no meaning in G-code; numbers have digits, a sign and a decimal point"
        }
    }
}
