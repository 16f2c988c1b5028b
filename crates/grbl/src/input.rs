//! Bytes of the sender: real-time bytes, and lines.

use std::collections::VecDeque;

/// Bytes of GRBL's receive buffer, which senders count.
pub(crate) const RECEIVE_BUFFER: usize = 128;

/// Longest line, bytes: more is refused without being kept.
const LONGEST: usize = 1000;

/// Bytes that wait, beyond which no more are wanted. Senders that count never come near.
const MOST: usize = 4 * RECEIVE_BUFFER;

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
    NoText,
}

/// Bytes that came, taken apart.
#[derive(Clone, Debug, Default)]
pub(crate) struct SentBytes {
    line: Vec<u8>,
    is_too_long: bool,
    lines: VecDeque<(SentLine, usize)>,
    /// Bytes of whole lines that wait.
    waiting: usize,
    /// The last byte ended a line by a carriage return.
    after_return: bool,
}

impl SentBytes {
    /// Takes bytes. Real-time commands come back in their order. Returns `None` if the bytes are a request of the web.
    pub(crate) fn take(&mut self, bytes: &[u8], commands: &mut Vec<RealTime>) -> Option<()> {
        for &byte in bytes {
            if let Some(command) = real_time(byte) {
                commands.extend(command);
                if command == Some(RealTime::Reset) {
                    self.clear();
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
                _ if self.line.len() >= LONGEST => self.is_too_long = true,
                _ => self.line.push(byte),
            }
            if byte == b' ' && self.lines.is_empty() && is_web(&self.line) {
                return None;
            }
        }
        Some(())
    }

    /// Returns true if the sender may send on: who counts bytes always may.
    pub(crate) fn wants_more(&self) -> bool {
        self.waiting + self.line.len() < MOST
    }

    /// Bytes of the buffer that are free, as GRBL reports them.
    pub(crate) fn free(&self) -> usize {
        RECEIVE_BUFFER.saturating_sub(self.waiting + self.line.len())
    }

    /// Next whole line.
    pub(crate) fn next(&mut self) -> Option<SentLine> {
        let (line, bytes) = self.lines.pop_front()?;
        self.waiting -= bytes;
        Some(line)
    }

    /// Puts a line back that is to be read again.
    pub(crate) fn put_back(&mut self, line: SentLine) {
        let bytes = match &line {
            SentLine::Text(text) => text.len() + 1,
            SentLine::TooLong | SentLine::NoText => 0,
        };
        self.waiting += bytes;
        self.lines.push_front((line, bytes));
    }

    /// Drops everything.
    pub(crate) fn clear(&mut self) {
        *self = Self::default();
    }

    fn end_line(&mut self) {
        let bytes = self.line.len() + 1;
        let line = match std::mem::take(&mut self.is_too_long) {
            true => SentLine::TooLong,
            false => match String::from_utf8(std::mem::take(&mut self.line)) {
                Ok(text) => SentLine::Text(text),
                Err(_) => SentLine::NoText,
            },
        };
        self.line.clear();
        self.waiting += bytes;
        self.lines.push_back((line, bytes));
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
        let lines = std::iter::from_fn(|| input.next()).collect();
        (lines, commands)
    }

    #[test]
    fn real_time_bytes_stand_anywhere() {
        let (lines, commands) = taken(b"G1 X?1\x910\r\n\n!~F1\n");
        let text = |text: &str| SentLine::Text(text.into());
        assert_eq!(lines, [text("G1 X10"), text(""), text("F1")]);
        let feed = RealTime::Feed(Override::Step(10));
        let all = [RealTime::Status, feed, RealTime::Hold, RealTime::Resume];
        assert_eq!(commands, all);
    }

    #[test]
    fn a_reset_drops_what_waits_and_what_is_too_long_is_not_kept() {
        let (lines, commands) = taken(b"G1 X1\nG1\x18G0\n");
        assert_eq!(lines, [SentLine::Text("G0".into())]);
        assert_eq!(commands, [RealTime::Reset]);
        let long = [vec![b'x'; 10 * LONGEST], b"\nG0\n".to_vec()].concat();
        assert_eq!(
            taken(&long).0,
            [SentLine::TooLong, SentLine::Text("G0".into())]
        );
    }

    #[test]
    fn a_request_of_the_web_is_known() {
        let mut commands = Vec::new();
        assert_eq!(
            SentBytes::default().take(b"POST / HTTP/1.1\r\n", &mut commands),
            None
        );
        assert_eq!(
            SentBytes::default().take(b"G1 X1\n", &mut commands),
            Some(())
        );
    }

    #[test]
    fn free_bytes_are_those_that_no_line_takes() {
        let (mut input, mut commands) = (SentBytes::default(), Vec::new());
        input.take(b"G1 X1\nG0", &mut commands).expect("no web");
        assert_eq!(input.free(), RECEIVE_BUFFER - 8);
        assert_eq!(input.next(), Some(SentLine::Text("G1 X1".into())));
        assert_eq!(input.free(), RECEIVE_BUFFER - 2);
    }
}
