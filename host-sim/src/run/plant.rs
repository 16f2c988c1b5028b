//! The part of a run that simulates the scene's plant.

use crate::failure::CliError;
use crate::figures::{JobMarks, MotorCurves, PlantTraces};
use crate::player::STOPPED;
use crate::results::{ResultFolder, unwritable};
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
use trirrr_service::{Output, Power, Readings};

/// Outcome of a plant, and the files written.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The run.
    pub outcome: Outcome,
    /// The files.
    pub files: Vec<PathBuf>,
}

impl Simulated {
    /// Returns `true` if the user ended the simulation.
    pub(super) fn is_stopped(&self) -> bool {
        matches!(self.outcome.end, PlantEnd::Interrupted { .. })
    }

    /// Reason why the plant did not come to the end of the job.
    pub(super) fn reason(&self) -> Option<String> {
        match self.is_stopped() {
            true => Some(STOPPED.into()),
            false => self.outcome.end.reason(),
        }
    }
}

/// Rows that wait for the disk: enough for runs of ordinary length, whose speed is measured.
const WAITING: usize = 1 << 16;

/// Simulates the plant of a scene and writes its rows.
pub(super) struct PlantRecorder<'l, N: Number> {
    run: PlantRun<'l, N>,
    rows: Vec<Row>,
    table: PlantTable,
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
        Ok(Self {
            run,
            rows: Vec::new(),
            table: PlantTable::create(scene, results)?,
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
        asked: MotorCurves,
        stop: &AtomicBool,
    ) -> Result<Simulated, CliError> {
        let (rows, table) = (&mut self.rows, &mut self.table);
        let outcome = self.run.finish(stop, &mut |row| keep(row, rows, table));
        self.table.write(&mut self.rows);
        Ok(Simulated {
            outcome,
            files: self.table.finish(results, name, asked)?,
        })
    }
}

/// Keeps a row, and writes those that wait once there are many.
fn keep(row: &Row, rows: &mut Vec<Row>, table: &mut PlantTable) {
    rows.push(*row);
    if rows.len() == WAITING {
        table.write(rows);
    }
}

/// `plant.csv` and the curves of its figures.
struct PlantTable {
    path: PathBuf,
    file: BufWriter<File>,
    /// The first error; nothing is written after it.
    written: io::Result<()>,
    traces: PlantTraces,
}

impl PlantTable {
    fn create(scene: &Scene, results: &mut ResultFolder) -> Result<Self, CliError> {
        let (path, file) = results.table("plant.csv")?;
        let mut file = BufWriter::new(file);
        let written = writeln!(file, "{}", COLUMNS.join(","));
        let record_s = scene.plant.as_ref().map_or(1e-3, |plant| plant.record_s);
        let settle_s = scene.plant.as_ref().map_or(0.0, |plant| plant.settle_s);
        let run_s = f64::from(scene.ticks()) / scene.tick_rate_hz + settle_s;
        let traces = PlantTraces::new((run_s / record_s) as u64 + 1, JobMarks::of(scene));
        results.claim(traces.names())?;
        Ok(Self {
            path,
            file,
            written,
            traces,
        })
    }

    fn write(&mut self, rows: &mut Vec<Row>) {
        for row in rows.drain(..) {
            if self.written.is_ok() {
                self.written = write_row(&mut self.file, &row);
            }
            self.traces.push(&row);
        }
    }

    fn finish(
        mut self,
        results: &mut ResultFolder,
        name: &str,
        asked: MotorCurves,
    ) -> Result<Vec<PathBuf>, CliError> {
        self.written
            .and_then(|()| self.file.flush())
            .map_err(|error| unwritable(&self.path, &error))?;
        let figures = self.traces.write_all(results, name, asked)?;
        Ok(std::iter::once(self.path).chain(figures).collect())
    }
}

/// Shortest digits that read back as the same number, as in `ticks.csv`.
fn write_row(table: &mut impl Write, row: &Row) -> io::Result<()> {
    for (column, value) in row.values().iter().enumerate() {
        let comma = if column > 0 { "," } else { "" };
        write!(table, "{comma}{value:?}")?;
    }
    writeln!(table)
}
