//! CSV: bytes cut into chunks of whole records, and results as lines.

use super::rows::{Chunk, Evaluated, reader};
use super::{Sink, Source, TableError};
use csv::ByteRecord;
use std::io::{Read, Write};
use trirrr_scene::record::RESULT_COLUMNS;

/// Bytes of a chunk.
pub(super) const CHUNK: usize = 1 << 18;

/// Chunks of a CSV file.
pub(super) struct CsvSource<R> {
    input: R,
    /// Bytes of a chunk. A longer record makes its chunk longer.
    chunk: usize,
    /// Bytes that were read and not yet handed out, from a record's start on.
    pending: Vec<u8>,
    has_ended: bool,
}

impl<R: Read> CsvSource<R> {
    pub(super) fn new(input: R, chunk: usize) -> Self {
        Self {
            input,
            chunk,
            pending: Vec::new(),
            has_ended: false,
        }
    }

    /// Takes the header off the table.
    pub(super) fn header(&mut self) -> Result<ByteRecord, TableError> {
        while let Some(mut chunk) = self.chunk()? {
            let mut header = ByteRecord::new();
            let mut reader = reader(&chunk);
            if !matches!(reader.read_byte_record(&mut header), Ok(true)) {
                continue;
            }
            let end = reader.position().byte() as usize;
            // As other chunks, what is left begins with the end of the line before it.
            chunk.drain(..end - usize::from(end < chunk.len()));
            chunk.append(&mut self.pending);
            self.pending = chunk;
            return Ok(header);
        }
        Err(TableError::Empty)
    }

    /// Reads whole records.
    fn chunk(&mut self) -> Result<Option<Vec<u8>>, TableError> {
        loop {
            // Doubled, a record of any length is looked through few times.
            let more = self.chunk.max(self.pending.len()) as u64;
            if !self.has_ended {
                let read = self
                    .input
                    .by_ref()
                    .take(more)
                    .read_to_end(&mut self.pending);
                let read = read.map_err(|error| TableError::Unreadable(error.to_string()))?;
                self.has_ended = (read as u64) < more;
            }
            if self.has_ended {
                let rest = std::mem::take(&mut self.pending);
                return Ok(Some(rest).filter(|rest| !rest.is_empty()));
            }
            // At 0 stands the end of the record before.
            if let Some(end) = last_record_end(&self.pending).filter(|end| *end > 0) {
                let rest = self.pending.split_off(end);
                return Ok(Some(std::mem::replace(&mut self.pending, rest)));
            }
        }
    }
}

impl<R: Read> Source for CsvSource<R> {
    fn chunks(&mut self, count: usize) -> Result<Vec<Chunk>, TableError> {
        let mut chunks = Vec::with_capacity(count);
        while chunks.len() < count {
            match self.chunk()? {
                Some(chunk) => chunks.push(Chunk::Csv(chunk)),
                None => break,
            }
        }
        Ok(chunks)
    }
}

/// Place of the last line end of `bytes` that is not within quotes. `bytes` begin where a record does.
fn last_record_end(bytes: &[u8]) -> Option<usize> {
    #[derive(PartialEq)]
    enum Within {
        Start,
        Field,
        Quotes,
        /// The quote before may close the field, or be the first of a pair.
        AfterQuote,
    }
    if memchr::memchr(b'"', bytes).is_none() {
        return memchr::memrchr2(b'\n', b'\r', bytes);
    }
    // The mark at the start of a file belongs to no field.
    let mark = match bytes.starts_with(b"\xef\xbb\xbf") {
        true => 3,
        false => 0,
    };
    let (mut within, mut end) = (Within::Start, None);
    for (place, byte) in bytes.iter().enumerate().skip(mark) {
        within = match (within, byte) {
            (Within::Start | Within::AfterQuote, b'"') => Within::Quotes,
            (Within::Quotes, b'"') => Within::AfterQuote,
            (Within::Quotes, _) => Within::Quotes,
            (_, b',') => Within::Start,
            (_, b'\n' | b'\r') => {
                end = Some(place);
                Within::Start
            }
            _ => Within::Field,
        };
    }
    end
}

/// Results as CSV.
pub(super) struct CsvSink<'a> {
    output: &'a mut dyn Write,
}

impl<'a> CsvSink<'a> {
    /// Writes the header.
    pub(super) fn begin(output: &'a mut dyn Write) -> Result<Self, TableError> {
        writeln!(output, "case,status,{}", RESULT_COLUMNS.join(","))
            .map_err(TableError::Unwritable)?;
        Ok(Self { output })
    }
}

