//! The part of a run that simulates the scene's plant.

use super::summary::{line, seconds};
use crate::failure::CliError;
use crate::figures::{JobMarks, MotorCurves, PlantTraces};
use crate::results::{ResultFolder, unwritable};
use crate::terminal::digits;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use trirrr_core::number::Number;
use trirrr_core::tick::Motor;
use trirrr_drives::count::Countable;
use trirrr_drives::stepper::Line;
use trirrr_plant::statistics::{Active, MotorStatistics, Signal};
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
    /// Reason why the plant did not come to the end of the job.
    pub(super) fn reason(&self) -> Option<String> {
        match &self.outcome.end {
            PlantEnd::Interrupted { .. } => Some(super::STOPPED.into()),
            end => end.reason(),
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

/// Prints what a run of the plant showed.
pub(super) fn print(out: &mut dyn Write, simulated: &Simulated) -> io::Result<()> {
    let outcome = &simulated.outcome;
    writeln!(out)?;
    let (simulated_s, took) = (digits(outcome.simulated_s), seconds(outcome.elapsed));
    let ratio = digits(outcome.ratio());
    line(
        out,
        "plant",
        &format!("{simulated_s} s simulated in {took}: {ratio} times faster than real time"),
    )?;
    match &outcome.end {
        PlantEnd::Complete => {}
        PlantEnd::Interrupted { t } => line(
            out,
            "  stopped",
            &format!("at t = {} s by Ctrl-C", tick_time(*t)),
        )?,
        PlantEnd::Ended(ending) => line(out, "  ended", &ending.to_string())?,
        PlantEnd::EnergyLost(loss) => line(out, "  ended", &loss.to_string())?,
        PlantEnd::Failed(reason) => line(out, "  failed", reason)?,
    }
    method(out, outcome)?;
    errors(out, outcome)?;
    motors(out, outcome)?;
    energy(out, outcome)?;
    writeln!(out)?;
    for (i, file) in simulated.files.iter().enumerate() {
        let label = if i == 0 { "written" } else { "" };
        line(out, label, &file.display().to_string())?;
    }
    out.flush()
}

fn method(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let method = &outcome.method;
    let how = match (method.step_s(), method.tolerance()) {
        (Some(step), _) => format!("steps of {} s", digits(step)),
        (_, Some(tolerance)) => format!("tolerance {tolerance:e}"),
        _ => String::new(),
    };
    let (steps, rejected) = (outcome.tally.steps, outcome.tally.rejected);
    let derivatives = outcome.tally.derivatives;
    line(out, "  method", &format!("{}, {how}", method.name()))?;
    if let Some(reason) = &outcome.reason {
        line(out, "", reason)?;
    }
    line(
        out,
        "",
        &format!(
            "{steps} steps and {rejected} rejected, {derivatives} derivatives of {} variables, {} events",
            outcome.dimension, outcome.tally.events
        ),
    )?;
    for warning in &outcome.warnings {
        line(out, "  warning", warning)?;
    }
    Ok(())
}

fn errors(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let statistics = &outcome.statistics;
    let show = |signal: &Signal, unit: &str| {
        format!(
            "peak {} {unit} at t = {:.4} s, rms {} {unit}",
            digits(signal.peak),
            signal.peak_t,
            digits(signal.rms())
        )
    };
    let tool = [
        show(&statistics.tool_position, "m"),
        show(&statistics.tool_angle, "rad"),
    ];
    line(out, "  deviation", &format!("tool: {}", tool[0]))?;
    line(out, "", &format!("tool: {}", tool[1]))?;
    for (number, motor) in (1..).zip(&statistics.motors) {
        let joint = show(&motor.error, "rad");
        line(out, "", &format!("joint {number}: {joint}"))?;
    }
    Ok(())
}

fn motors(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let header = ["torque N m", "rms", "current A", "rms", "power W", "rms"];
    let header = header.map(|title| format!("{title:<12}")).concat();
    line(out, "", &header)?;
    for (i, motor) in outcome.statistics.motors.iter().enumerate() {
        let values = [&motor.torque, &motor.current, &motor.power]
            .map(|signal| format!("{:<12}{:<12}", digits(signal.peak), digits(signal.rms())));
        line(out, &format!("  motor {}", i + 1), &values.concat())?;
    }
    for (i, motor) in outcome.statistics.motors.iter().enumerate() {
        limits(out, i, motor)?;
    }
    Ok(())
}

fn limits(out: &mut dyn Write, index: usize, motor: &MotorStatistics) -> io::Result<()> {
    let number = index + 1;
    let saturated = |what: &str, active: &Active| {
        active.first.map(|first| {
            format!(
                "{number} saturated ({what}) from t = {first:.4} s, for {} s in all",
                digits(active.total)
            )
        })
    };
    let current = saturated("current", &motor.current_limit);
    let voltage = saturated("voltage", &motor.voltage_limit);
    for text in [current, voltage].iter().flatten() {
        line(out, "  motor", text)?;
    }
    if let Some(first) = motor.first_slip {
        let side = if motor.lost_steps < 0 {
            "ahead of"
        } else {
            "behind"
        };
        let text = format!(
            "{number} lost steps: {} slips of four full steps, the first at t = {first:.4} s; at \
             the end {} full steps {side} its command",
            motor.slips,
            motor.lost_steps.abs()
        );
        line(out, "  motor", &text)?;
    }
    Ok(())
}

fn energy(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let balance = &outcome.balance;
    let text = format!(
        "work {} J = stored {} J + losses {} J, closed to {} of the largest",
        digits(balance.work),
        digits(balance.stored),
        digits(balance.losses),
        digits(balance.error().abs())
    );
    line(out, "  energy", &text)
}
