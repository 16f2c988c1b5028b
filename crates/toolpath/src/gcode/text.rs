//! First look at a line: comments, white space, checksum, block delete and `%` are taken off.
use super::refusal::{GcodeRefusal, RefusalKind, refusal};

/// Greatest length of the words of a line, bytes.
pub(super) const LONGEST: usize = 1000;

/// Reason to refuse a longer one.
pub(super) const TOO_LONG: &str =
    "the words of the line are longer than 1,000 bytes; break it into several";

/// Reason to refuse what senders write to a controller.
pub(super) const SENDERS_LINE: &str = "a command of a sender to a GRBL controller, and no G-code: take it out, or let a sender play the file on `trirrr grbl`";

/// Line without what stands beside its words.
#[derive(Debug)]
pub(super) struct PlainLine<'t> {
    /// Sense of the rest.
    pub(super) kind: LineKind,
    /// Text of the last `(MSG, ...)`.
    pub(super) message: Option<String>,
    /// Text of the last comment.
    pub(super) comment: Option<&'t str>,
}

/// Sense of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum LineKind {
    /// Words, or nothing.
    Words,
    /// The line starts with `/`: it is left out.
    Deleted,
    /// `%`, and maybe the name of a program.
    Percent,
}

/// Takes a line apart. Words go to `words`, which is cleared before, without the white space between and in them.
pub(super) fn plain<'t>(
    number: u32,
    text: &'t str,
    words: &mut String,
) -> Result<PlainLine<'t>, GcodeRefusal> {
    words.clear();
    let refuse = |word: &str, reason: &str| refusal(RefusalKind::Letter, number, word, reason);
    let text = text.trim_end_matches('\r');
    let (mut message, mut last) = (None, None);
    let mut checksum = None;
    let mut at = 0;
    while let Some(c) = text.get(at..).and_then(|rest| rest.chars().next()) {
        let rest = &text[at..];
        let mut step = c.len_utf8();
        match c {
            ' ' | '\t' => {}
            ';' => {
                last = Some(&rest[1..]);
                break;
            }
            '(' => {
                let comment = comment(rest).map_err(|reason| refuse(rest, reason))?;
                step = comment.len() + 2;
                last = Some(comment);
                message = self::message(comment).or(message);
            }
            ')' => {
                return Err(refuse(
                    ")",
                    "a comment ends that did not begin; put ( before it",
                ));
            }
            _ if checksum.is_some() => {
                return Err(refuse(
                    rest,
                    "nothing but a comment may follow the checksum",
                ));
            }
            '*' => {
                let digits = leading_digits(rest[1..].trim_start_matches([' ', '\t']));
                check(&text[..at], digits)
                    .map_err(|reason| refuse(&format!("*{digits}"), &reason))?;
                checksum = Some(());
                step = rest.find(digits).map_or(1, |start| start + digits.len());
            }
            // A line has no end in it; the parser would take what follows for another block.
            '\n' | '\r' => {
                return Err(refuse(
                    "",
                    "the line has a line break in it; send line by line",
                ));
            }
            _ => words.push(c),
        }
        at += step;
    }
    if words.len() > LONGEST {
        return Err(refusal(RefusalKind::TooLong, number, words, TOO_LONG));
    }
    let kind = kind(words, text).map_err(|reason| refuse(words, reason))?;
    Ok(PlainLine {
        kind,
        message,
        comment: last.map(str::trim).filter(|text| !text.is_empty()),
    })
}

fn kind(words: &str, text: &str) -> Result<LineKind, &'static str> {
    if words.starts_with(['$', '?', '!', '~']) {
        Err(SENDERS_LINE)
    } else if words.starts_with('%') {
        // A name may follow, and no words: they would be left out.
        match text.split_whitespace().any(is_word) {
            true => Err("no words stand behind % in its line"),
            false => Ok(LineKind::Percent),
        }
    } else if words.contains('%') {
        Err("% stands first in its line")
    } else if words.starts_with('/') {
        Ok(LineKind::Deleted)
    } else {
        Ok(LineKind::Words)
    }
}

/// Returns true for a word of G-code, and for several side by side; not for the name of a program.
fn is_word(text: &str) -> bool {
    let text = text.trim_start_matches('%');
    let mut letters = text.chars();
    let is_first = letters
        .next()
        .is_some_and(|letter| "GMXYZAFST".contains(letter.to_ascii_uppercase()));
    is_first
        && letters
            .next()
            .is_some_and(|next| "0123456789.+-".contains(next))
}

/// Inside of the comment that `text` begins with.
fn comment(text: &str) -> Result<&str, &'static str> {
    let inside = &text[1..];
    let end = inside
        .find(')')
        .ok_or("the comment does not end; put ) behind it")?;
    let inside = &inside[..end];
    if inside.contains('(') {
        return Err("there is a ( in a comment; comments cannot be nested");
    }
    Ok(inside)
}

/// Text of a `MSG,` comment.
fn message(comment: &str) -> Option<String> {
    let (head, text) = comment.split_once(',')?;
    head.trim()
        .eq_ignore_ascii_case("msg")
        .then(|| text.trim().to_owned())
}

fn leading_digits(text: &str) -> &str {
    let end = text
        .find(|c: char| !c.is_ascii_digit())
        .unwrap_or(text.len());
    &text[..end]
}

/// Checks the exclusive or of all bytes before the `*`.
fn check(before: &str, digits: &str) -> Result<(), String> {
    let sum = before.bytes().fold(0, |sum, byte| sum ^ byte);
    match digits.parse::<u8>() {
        Ok(given) if given == sum => Ok(()),
        Ok(_) => Err(format!(
            "the checksum of the line is {sum}; the line is damaged, send it again"
        )),
        Err(_) => Err("a checksum is a whole number from 0 to 255".to_owned()),
    }
}
