//! Bytes of the sender: real-time bytes, and lines.

use std::collections::VecDeque;

/// Bytes of GRBL's receive buffer, which senders count.
pub(crate) const RECEIVE_BUFFER: usize = 128;

/// Longest line, bytes. What a comment has beyond is left out; a line with more is refused without being kept.
const LONGEST: usize = 990;

/// Bytes of whole lines that are kept. Senders that count never come near; all that come are read, for a `!` may be behind them.
pub(crate) const MOST: usize = 4 << 20;

/// Stands for a line that is too long: no line has such a byte.
const TOO_LONG: u8 = 0x80;

/// Methods with which a client of the web begins: none is G-code.
const WEB: [&str; 7] = [
    "GET ", "POST ", "PUT ", "HEAD ", "OPTIONS ", "DELETE ", "CONNECT ",
];

/// Real-time command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum RealTime {
    Status,
    Hold,
    Resume,
    Reset,
    Door,
    JogCancel,
    /// Feed override: a new value, or a step in percent.
    Feed(Override),
    /// Rapid override, percent.
    Rapid(u8),
    /// Override of the tool's power.
    Power(Override),
}

/// Change of an override.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Override {
    Normal,
    Step(i8),
}

/// A line, or one that cannot be used.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum SentLine {
    Text(String),
    TooLong,
}

/// Comment that the line under way is in.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Comment {
    #[default]
    None,
    Brackets,
    ToTheEnd,
}

/// Bytes that came, taken apart.
#[derive(Clone, Debug, Default)]
pub(crate) struct SentBytes {
    line: Vec<u8>,
    comment: Comment,
    is_too_long: bool,
    /// Whole lines that wait, each with a line feed.
    waiting: VecDeque<u8>,
    /// Waiting lines, of the first ones, that a jog cancel has come behind.
    cancelled: usize,
    /// The last byte ended a line by a carriage return.
    after_return: bool,
    /// A whole line has come.
    has_begun: bool,
    /// Lines were dropped, because too many wait.
    is_flooded: bool,
}

impl SentBytes {
    /// Takes bytes. Real-time commands come back in their order. Returns `None` if the bytes are a request of the web.
    pub(crate) fn take(&mut self, bytes: &[u8], commands: &mut Vec<RealTime>) -> Option<()> {
        for &byte in bytes {
            if let Some(command) = real_time(byte) {
                commands.extend(command);
                match command {
                    Some(RealTime::Reset) => self.clear(),
                    Some(RealTime::JogCancel) => self.cancel_jogs(),
                    _ => {}
                }
                continue;
            }
            let after_return = std::mem::take(&mut self.after_return);
            match byte {
                b'\n' if after_return => {}
                b'\n' | b'\r' => {
                    self.after_return = byte == b'\r';
                    self.end_line();
                }
                _ => self.put(byte),
            }
            if byte == b' ' && !self.has_begun && is_web(&self.line) {
                return None;
            }
        }
        Some(())
    }

    /// Bytes of the buffer that are free, as GRBL reports them.
    pub(crate) fn free(&self) -> usize {
        RECEIVE_BUFFER.saturating_sub(self.waiting.len() + self.line.len())
    }

    /// Next whole line; `true`: jogs are cancelled up to here.
    pub(crate) fn next(&mut self) -> Option<(SentLine, bool)> {
        let end = self.waiting.iter().position(|byte| *byte == b'\n')?;
        let mut line: Vec<u8> = self.waiting.drain(..=end).collect();
        line.pop();
        let is_cancelled = self.cancelled > 0;
        self.cancelled = self.cancelled.saturating_sub(1);
        let line = match line.as_slice() {
            [TOO_LONG] => SentLine::TooLong,
            // Bytes beyond ASCII are real-time commands.
            text => SentLine::Text(text.iter().map(|byte| char::from(*byte)).collect()),
        };
        Some((line, is_cancelled))
    }

