//! The part of a run that simulates the scene's plant.

use super::served::with_service;
use super::summary::{digits, line, seconds};
use crate::failure::Failure;
use crate::figures::PlantTraces;
use crate::recording::unwritable;
use std::fs::File;
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_plant::simulate::{End, Outcome, simulate};
use trirrr_plant::source::TickSource;
use trirrr_plant::statistics::{Active, MotorStatistics, Signal};
use trirrr_plant::table::{COLUMNS, Row};
use trirrr_scene::NumberType;
use trirrr_scene::Scene;

/// What was simulated, and what was written.
#[derive(Clone, Debug)]
pub struct Simulated {
    /// The run.
    pub outcome: Outcome,
    /// The files.
    pub files: Vec<PathBuf>,
}

/// Simulates the plant of `scene`, whose ticks come from the core's service in `scalar`; writes `plant.csv` and
/// figures into `folder`.
///
/// # Errors
/// Refused: what the scene asks for. Failed: the service ends the job early, or something cannot be
/// written.
pub fn simulate_plant(
    scene: &Scene,
    scalar: NumberType,
    folder: &Path,
    stop: &AtomicBool,
) -> Result<Simulated, Failure> {
    std::fs::create_dir_all(folder).map_err(|error| unwritable(folder, &error))?;
    let path = folder.join("plant.csv");
    let file = File::create(&path).map_err(|error| unwritable(&path, &error))?;
    let mut table = BufWriter::new(file);
    let mut written = writeln!(table, "{}", COLUMNS.join(","));

    let record_s = scene.plant.as_ref().map_or(1e-3, |plant| plant.record_s);
    let settle_s = scene.plant.as_ref().map_or(0.0, |plant| plant.settle_s);
    let run_s = f64::from(scene.ticks()) / scene.tick_rate_hz + settle_s;
    let mut traces = PlantTraces::new((run_s / record_s) as u64 + 1);
    let mut rows = Vec::new();
    let mut flush = |rows: &mut Vec<Row>| {
        for row in rows.drain(..) {
            if written.is_ok() {
                written = write_row(&mut table, &row);
            }
            traces.push(&row);
        }
    };
    let run = |source: Box<dyn TickSource>| {
        simulate(scene, source, stop, |row| {
            rows.push(*row);
            // Bounded memory; the time to write counts, but not for runs of ordinary length.
            if rows.len() == 1 << 16 {
                flush(&mut rows);
            }
        })
    };
    let outcome = match scalar {
        NumberType::F64 => with_service::<f64>(scene, stop, run),
        NumberType::F32 => with_service::<f32>(scene, stop, run),
        NumberType::Fixed => with_service::<Fixed>(scene, stop, run),
        NumberType::Micromath => with_service::<Coarse>(scene, stop, run),
    }?;
    flush(&mut rows);
    written
        .and_then(|()| table.flush())
        .map_err(|error| unwritable(&path, &error))?;
    let figures = traces
        .write_all(folder, &scene.name)
        .map_err(|error| unwritable(&error.path, &error.source))?;
    Ok(Simulated {
        outcome,
        files: std::iter::once(path).chain(figures).collect(),
    })
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
    let (simulated_s, took) = (outcome.simulated_s, seconds(outcome.elapsed));
    let ratio = digits(outcome.ratio());
    line(
        out,
        "plant",
        &format!("{simulated_s} s simulated in {took}: {ratio} times faster than real time"),
    )?;
    match &outcome.end {
        End::Complete => {}
        End::Interrupted { t } => line(out, "  stopped", &format!("at t = {t} s by Ctrl-C"))?,
        End::Ended(ending) => line(out, "  ended", &ending.to_string())?,
        End::Failed(reason) => line(out, "  failed", reason)?,
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
    line(out, "  tool off", &show(&statistics.tool_position, "m"))?;
    line(out, "", &show(&statistics.tool_angle, "rad"))?;
    for (i, motor) in statistics.motors.iter().enumerate() {
        let label = if i == 0 { "  joint off" } else { "" };
        line(
            out,
            label,
            &format!("{}: {}", i + 1, show(&motor.error, "rad")),
        )?;
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
        let text = format!(
            "{number} lost steps: {} slips of four full steps, the first at t = {first:.4} s; at \
             the end {} full steps behind",
            motor.slips, motor.lost_steps
        );
        line(out, "  motor", &text)?;
    }
    Ok(())
}

fn energy(out: &mut dyn Write, outcome: &Outcome) -> io::Result<()> {
    let balance = &outcome.balance;
    let text = format!(
        "work {} J = stored {} J + losses {} J, closed to {} of it",
        digits(balance.work),
        digits(balance.stored),
        digits(balance.losses),
        digits(balance.error().abs())
    );
    line(out, "  energy", &text)
}
