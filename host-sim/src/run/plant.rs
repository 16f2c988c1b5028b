//! The part of a run that simulates the scene's plant.

use super::document::{seconds, signal};
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
use trirrr_figures::document::{Document, Facts, digits, quantity};
use trirrr_plant::statistics::{Active, MotorStatistics};
use trirrr_plant::table::{COLUMNS, Row};
use trirrr_plant::{Outcome, PlantEnd, PlantRun};
use trirrr_protocol::message::{Telemetry, Transmit};
use trirrr_scene::Scene;
use trirrr_scene::words::tick_time;
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

/// Adds a run of the plant to the document of the run.
pub(super) fn add_to(document: &mut Document, simulated: &Simulated) {
    let outcome = &simulated.outcome;
    let (method, statistics, tally) = (&outcome.method, &outcome.statistics, &outcome.tally);
    let took_s = outcome.elapsed.as_secs_f64();
    let (simulated_words, took) = (quantity(outcome.simulated_s, "s"), seconds(took_s));
    let ratio = digits(outcome.ratio());
    let (label, end) = match &outcome.end {
        PlantEnd::Complete => ("", String::new()),
        PlantEnd::Interrupted { t } => {
            ("  stopped", format!("at t = {} s by Ctrl-C", tick_time(*t)))
        }
        PlantEnd::Ended(ending) => ("  ended", ending.to_string()),
        PlantEnd::EnergyLost(loss) => ("  ended", loss.to_string()),
        PlantEnd::Failed(reason) => ("  failed", reason.clone()),
    };
    let how = match (method.step_s(), method.tolerance()) {
        (Some(step), _) => format!("steps of {}", quantity(step, "s")),
        (_, Some(tolerance)) => format!("tolerance {tolerance:e}"),
        _ => String::new(),
    };
    let work = format!(
        "{} steps and {} rejected, {} derivatives of {} variables, {} events",
        tally.steps, tally.rejected, tally.derivatives, outcome.dimension, tally.events
    );
    let tool = [
        signal(&statistics.tool_position).line_in(Some("m")),
        signal(&statistics.tool_angle).line_in(Some("rad")),
    ];
    let tool = tool.iter().map(|line| format!("tool: {line}"));
    let joints = (1..)
        .zip(&statistics.motors)
        .map(|(number, motor): (u32, _)| {
            let line = signal(&motor.error).line_in(Some("rad"));
            format!("joint {number}: {line}")
        });
    let reasons = outcome.reason.iter().map(ToString::to_string).chain([work]);
    document.pairs_in(
        "plant",
        Facts::new()
            .pair("simulated_s", "plant", outcome.simulated_s)
            .words(format!(
                "{simulated_words} simulated in {took}: {ratio} times faster than real time"
            ))
            .data("elapsed_s", took_s)
            .pair("reason", label, simulated.reason())
            .words(end)
            .pair("method", "  method", method.name())
            .words(format!("{}, {how}", method.name()))
            .text("", Vec::from_iter(reasons))
            .data("steps", tally.steps)
            .data("warnings", &outcome.warnings)
            .text("  warning", outcome.warnings.clone())
            .text("  deviation", Vec::from_iter(tool.chain(joints)))
            .data("tool_position_error_m", signal(&statistics.tool_position))
            .data("tool_angle_error_rad", signal(&statistics.tool_angle)),
    );
    document.table(
        "plant.motors",
        (1..).zip(&statistics.motors).map(motor).collect(),
    );
    let balance = &outcome.balance;
    let limits = (1..).zip(&statistics.motors).flat_map(limits);
    document.pairs_in(
        "plant",
        Facts::new()
            .text("  motor", Vec::from_iter(limits))
            .text(
                "  energy",
                format!(
                    "work {} J = stored {} J + losses {} J, closed to {} of the largest",
                    digits(balance.work),
                    digits(balance.stored),
                    digits(balance.losses),
                    digits(balance.error().abs())
                ),
            )
            .data("work_j", balance.work)
            .data("stored_j", balance.stored)
            .data("losses_j", balance.losses)
            .data("balance_error_j", balance.error()),
    );
}

fn motor((number, motor): (usize, &MotorStatistics)) -> Facts {
    let active = |active: &Active| {
        Facts::new()
            .data("first_s", active.first)
            .data("total_s", active.total)
    };
    Facts::new()
        .text("", format!("  motor {number}"))
        .data("joint_error_rad", signal(&motor.error))
        .group("torque_nm", "torque", signal(&motor.torque))
        .derived("rms torque", "N m", motor.torque.rms())
        .group("current_a", "current", signal(&motor.current))
        .derived("rms current", "A", motor.current.rms())
        .group("power_w", "power", signal(&motor.power))
        .derived("rms power", "W", motor.power.rms())
        .data("current_limit", active(&motor.current_limit))
        .data("voltage_limit", active(&motor.voltage_limit))
        .data("first_slip_s", motor.first_slip)
        .data("slips", motor.slips)
        .data("lost_steps", motor.lost_steps)
}

/// Limits that a motor was at, and steps that it lost.
fn limits((number, motor): (usize, &MotorStatistics)) -> Vec<String> {
    let saturated = |what: &str, active: &Active| {
        let first = active.first?;
        let total = quantity(active.total, "s");
        Some(format!(
            "{number} saturated ({what}) from t = {first:.4} s, for {total} in all"
        ))
    };
    let slip = motor.first_slip.map(|first| {
        let side = if motor.lost_steps < 0 { "ahead of" } else { "behind" };
        format!(
            "{number} lost steps: {} slips of four full steps, the first at t = {first:.4} s; at the end {} full steps {side} its command",
            motor.slips,
            motor.lost_steps.abs()
        )
    });
    let current = saturated("current", &motor.current_limit);
    let voltage = saturated("voltage", &motor.voltage_limit);
    current.into_iter().chain(voltage).chain(slip).collect()
}