    /// Puts a line back that is to be read again.
    pub(crate) fn put_back(&mut self, text: &str, is_cancelled: bool) {
        self.cancelled += usize::from(is_cancelled);
        self.waiting.push_front(b'\n');
        text.bytes()
            .rev()
            .for_each(|byte| self.waiting.push_front(byte));
    }

    /// Lets the jogs among the lines that wait go nowhere.
    pub(crate) fn cancel_jogs(&mut self) {
        self.cancelled = self.waiting.iter().filter(|byte| **byte == b'\n').count();
    }

    /// Returns true, once, if lines were dropped because too many wait.
    pub(crate) fn take_flood(&mut self) -> bool {
        std::mem::take(&mut self.is_flooded)
    }

    /// Drops everything.
    pub(crate) fn clear(&mut self) {
        *self = Self {
            has_begun: self.has_begun,
            ..Self::default()
        };
    }

    /// Puts a byte behind the line under way.
    fn put(&mut self, byte: u8) {
        // A comment in a comment is none, and control characters are nothing at all, as in GRBL.
        if byte < b' ' || (byte, self.comment) == (b'(', Comment::Brackets) {
            return;
        }
        self.comment = match (byte, self.comment) {
            (b'(', Comment::None) => Comment::Brackets,
            (b';', Comment::None) => Comment::ToTheEnd,
            (b')', Comment::Brackets) => Comment::None,
            (_, comment) => comment,
        };
        let ends_comment = byte == b')' && self.comment == Comment::None;
        if self.line.len() < LONGEST || (ends_comment && self.line.len() == LONGEST) {
            self.line.push(byte);
        } else {
            self.is_too_long |= self.comment == Comment::None && !byte.is_ascii_whitespace();
        }
    }

    fn end_line(&mut self) {
        self.has_begun = true;
        let mut line = std::mem::take(&mut self.line);
        if std::mem::take(&mut self.comment) == Comment::Brackets {
            line.push(b')');
        }
        if std::mem::take(&mut self.is_too_long) {
            line = vec![TOO_LONG];
        }
        if self.waiting.len() + line.len() >= MOST {
            self.is_flooded = true;
            return;
        }
        self.waiting.extend(line);
        self.waiting.push_back(b'\n');
    }
}
fn is_web(line: &[u8]) -> bool {
    WEB.iter().any(|method| line == method.as_bytes())
}

