//! The part of a run that simulates the scene's plant.

use crate::failure::CliError;
use crate::figures::{DrawnJob, MotorCurves, PlantRow, PlantTraces};
use crate::player::STOPPED;
use crate::recording::table_line;
use crate::results::{ResultFolder, unwritable};
use std::fmt::Display;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_plant::table::{COLUMNS, Row};
use trirrr_plant::{Outcome, PlantEnd, PlantRun};
use trirrr_protocol::message::{Telemetry, Transmit};
use trirrr_scene::Scene;
use trirrr_service::board::Readings;
use trirrr_service::{Output, Power};

/// Result of a plant: its outcome, and the files written.
#[derive(Clone, Debug)]
pub struct Simulated<O = Outcome> {
    /// The run.
    pub outcome: O,
    /// The user ended the simulation.
    pub is_stopped: bool,
    /// Reason why the plant did not come to the end of the job.
    pub reason: Option<String>,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Rows that wait for the disk: enough for runs of ordinary length, whose speed is measured.
const WAITING: usize = 1 << 16;

/// Simulates the plant of a scene and writes its rows.
pub(super) struct PlantRecorder<'l, N: Number> {
    run: PlantRun<'l, N>,
    rows: Vec<Row>,
    table: PlantTable<Row>,
}

impl<'l, N: Countable> PlantRecorder<'l, N> {
    /// Builds the plant of `scene`; `plant.csv` and figures go into the folder of `results`. `line`
    /// joins the two halves of stepper drives.
    ///
    /// # Errors
    /// Refused: what the scene asks for. Failed: a file cannot be made.
    pub(super) fn create(
        scene: &Scene,
        line: &'l Line,
        results: &mut ResultFolder,
    ) -> Result<Self, CliError> {
        let run = PlantRun::build(scene, line)
            .map_err(|refusal| CliError::Refused(format!("scene {}: {refusal}", scene.name)))?;
        let times = scene.plant.as_ref();
        let [record_s, settle_s] = times.map_or([1e-3, 0.0], |it| [it.record_s, it.settle_s]);
        let run_s = f64::from(scene.ticks()) / scene.tick_rate_hz + settle_s;
        let traces = PlantTraces::new((run_s / record_s) as u64 + 1, DrawnJob::of(scene));
        Ok(Self {
            run,
            rows: Vec::new(),
            table: PlantTable::create(results, &COLUMNS, traces)?,
        })
    }
}

impl<N: Transmit> PlantRecorder<'_, N> {
    /// Returns what the drives tell before the next tick; none of drives that tell nothing.
    pub(super) fn measure(&mut self) -> Option<Readings<N>> {
        self.run.measure()
    }

    /// Takes the output of the next tick of the job.
    pub(super) fn follow(&mut self, output: &Output<N>) {
        let (rows, table) = (&mut self.rows, &mut self.table);
        self.run.tick(output, &mut |row| keep(row, rows, table));
    }

    /// Takes the sample of the next tick of the job.
    pub(super) fn tick(&mut self, sample: &Telemetry<N>) {
        let motor = |i: usize| Motor {
            angle: sample.angles[i],
            rate: sample.rates[i],
            acceleration: sample.accelerations[i],
            torque: sample.torques[i],
        };
        let output = Output {
            motors: [motor(0), motor(1), motor(2)],
            tool: sample.tool,
            power: Power::On,
            brake_released: true,
        };
        self.follow(&output);
    }

    /// Simulates to the end, unless `stop` is raised, and writes the rest. `asked` are the torques and powers of the job.
    ///
    /// # Errors
    /// Failed: something cannot be written.
    pub(super) fn finish(
        mut self,
        results: &mut ResultFolder,
        name: &str,
        asked: &MotorCurves,
        stop: &AtomicBool,
    ) -> Result<Simulated, CliError> {
        let (rows, table) = (&mut self.rows, &mut self.table);
        let outcome = self.run.finish(stop, &mut |row| keep(row, rows, table));
        write_rows(&mut self.rows, &mut self.table);
        let is_stopped = matches!(outcome.end, PlantEnd::Interrupted { .. });
        Ok(Simulated {
            is_stopped,
            reason: match is_stopped {
                true => Some(STOPPED.into()),
                false => outcome.end.reason(),
            },
            outcome,
            files: self.table.finish(results, name, asked)?,
        })
    }
}

/// Keeps a row, and writes those that wait once there are many.
fn keep(row: &Row, rows: &mut Vec<Row>, table: &mut PlantTable<Row>) {
    rows.push(*row);
    if rows.len() == WAITING {
        write_rows(rows, table);
    }
}

fn write_rows(rows: &mut Vec<Row>, table: &mut PlantTable<Row>) {
    rows.drain(..).for_each(|row| table.push(&row));
}

/// `plant.csv` and its figures, of a machine of any kind.
pub(crate) struct PlantTable<R> {
    path: PathBuf,
    file: BufWriter<File>,
    line: String,
    /// The first error; nothing is written after it.
    written: io::Result<()>,
    traces: PlantTraces<R>,
}

impl<R: PlantRow> PlantTable<R> {
    /// Makes the table with the figures of `traces` in the folder of `results`.
    ///
    /// # Errors
    /// Failed: the table cannot be written.
    pub(crate) fn create(
        results: &mut ResultFolder,
        columns: &[impl Display],
        traces: PlantTraces<R>,
    ) -> Result<Self, CliError> {
        let (path, file) = results.table("plant.csv")?;
        results.claim(traces.names())?;
        let mut file = BufWriter::new(file);
        let columns: Vec<String> = columns.iter().map(ToString::to_string).collect();
        Ok(Self {
            path,
            written: writeln!(file, "{}", columns.join(",")),
            file,
            line: String::new(),
            traces,
        })
    }

    pub(crate) fn push(&mut self, row: &R) {
        table_line(&mut self.line, row.values().into_iter());
        if self.written.is_ok() {
            self.written = self.file.write_all(self.line.as_bytes());
        }
        self.traces.push(row);
    }

    /// Ends the table and draws the figures, beside the curves that are `asked` of the motors. Returns the files.
    ///
    /// # Errors
    /// Failed: something cannot be written.
    pub(crate) fn finish(
        mut self,
        results: &mut ResultFolder,
        name: &str,
        asked: &MotorCurves,
    ) -> Result<Vec<PathBuf>, CliError> {
        self.written
            .and_then(|()| self.file.flush())
            .map_err(|error| unwritable(&self.path, &error))?;
        let figures = self.traces.write_all(results, name, asked)?;
        Ok(std::iter::once(self.path).chain(figures).collect())
    }
}
