//! Table, figures and peaks of the job of a redundant machine.

use super::peaks::RedundantPeaks;
use crate::failure::CliError;
use crate::figures::RedundantTraces;
use crate::recording::table_line;
use crate::recording::{LagrangeColumns, LagrangeFound};
use crate::results::{ResultFolder, unwritable};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use trirrr_linkage::redundant::scene::{RedundantRecord, RedundantScene, columns, row};

/// Writes `ticks.csv` and gathers figures and peaks.
pub(super) struct RedundantRecorder {
    path: PathBuf,
    table: BufWriter<File>,
    traces: RedundantTraces,
    pub(super) peaks: Option<RedundantPeaks>,
    lagrange: Option<LagrangeColumns>,
    every: u64,
    pub(super) rows: u64,
    line: String,
}

impl RedundantRecorder {
    /// Prepares the table in the folder of `results`; one row of `every` ticks.
    pub(super) fn create(
        results: &mut ResultFolder,
        scene: &RedundantScene,
        every: u32,
        lagrange: Option<LagrangeColumns>,
    ) -> Result<Self, CliError> {
        let (path, file) = results.table("ticks.csv")?;
        let traces = RedundantTraces::new(scene);
        results.claim(traces.names())?;
        Ok(Self {
            path,
            table: BufWriter::new(file),
            traces,
            peaks: None,
            lagrange,
            every: u64::from(every.max(1)),
            rows: 0,
            line: String::new(),
        })
    }

    fn write(&mut self) -> Result<(), CliError> {
        self.table
            .write_all(self.line.as_bytes())
            .map_err(|error| unwritable(&self.path, &error))
    }

    /// Adds the record of the next tick.
    pub(super) fn record(&mut self, record: &RedundantRecord) -> Result<(), CliError> {
        if self.rows == 0 {
            let mut names = columns(record);
            names.extend(self.lagrange.iter().flat_map(LagrangeColumns::names));
            self.line = format!("{}\n", names.join(","));
            self.write()?;
        }
        if self.rows.is_multiple_of(self.every) {
            let of_lagrange = self.lagrange.as_mut();
            let of_lagrange = of_lagrange.map_or_else(Vec::new, |own| own.redundant_row(record));
            table_line(&mut self.line, row(record).into_iter().chain(of_lagrange));
            self.write()?;
        }
        self.traces.push(record);
        match &mut self.peaks {
            Some(peaks) => peaks.merge(record),
            none => *none = Some(RedundantPeaks::new(record)),
        }
        self.rows += 1;
        Ok(())
    }

    /// Ends the table and draws the figures. `heading` begins their titles. Returns the files, and the differences from
    /// Lagrange's equations.
    pub(super) fn finish(
        mut self,
        results: &mut ResultFolder,
        heading: &str,
    ) -> Result<(Vec<PathBuf>, Option<LagrangeFound>), CliError> {
        let flushed = self.table.flush();
        flushed.map_err(|error| unwritable(&self.path, &error))?;
        let figures = self.traces.write(results, heading)?;
        let files = std::iter::once(self.path).chain(figures).collect();
        Ok((files, self.lagrange.map(|own| own.found())))
    }
}
