//! `drives.csv` and its figure: what the drives tell, beside what they are told.

use crate::failure::CliError;
use crate::figures::{self, drive_figure};
use crate::results::{ResultFolder, unwritable};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::PathBuf;
use trirrr_client::describe::Units;
use trirrr_client::drive_records::{DriveRecord, DriveSamples};
use trirrr_figures::chart::Gathering;
use trirrr_figures::document::Facts;
use trirrr_protocol::message::{DriveSample, Telemetry, Transmit};
use trirrr_scene::Scene;
use trirrr_scene::words::short;

/// Writes the samples of the drives of one job.
pub struct DriveRecorder<N: Transmit> {
    samples: DriveSamples<N>,
    path: PathBuf,
    table: BufWriter<File>,
    figure: Gathering<DriveRecord>,
    peaks: DrivePeaks,
}

/// Greatest values of a job.
#[derive(Clone, Copy, Debug, Default)]
pub struct DrivePeaks {
    /// Samples.
    pub rows: u64,
    /// Distance of the platform from its commanded pose, m,
    pub off_m: f64,
    /// and in angle, rad.
    pub off_rad: f64,
    /// Estimated force at D, N; none in a scene without torques.
    pub force_n: Option<f64>,
    /// Estimated moment about D, N m.
    pub moment_nm: f64,
}

/// Written samples.
#[derive(Clone, Debug)]
pub struct RecordedDrives {
    /// Greatest values.
    pub peaks: DrivePeaks,
    /// Written files, the table first.
    pub files: Vec<PathBuf>,
}

impl<N: Transmit> DriveRecorder<N> {
    /// Prepares `drives.csv` in the folder of `results` for a job of `rows` samples, one every `every` ticks. `None` for
    /// drives that tell nothing.
    ///
    /// # Errors
    /// Refused: the machine. Failed: the table cannot be written.
    pub fn create(
        results: &mut ResultFolder,
        scene: &Scene,
        units: Units,
        every: u16,
    ) -> Result<Option<Self>, CliError> {
        let samples = DriveSamples::new(scene, units, every)
            .map_err(|error| CliError::Refused(format!("scene {}: {error}", scene.name)))?;
        let Some(samples) = samples else {
            return Ok(None);
        };
        let (path, file) = results.table("drives.csv")?;
        let mut table = BufWriter::new(file);
        writeln!(table, "{}", DriveRecord::COLUMNS).map_err(|error| unwritable(&path, &error))?;
        let rows = u64::from(scene.ticks()) / u64::from(every.max(1)) + 1;
        let force_n = scene.torque.then_some(0.0);
        let figure = drive_figure(rows, scene.torque);
        results.claim(figure.names())?;
        Ok(Some(Self {
            samples,
            path,
            table,
            figure,
            peaks: DrivePeaks {
                force_n,
                ..DrivePeaks::default()
            },
        }))
    }

    /// Takes the telemetry sample of a tick of the job.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub fn command(&mut self, sample: &Telemetry<N>) -> Result<(), CliError> {
        self.samples.command(sample);
        self.write()
    }

    /// Takes a sample of the drives.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub fn drives(&mut self, sample: &DriveSample<N>) -> Result<(), CliError> {
        self.samples.drives(sample);
        self.write()
    }

    fn write(&mut self) -> Result<(), CliError> {
        while let Some(record) = self.samples.next_record() {
            writeln!(self.table, "{}", record.row())
                .map_err(|error| unwritable(&self.path, &error))?;
            self.figure.push(record.t, &record);
            self.peaks.add(&record);
        }
        Ok(())
    }

    /// Ends the table and draws the figure into the folder of `results`. `name` begins the title. Without a sample there are no files.
    ///
    /// # Errors
    /// Failed: a file cannot be written.
    pub fn finish(
        mut self,
        results: &mut ResultFolder,
        name: &str,
    ) -> Result<RecordedDrives, CliError> {
        self.table
            .flush()
            .map_err(|error| unwritable(&self.path, &error))?;
        let mut files = vec![self.path];
        if self.peaks.rows > 0 {
            files.extend(figures::write(results, name, &self.figure.finish(&[]))?);
        }
        Ok(RecordedDrives {
            peaks: self.peaks,
            files,
        })
    }
}

impl DrivePeaks {
    fn add(&mut self, record: &DriveRecord) {
        self.rows += 1;
        if let Some([off_m, off_rad]) = record.off {
            self.off_m = self.off_m.max(off_m);
            self.off_rad = self.off_rad.max(off_rad.abs());
        }
        let [x, y, moment] = record.wrench;
        if let Some(force) = &mut self.force_n {
            *force = force.max(x.hypot(y));
            self.moment_nm = self.moment_nm.max(moment.abs());
        }
    }

    /// Lines of a summary, and numbers.
    pub fn record(&self) -> Facts {
        let [off_m, off_rad, moment] = [self.off_m, self.off_rad, self.moment_nm].map(short);
        let off = format!(
            "{} samples, the platform at most {off_m} m and {off_rad} rad off",
            self.rows
        );
        let force = self.force_n.map(short);
        let force = force.map(|force| {
            format!("force at the tool at most {force} N, moment {moment} N m, as estimated")
        });
        Facts::new()
            .text("drives", Vec::from_iter([off].into_iter().chain(force)))
            .data("samples", self.rows)
            .data("off_m", self.off_m)
            .data("off_rad", self.off_rad)
            .data("force_n", self.force_n)
            .data("moment_nm", self.force_n.map(|_| self.moment_nm))
    }
}
