//! FileLines of a file, from its bytes: ends of every kind, text in eight bits or in UTF-16, comments of any length.
use super::text::{LONGEST, TOO_LONG};
use std::io::{self, BufRead};

/// Most bytes of comments that are kept of a line.
const COMMENT_MOST: usize = 200;

/// Most bytes of words that are read of a line, white space with them.
const LONGEST_READ: usize = LONGEST + 100;

/// Byte that ends the text of a file on DOS (Ctrl-Z).
const END_OF_TEXT: u8 = 0x1a;

/// Reader of lines, in constant memory.
#[derive(Debug)]
pub(super) struct FileLines<R> {
    reader: R,
    form: Option<TextForm>,
    /// Bytes of a character of UTF-16 that are still to be handed out, the next one last.
    decoded: Vec<u8>,
    /// Empty lines between the carriage returns of a file without line feeds.
    empty: usize,
}

/// Form of the text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum TextForm {
    EightBit,
    Utf16 { is_big: bool },
}

/// Fault of a line.
#[derive(Debug)]
pub(super) enum LineFault {
    Read(io::Error),
    TooLong,
    /// Bytes that are no text of G-code.
    NoText(String),
}

impl LineFault {
    /// Reason, and what would do.
    pub(super) fn reason(&self) -> String {
        match self {
            Self::Read(error) => format!("the line cannot be read: {error}"),
            Self::TooLong => TOO_LONG.to_owned(),
            Self::NoText(reason) => reason.clone(),
        }
    }
}

/// Place in a line, as comments divide it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum LinePlace {
    Words,
    Parentheses,
    /// Behind a semicolon.
    Rest,
}

impl LinePlace {
    fn behind(self, byte: u8) -> Self {
        match (self, byte) {
            (Self::Words, b'(') => Self::Parentheses,
            (Self::Words, b';') => Self::Rest,
            (Self::Parentheses, b')') => Self::Words,
            (place, _) => place,
        }
    }
}

impl<R: BufRead> FileLines<R> {
    pub(super) fn new(reader: R) -> Self {
        Self {
            reader,
            form: None,
            decoded: Vec::new(),
            empty: 0,
        }
    }

    /// Reads the next line into `text`, which has its beginning after a fault, too. Returns false behind the last line.
    pub(super) fn next(&mut self, text: &mut String) -> Result<bool, LineFault> {
        let mut bytes = std::mem::take(text).into_bytes();
        bytes.clear();
        let read = self.read(&mut bytes);
        let error = match String::from_utf8(bytes) {
            Ok(line) => {
                *text = line;
                return read;
            }
            Err(error) => error,
        };
        // Each byte above 127 is a letter of some eight-bit alphabet: in a comment it does not matter which.
        let bytes = error.into_bytes();
        text.extend(bytes.iter().copied().map(char::from));
        match foreign(&bytes) {
            Some(at) if read.is_ok() => Err(LineFault::NoText(format!(
                "byte 0x{:02X} at column {} is no letter of G-code; save the file as plain text (UTF-8)",
                bytes[at],
                at + 1
            ))),
            _ => read,
        }
    }

    fn read(&mut self, line: &mut Vec<u8>) -> Result<bool, LineFault> {
        if self.empty > 0 {
            self.empty -= 1;
            return Ok(true);
        }
        let (mut place, mut words, mut comments) = (LinePlace::Words, 0, 0);
        let mut is_first = true;
        loop {
            if place == LinePlace::Words {
                let taken = self.take_words(line, LONGEST_READ - words)?;
                words += taken;
                is_first &= taken == 0;
            }
            let Some(byte) = self.byte()? else {
                return Ok(!is_first);
            };
            is_first = false;
            match byte {
                b'\n' => return Ok(true),
                b'\r' => {
                    self.carriage_returns()?;
                    return Ok(true);
                }
                END_OF_TEXT => {
                    self.behind_end()?;
                    return Ok(!line.is_empty());
                }
                0 => {
                    return Err(LineFault::NoText(
                        "byte 0x00 is no text of G-code; save the file as plain text (UTF-8)"
                            .to_owned(),
                    ));
                }
                _ => {}
            }
            place = place.behind(byte);
            let (count, most) = match place {
                LinePlace::Words => (&mut words, LONGEST_READ),
                _ => (&mut comments, COMMENT_MOST),
            };
            *count += 1;
            match *count > most {
                false => line.push(byte),
                true if place == LinePlace::Words => return Err(LineFault::TooLong),
                // The rest of a long comment is left out, but for what the interpreter refuses.
                true if byte == b'(' && place == LinePlace::Parentheses => line.push(byte),
                true => {}
            }
        }
    }

