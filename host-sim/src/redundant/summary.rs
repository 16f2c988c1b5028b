//! The summary of a run of a redundant machine.

use super::peaks::RedundantPeaks;
use super::plant::SimulatedMachine;
use super::play::RedundantReport;
use super::{kind_text, placement_text, slider_texts};
use crate::recording::At;
use crate::run::summary::{lagrange, line, seconds, times};
use crate::terminal::digits;
use std::io::{self, Write};
use std::path::Path;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::statistics::Signal;
use trirrr_scene::words::tick_time;

/// Prints the summary of a run of `scene`, read from `file`.
pub(super) fn print(
    out: &mut dyn Write,
    file: &Path,
    scene: &RedundantScene,
    report: &RedundantReport,
) -> io::Result<()> {
    let whole = format!("{} ({})", scene.name, file.display());
    line(out, "scene", &whole)?;
    if !scene.description.is_empty() {
        line(out, "", &scene.description)?;
    }
    line(out, "machine", &kind_text(scene.kind))?;
    for text in slider_texts(scene).into_iter().chain(placement_text(scene)) {
        line(out, "", &text)?;
    }
    let (ticks, rate) = (scene.ticks(), scene.tick_rate_hz);
    let moves = match scene.job.moves.len() {
        1 => "1 move".into(),
        count => format!("{count} moves"),
    };
    let duration = f64::from(ticks) / rate;
    let job = format!("{moves}, {duration} s: {ticks} ticks at {rate} Hz");
    line(out, "job", &job)?;
    let how = match &report.deadlines {
        Some(_) => "in real time",
        None => "without pacing",
    };
    let (rows, took) = (report.rows, seconds(report.elapsed));
    let ran = format!("{rows} of {} setpoints {how}, {took}", u64::from(ticks) + 1);
    line(out, "ran", &ran)?;
    if !report.is_complete {
        line(
            out,
            "stopped",
            "by Ctrl-C; what was computed so far is written",
        )?;
    }
    if let Some(peaks) = &report.peaks {
        motion(out, peaks)?;
    }
    if let Some(found) = &report.lagrange {
        writeln!(out)?;
        lagrange(out, found)?;
    }
    times(out, rate, &report.computation, report.deadlines.as_ref())?;
    if let Some(simulated) = &report.plant {
        plant(out, scene, simulated)?;
    }
    writeln!(out)?;
    for (number, file) in report.all_files().iter().enumerate() {
        let label = if number == 0 { "written" } else { "" };
        line(out, label, &file.display().to_string())?;
    }
    out.flush()
}

fn row(cells: &[String]) -> String {
    cells.iter().map(|cell| format!("{cell:<18}")).collect()
}

fn motion(out: &mut dyn Write, peaks: &RedundantPeaks) -> io::Result<()> {
    let cell = |at: At, unit: &str| format!("{} {unit}", digits(at.value));
    writeln!(out)?;
    let header = ["peak rate", "peak torque", "peak power"].map(String::from);
    line(out, "", &row(&header))?;
    for (number, motor) in peaks.motors.iter().enumerate() {
        let cells = [
            cell(motor.rate, "rad/s"),
            cell(motor.torque, "N m"),
            cell(motor.power, "W"),
        ];
        line(out, &format!("motor {}", number + 1), &row(&cells))?;
    }
    if !peaks.sliders.is_empty() {
        let header = ["peak velocity", "peak force", "peak power"].map(String::from);
        line(out, "", &row(&header))?;
    }
    for slider in &peaks.sliders {
        let cells = [
            cell(slider.velocity, "m/s"),
            cell(slider.force, "N"),
            cell(slider.power, "W"),
        ];
        line(out, &format!("slider {}", slider.leg + 1), &row(&cells))?;
    }
    writeln!(out)?;
    let when =
        |at: At, unit: &str| format!("{}{unit} at t = {} s", digits(at.value), tick_time(at.t));
    let (norm, least) = (peaks.norm, peaks.least_norm);
    let texts = [when(norm, " N m"), when(least, " N m")];
    let text = match norm.value > least.value * (1.0 + 1e-9) {
        true => format!("{}, without preload {}", texts[0], texts[1]),
        false => texts[0].clone(),
    };
    line(out, "torque norm", &format!("at most {text}"))?;
    let (leg, joint) = peaks.joint;
    let text = format!("at most {}, leg {}", when(joint, " N"), leg + 1);
    line(out, "joint force", &text)?;
    let label = "least distance to singularity (scale-free, 0 to 1)";
    line(out, label, "")?;
    let (leg, serial) = peaks.serial;
    let text = format!("{}, leg {}", when(serial, ""), leg + 1);
    line(out, "  serial", &text)?;
    line(out, "  parallel", &when(peaks.parallel, ""))
}

fn plant(
    out: &mut dyn Write,
    scene: &RedundantScene,
    simulated: &SimulatedMachine,
) -> io::Result<()> {
    let outcome = &simulated.outcome;
    writeln!(out)?;
    let (simulated_s, steps) = (outcome.simulated_s, outcome.steps);
    let text = format!("{} s simulated in {steps} steps", digits(simulated_s));
    line(out, "plant", &text)?;
    if let Some(failure) = &outcome.failure {
        line(out, "  failed", failure)?;
    }
    if outcome.is_stopped {
        line(out, "  stopped", "by Ctrl-C")?;
    }
    let signal = |signal: &Signal, unit: &str| {
        let (peak, rms) = (digits(signal.peak), digits(signal.rms()));
        format!(
            "peak {peak} {unit} at t = {} s, rms {rms} {unit}",
            tick_time(signal.peak_t)
        )
    };
    line(out, "  path", &signal(&outcome.path_error, "m"))?;
    line(out, "  angle", &signal(&outcome.angle_error, "rad"))?;
    for (number, torque) in outcome.torques.iter().enumerate() {
        line(
            out,
            &format!("  motor {}", number + 1),
            &signal(torque, "N m"),
        )?;
    }
    let legs = (0..scene.legs.len()).filter(|&leg| scene.sliders[leg].is_some());
    for (leg, force) in legs.zip(&outcome.forces) {
        line(out, &format!("  slider {}", leg + 1), &signal(force, "N"))?;
    }
    let text = format!(
        "work {} J, stored {} J, lost {} J; {} J are missing",
        digits(outcome.work_j),
        digits(outcome.stored_j),
        digits(outcome.lost_j),
        digits(outcome.balance_error_j())
    );
    line(out, "  energy", &text)
}