impl Sink for CsvSink<'_> {
    type Part = Vec<u8>;

    fn encode(before: usize, chunk: &Evaluated, binary32: bool) -> Result<Vec<u8>, TableError> {
        Ok(lines(before, chunk, binary32))
    }

    fn write(&mut self, lines: Vec<u8>) -> Result<(), TableError> {
        let written = self.output.write_all(&lines);
        written.map_err(TableError::Unwritable)
    }

    fn finish(self) -> Result<(), TableError> {
        self.output.flush().map_err(TableError::Unwritable)
    }
}

/// Floats have the fewest digits that read back as the same bits.
fn lines(before: usize, chunk: &Evaluated, binary32: bool) -> Vec<u8> {
    const LONGEST_FLOAT: usize = 25;
    let longest = RESULT_COLUMNS.len() * LONGEST_FLOAT;
    let mut lines = Vec::with_capacity(chunk.outcomes.len() * longest);
    let mut digits = zmij::Buffer::new();
    for (row, outcome) in chunk.outcomes.iter().enumerate() {
        match &chunk.labels {
            Some(labels) => push_field(&mut lines, labels.get(row).unwrap_or_default()),
            None => push_field(&mut lines, (before + row + 1).to_string().as_bytes()),
        }
        lines.push(b',');
        match outcome {
            Ok(results) => {
                lines.extend(b"ok");
                for value in results {
                    lines.push(b',');
                    // Exact: the value was widened.
                    lines.extend(match binary32 {
                        true => digits.format(*value as f32).as_bytes(),
                        false => digits.format(*value).as_bytes(),
                    });
                }
            }
            Err(status) => {
                push_field(&mut lines, status.as_bytes());
                lines.extend([b','; RESULT_COLUMNS.len()]);
            }
        }
        lines.push(b'\n');
    }
    lines
}

/// Adds a field, in quotes where it needs them.
fn push_field(line: &mut Vec<u8>, field: &[u8]) {
    if !field.iter().any(|byte| b"\",\n\r".contains(byte)) {
        return line.extend(field);
    }
    line.push(b'"');
    for byte in field {
        if *byte == b'"' {
            line.push(b'"');
        }
        line.push(*byte);
    }
    line.push(b'"');
}

#[cfg(test)]
mod tests {
    use super::*;

    fn records(bytes: &[u8]) -> Vec<ByteRecord> {
        reader(bytes)
            .into_byte_records()
            .map(Result::unwrap)
            .collect()
    }

    /// Random text of what matters to a cut, read whole and in chunks of a few bytes.
    #[test]
    fn chunks_hold_the_records_of_the_whole() {
        const BYTES: &[u8] = b"ab,,\"\"\n\n\r";
        let mut state = 1_u64;
        let mut random = |below: usize| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            (state >> 33) as usize % below
        };
        let mut cut = 0;
        for _ in 0..2000 {
            let length = random(60);
            let text: Vec<u8> = (0..length).map(|_| BYTES[random(BYTES.len())]).collect();
            let mut source = CsvSource::new(text.as_slice(), 1 + random(12));
            let (mut found, mut chunks) = (Vec::new(), 0);
            while let Some(chunk) = source.chunk().unwrap() {
                found.extend(records(&chunk));
                chunks += 1;
            }
            assert_eq!(
                found,
                records(&text),
                "{:?}",
                String::from_utf8_lossy(&text)
            );
            cut += usize::from(chunks > 1);
        }
        assert!(cut > 1000, "{cut}");
    }

    #[test]
    fn the_header_is_the_first_record_and_nothing_else() {
        let text = b"\xef\xbb\xbf\"a\nb\",c\r\n\xef\xbb\xbf1,2\n3,4";
        let mut source = CsvSource::new(text.as_slice(), 4);
        let header = source.header().unwrap();
        assert_eq!(header, ByteRecord::from(vec!["a\nb", "c"]));
        let rest = source
            .chunks(9)
            .unwrap()
            .into_iter()
            .flat_map(|chunk| match chunk {
                Chunk::Csv(bytes) => records(&bytes),
                Chunk::Arrow(_) => Vec::new(),
            });
        // A byte order mark is one at the start of the file only.
        let rows = [["\u{feff}1", "2"], ["3", "4"]].map(|row| ByteRecord::from(row.to_vec()));
        assert_eq!(rest.collect::<Vec<_>>(), rows);
    }

    #[test]
    fn fields_read_back_as_they_were() {
        for field in ["", "a b", "a,b", "\"a\"", "a\nb", "\r", "\u{fc}"] {
            let mut line = b"x,".to_vec();
            push_field(&mut line, field.as_bytes());
            assert_eq!(records(&line), [ByteRecord::from(vec!["x", field])]);
        }
    }
}