/// Real-time command of a byte. `Some(None)`: the byte is one, and does nothing here.
fn real_time(byte: u8) -> Option<Option<RealTime>> {
    use Override::{Normal, Step};
    let command = match byte {
        b'?' => RealTime::Status,
        b'!' => RealTime::Hold,
        b'~' => RealTime::Resume,
        0x18 => RealTime::Reset,
        0x84 => RealTime::Door,
        0x85 => RealTime::JogCancel,
        0x90 => RealTime::Feed(Normal),
        0x91 => RealTime::Feed(Step(10)),
        0x92 => RealTime::Feed(Step(-10)),
        0x93 => RealTime::Feed(Step(1)),
        0x94 => RealTime::Feed(Step(-1)),
        0x95 => RealTime::Rapid(100),
        0x96 => RealTime::Rapid(50),
        0x97 => RealTime::Rapid(25),
        0x99 => RealTime::Power(Normal),
        0x9a => RealTime::Power(Step(10)),
        0x9b => RealTime::Power(Step(-10)),
        0x9c => RealTime::Power(Step(1)),
        0x9d => RealTime::Power(Step(-1)),
        // Coolant, stop of a spindle in a hold, and bytes that GRBL ignores.
        0x80..=0xff => return Some(None),
        _ => return None,
    };
    Some(Some(command))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn taken(bytes: &[u8]) -> (Vec<SentLine>, Vec<RealTime>) {
        let (mut input, mut commands) = (SentBytes::default(), Vec::new());
        input.take(bytes, &mut commands).expect("no web");
        let lines = std::iter::from_fn(|| input.next());
        (lines.map(|(line, _)| line).collect(), commands)
    }

    fn text(text: &str) -> SentLine {
        SentLine::Text(text.into())
    }

    #[test]
    fn real_time_bytes_stand_anywhere() {
        let (lines, commands) = taken(b"G1 X?1\x910\r\n\n!~F1\n");
        assert_eq!(lines, [text("G1 X10"), text(""), text("F1")]);
        let feed = RealTime::Feed(Override::Step(10));
        let all = [RealTime::Status, feed, RealTime::Hold, RealTime::Resume];
        assert_eq!(commands, all);
    }

    /// However much comes before, and whatever it is.
    #[test]
    fn real_time_bytes_are_heard_behind_any_number_of_bytes() {
        let (mut input, mut commands) = (SentBytes::default(), Vec::new());
        for byte in [b'(', b'x', b' ', 0, b'\n'] {
            for length in [1, 127, 511, 512, 513, 999, 1000, 1001, 100_000] {
                input.take(&vec![byte; length], &mut commands);
                commands.clear();
                input.take(b"!?\x18", &mut commands);
                let expected = [RealTime::Hold, RealTime::Status, RealTime::Reset];
                assert_eq!(commands, expected, "{length} times {byte}");
            }
        }
        let lines = b"G1 X1.5\n".repeat(MOST / 4);
        input.take(&[&lines[..], b"!"].concat(), &mut commands);
        assert_eq!(commands.last(), Some(&RealTime::Hold));
        assert!(input.take_flood() && input.waiting.len() <= MOST);
    }

    #[test]
    fn a_reset_drops_what_waits_and_what_is_too_long_is_not_kept() {
        let (lines, commands) = taken(b"G1 X1\nG1\x18G0\n");
        assert_eq!(lines, [text("G0")]);
        assert_eq!(commands, [RealTime::Reset]);
        let long = [vec![b'x'; 10 * LONGEST], b"\nG0\n".to_vec()].concat();
        assert_eq!(taken(&long).0, [SentLine::TooLong, text("G0")]);
        // What stands in comments, and white space, does not count.
        let comment = [b"G1(", [b'x'; 2000].as_slice(), b")\nX1\n"].concat();
        let [SentLine::Text(line), last] = &taken(&comment).0[..] else {
            panic!("two lines");
        };
        assert!(line.starts_with("G1(xx") && line.ends_with("xx)") && line.len() <= LONGEST + 1);
        assert_eq!(*last, text("X1"));
        let hidden = [b"(", [b'x'; 2000].as_slice(), b")G1 X1\n"].concat();
        assert_eq!(taken(&hidden).0, [SentLine::TooLong]);
    }

    #[test]
    fn a_jog_cancel_counts_for_the_lines_before_it() {
        let (mut input, mut commands) = (SentBytes::default(), Vec::new());
        input.take(b"$J=X1F1\nG4P0\n\x85$J=X2F1\n", &mut commands);
        let cancelled: Vec<bool> = std::iter::from_fn(|| input.next())
            .map(|each| each.1)
            .collect();
        assert_eq!(cancelled, [true, true, false]);
    }

    #[test]
    fn a_request_of_the_web_is_known() {
        let mut commands = Vec::new();
        let mut take = |bytes: &[u8]| SentBytes::default().take(bytes, &mut commands);
        assert_eq!(take(b"POST / HTTP/1.1\r\n"), None);
        assert_eq!(take(b"G1 X1\n"), Some(()));
    }

    #[test]
    fn free_bytes_are_those_that_no_line_takes() {
        let (mut input, mut commands) = (SentBytes::default(), Vec::new());
        input.take(b"G1 X1\nG0", &mut commands).expect("no web");
        assert_eq!(input.free(), RECEIVE_BUFFER - 8);
        assert_eq!(input.next(), Some((text("G1 X1"), false)));
        assert_eq!(input.free(), RECEIVE_BUFFER - 2);
    }
}
