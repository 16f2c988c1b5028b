//! Takes the records of a run as they come: table, traces for the figures, peaks, progress. It has
//! a thread of its own, so that a slow disk does not delay a tick.

use super::peaks::Peaks;
use super::progress::Progress;
use crate::failure::Failure;
use crate::figures::Traces;
use crate::record::{Record, TICK_COLUMNS};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::mpsc::Receiver;

/// A file of a run that is being written.
pub(super) struct Recorder {
    path: PathBuf,
    table: BufWriter<File>,
    traces: Traces,
    peaks: Option<Peaks>,
    rows: u64,
    line: String,
}

/// What the recorder holds when the run is over.
pub(super) struct Recorded {
    pub(super) path: PathBuf,
    pub(super) rows: u64,
    pub(super) traces: Traces,
    /// None if there was no record.
    pub(super) peaks: Option<Peaks>,
}

impl Recorder {
    /// Begins `ticks.csv` in `folder` for a job of `ticks` records.
    pub(super) fn create(folder: &Path, ticks: u64) -> Result<Self, Failure> {
        let path = folder.join("ticks.csv");
        let file = File::create(&path).map_err(|error| unwritable(&path, &error))?;
        let mut table = BufWriter::new(file);
        writeln!(table, "{}", TICK_COLUMNS.join(",")).map_err(|error| unwritable(&path, &error))?;
        Ok(Self {
            path,
            table,
            traces: Traces::new(ticks),
            peaks: None,
            rows: 0,
            line: String::new(),
        })
    }

    /// Takes every record until the sender is gone. After an error no more are taken, which the
    /// sender notices.
    pub(super) fn record_all(
        mut self,
        records: &Receiver<Record>,
        mut progress: Progress,
    ) -> Result<Recorded, Failure> {
        for record in records {
            self.record(&record)?;
            progress.update(self.rows, record.t);
        }
        progress.finish();
        self.table
            .flush()
            .map_err(|error| unwritable(&self.path, &error))?;
        let Self {
            path,
            rows,
            traces,
            peaks,
            ..
        } = self;
        Ok(Recorded {
            path,
            rows,
            traces,
            peaks,
        })
    }

    fn record(&mut self, record: &Record) -> Result<(), Failure> {
        use std::fmt::Write as _;
        self.line.clear();
        for (column, value) in record.tick_row().iter().enumerate() {
            let comma = if column > 0 { "," } else { "" };
            // Writing to a String does not fail. See `record::number` for the form.
            let _ = write!(self.line, "{comma}{value:?}");
        }
        self.line.push('\n');
        self.table
            .write_all(self.line.as_bytes())
            .map_err(|error| unwritable(&self.path, &error))?;
        self.traces.push(record);
        match &mut self.peaks {
            Some(peaks) => peaks.merge(record),
            none => *none = Some(Peaks::new(record)),
        }
        self.rows += 1;
        Ok(())
    }
}

/// `path: cannot be written: why`.
pub(super) fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::Failed(format!("{}: cannot be written: {error}", path.display()))
}