    /// Takes what the reader has of a line's words in one piece, at most so many bytes of it. Returns their number.
    fn take_words(&mut self, line: &mut Vec<u8>, most: usize) -> Result<usize, LineFault> {
        if self.form != Some(TextForm::EightBit)
            || !self.decoded.is_empty()
            || self.peek()?.is_none()
        {
            return Ok(0);
        }
        let bytes = self.reader.fill_buf().map_err(LineFault::Read)?;
        let is_end = |byte: &u8| matches!(*byte, b'\n' | b'\r' | b'(' | b';' | END_OF_TEXT | 0);
        let taken = bytes
            .iter()
            .position(is_end)
            .unwrap_or(bytes.len())
            .min(most);
        line.extend_from_slice(&bytes[..taken]);
        self.reader.consume(taken);
        Ok(taken)
    }

    /// Next byte of the text.
    fn byte(&mut self) -> Result<Option<u8>, LineFault> {
        let form = match self.form {
            Some(form) => form,
            None => self.find_form()?,
        };
        match form {
            TextForm::EightBit => match self.decoded.pop() {
                Some(byte) => Ok(Some(byte)),
                None => self.raw(),
            },
            TextForm::Utf16 { is_big } => self.byte_of_utf16(is_big),
        }
    }

    fn raw(&mut self) -> Result<Option<u8>, LineFault> {
        let byte = self.peek()?;
        self.reader.consume(usize::from(byte.is_some()));
        Ok(byte)
    }

    fn peek(&mut self) -> Result<Option<u8>, LineFault> {
        loop {
            match self.reader.fill_buf() {
                Ok(bytes) => return Ok(bytes.first().copied()),
                Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                Err(error) => return Err(LineFault::Read(error)),
            }
        }
    }

    /// Form of the text by its mark, which is taken off: editors put it before the first line.
    fn find_form(&mut self) -> Result<TextForm, LineFault> {
        let marks: [(&[u8], TextForm); 3] = [
            (b"\xef\xbb\xbf", TextForm::EightBit),
            (b"\xff\xfe", TextForm::Utf16 { is_big: false }),
            (b"\xfe\xff", TextForm::Utf16 { is_big: true }),
        ];
        let first = self.peek()?;
        let mut form = TextForm::EightBit;
        if let Some((mark, marked)) = marks
            .into_iter()
            .find(|(mark, _)| first == mark.first().copied())
        {
            for byte in mark {
                if self.peek()? != Some(*byte) {
                    return Err(LineFault::NoText(format!(
                        "the file begins with byte 0x{:02X}, and is no text; save it as plain text (UTF-8)",
                        mark[0]
                    )));
                }
                self.raw()?;
            }
            form = marked;
        }
        self.form = Some(form);
        Ok(form)
    }

    fn byte_of_utf16(&mut self, is_big: bool) -> Result<Option<u8>, LineFault> {
        if let Some(byte) = self.decoded.pop() {
            return Ok(Some(byte));
        }
        let Some(first) = self.unit(is_big)? else {
            return Ok(None);
        };
        let mut units = vec![first];
        if (0xd800..0xdc00).contains(&first) {
            units.extend(self.unit(is_big)?);
        }
        let text: String = char::decode_utf16(units)
            .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
            .collect();
        self.decoded = text.into_bytes();
        self.decoded.reverse();
        Ok(self.decoded.pop())
    }

    fn unit(&mut self, is_big: bool) -> Result<Option<u16>, LineFault> {
        // A lone last byte is half of nothing.
        let (Some(first), Some(second)) = (self.raw()?, self.raw()?) else {
            return Ok(None);
        };
        Ok(Some(match is_big {
            true => u16::from_be_bytes([first, second]),
            false => u16::from_le_bytes([first, second]),
        }))
    }

    /// Takes what belongs to the end of a line that begins with a carriage return: any more of them with a line feed are one end, and
    /// without it an end each.
    fn carriage_returns(&mut self) -> Result<(), LineFault> {
        let mut more = 0;
        loop {
            match self.byte()? {
                Some(b'\r') => more += 1,
                Some(b'\n') => return Ok(()),
                other => {
                    self.empty = more;
                    self.put_back(other);
                    return Ok(());
                }
            }
        }
    }

    fn put_back(&mut self, byte: Option<u8>) {
        self.decoded.extend(byte);
    }

    /// Refuses words behind the end of the text.
    fn behind_end(&mut self) -> Result<(), LineFault> {
        while let Some(byte) = self.byte()? {
            if !(byte.is_ascii_whitespace() || byte == 0 || byte == END_OF_TEXT) {
                return Err(LineFault::NoText(
                    "byte 0x1A (Ctrl-Z) ends the text of a file, and more stands behind it; take it out".to_owned(),
                ));
            }
        }
        Ok(())
    }
}

/// First byte above 127 outside of comments.
fn foreign(bytes: &[u8]) -> Option<usize> {
    let mut place = LinePlace::Words;
    bytes.iter().position(|byte| {
        place = place.behind(*byte);
        place == LinePlace::Words && !byte.is_ascii()
    })
}
