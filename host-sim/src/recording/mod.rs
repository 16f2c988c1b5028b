//! Table, figures and peaks of a job, from the records of a run or of a board.

mod drives;
mod lagrange;
mod load;
mod peaks;

pub use drives::{DrivePeaks, DriveRecorder, RecordedDrives};
pub use lagrange::{LagrangeColumns, LagrangeFound};
pub use load::MotorLoad;
pub use peaks::{At, LoadPeaks, MotorPeaks, Peaks, SliderPeaks};

use crate::failure::CliError;
use crate::figures::{DrawnJob, MotorCurves, Traces};
use crate::results::{ResultFolder, unwritable};
use crate::tick_record::AnyTick;
use load::LoadMeter;
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use trirrr_scene::words::tick_time;

/// Writes the records of one job.
pub struct Recorder {
    results: ResultFolder,
    path: PathBuf,
    table: BufWriter<File>,
    /// The scene computes torques.
    torque: bool,
    traces: Traces,
    peaks: Option<Peaks>,
    load: LoadMeter,
    lagrange: Option<LagrangeColumns>,
    rows: u64,
    /// Records from one row of the table to the next.
    every: u64,
    line: String,
}

/// Written job.
#[derive(Clone, Debug)]
pub struct Recorded {
    /// Number of records.
    pub rows: u64,
    /// Extremes of the motion. `None` without a record.
    pub peaks: Option<Peaks>,
    /// Loads of the motors.
    pub loads: Vec<MotorLoad>,
    /// Differences from Lagrange's equations, if they were asked for.
    pub lagrange: Option<LagrangeFound>,
    /// Written files, the table first.
    pub files: Vec<PathBuf>,
    /// Torques and powers for other figures.
    pub motors: MotorCurves,
}

/// Table of the ticks.
const TABLE: &str = "ticks.csv";

impl Recorder {
    /// Names of the files that are written for a `job`.
    pub fn names(job: &DrawnJob) -> Vec<&'static str> {
        let figures = Traces::new(0, job.clone());
        std::iter::once(TABLE).chain(figures.names()).collect()
    }

    /// Prepares `ticks.csv` in the folder of `results` for a `job` of `ticks` records; the first record
    /// begins the results. The columns of `lagrange` come last.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub fn create(
        mut results: ResultFolder,
        ticks: u64,
        job: DrawnJob,
        lagrange: Option<LagrangeColumns>,
    ) -> Result<Self, CliError> {
        results.claim(Self::names(&job))?;
        let (path, file) = results.table(TABLE)?;
        let mut table = BufWriter::new(file);
        let mut columns = job.columns.clone();
        columns.extend(lagrange.iter().flat_map(LagrangeColumns::names));
        writeln!(table, "{}", columns.join(",")).map_err(|error| unwritable(&path, &error))?;
        Ok(Self {
            results,
            path,
            table,
            torque: job.torque,
            traces: Traces::new(ticks, job),
            peaks: None,
            load: LoadMeter::default(),
            lagrange,
            rows: 0,
            every: 1,
            line: String::new(),
        })
    }

    /// Writes the first of so many records into the table; peaks, loads and figures are of all.
    #[must_use]
    pub fn thinned(mut self, every: u32) -> Self {
        self.every = u64::from(every.max(1));
        self
    }

    /// Adds the record of the next tick.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub fn record(&mut self, record: &AnyTick) -> Result<(), CliError> {
        self.results.begin()?;
        if self.rows.is_multiple_of(self.every) {
            let of_lagrange = self.lagrange.as_mut();
            let of_lagrange = of_lagrange.map_or_else(Vec::new, |columns| columns.row(record));
            table_line(
                &mut self.line,
                record.row(self.torque).into_iter().chain(of_lagrange),
            );
            self.table
                .write_all(self.line.as_bytes())
                .map_err(|error| unwritable(&self.path, &error))?;
        }
        self.traces.push(record);
        match &mut self.peaks {
            Some(peaks) => peaks.merge(&Peaks::new(record)),
            none => *none = Some(Peaks::new(record)),
        }
        self.load.push(record);
        self.rows += 1;
        Ok(())
    }

    /// Returns the number of records.
    pub fn rows(&self) -> u64 {
        self.rows
    }

    /// Ends the table and draws the figures; without a record there are no files. `name` begins the
    /// titles. The titles of a job that is not complete say when the job ended.
    ///
    /// Returns the folder too, for the results of others and its [end](ResultFolder::end).
    ///
    /// # Errors
    /// Failed: a file cannot be written.
    pub fn finish(
        mut self,
        name: &str,
        is_complete: bool,
    ) -> Result<(Recorded, ResultFolder), CliError> {
        if !self.results.has_begun() {
            let nothing = Recorded {
                rows: 0,
                peaks: None,
                loads: Vec::new(),
                lagrange: None,
                files: Vec::new(),
                motors: MotorCurves::default(),
            };
            return Ok((nothing, self.results));
        }
        self.table
            .flush()
            .map_err(|error| unwritable(&self.path, &error))?;
        let heading = match self.traces.last_s() {
            Some(last) if !is_complete => format!("{name} until t = {} s", tick_time(last)),
            _ => name.into(),
        };
        let (figures, motors) = self.traces.write(&mut self.results, &heading)?;
        let recorded = Recorded {
            rows: self.rows,
            peaks: self.peaks,
            loads: self.load.loads(),
            lagrange: self.lagrange.map(|columns| columns.found()),
            files: std::iter::once(self.path).chain(figures).collect(),
            motors,
        };
        Ok((recorded, self.results))
    }
}

/// Puts a row of a table into `line`, in place of what was there.
pub(crate) fn table_line(line: &mut String, values: impl Iterator<Item = f64>) {
    use std::fmt::Write as _;
    line.clear();
    for (column, value) in values.enumerate() {
        let comma = if column > 0 { "," } else { "" };
        // Writing to a String does not fail. `Debug` has the fewest digits that read back as the same bits.
        let _ = write!(line, "{comma}{value:?}");
    }
    line.push('\n');
}
