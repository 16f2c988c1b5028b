//! The summary of a run.

use super::{JobEnd, RunReport};
use crate::histogram::Histogram;
use crate::lagrange::LagrangeFound;
use crate::realtime::Deadlines;
use crate::recording::At;
use crate::terminal::digits;
use std::io::{self, Write};
use std::path::Path;
use std::time::Duration;
use trirrr_scene::words::{short, tick_time};
use trirrr_scene::{Scene, visible};

/// Prints the summary of a run of `scene`, read from `file`.
pub(super) fn print(
    out: &mut dyn Write,
    file: &Path,
    scene: &Scene,
    report: &RunReport,
) -> io::Result<()> {
    job(out, file, scene, report)?;
    motion(out, scene, report)?;
    if let Some(drives) = &report.drives {
        writeln!(out)?;
        drives.peaks.print(|label, text| line(out, label, text))?;
    }
    timing(out, scene, report)?;
    files(out, report)?;
    out.flush()
}

/// One line: what it is about, and what there is to say, [visible].
pub(crate) fn line(out: &mut dyn Write, label: &str, text: &str) -> io::Result<()> {
    let line = format!("{label:<12}{}", visible(text));
    writeln!(out, "{}", line.trim_end())
}

fn job(out: &mut dyn Write, file: &Path, scene: &Scene, report: &RunReport) -> io::Result<()> {
    line(
        out,
        "scene",
        &format!("{} ({})", scene.name, file.display()),
    )?;
    if !scene.description.is_empty() {
        line(out, "", &scene.description)?;
    }
    line(out, "numbers", &report.scalar.to_string())?;
    let moves = match scene.job.count() {
        1 => "1 move".into(),
        count => format!("{count} moves"),
    };
    let (ticks, rate) = (scene.ticks(), scene.tick_rate_hz);
    let duration = short(f64::from(ticks) / rate);
    line(
        out,
        "job",
        &format!("{moves}, {duration} s: {ticks} ticks at {rate} Hz"),
    )?;
    if let Some(longest) = scene.longest_stop() {
        line(out, "a hold", &longest.to_string())?;
    }
    let (records, setpoints) = (report.records, report.setpoints);
    let how = match &report.deadlines {
        Some(_) => "in real time",
        None => "without pacing",
    };
    let took = seconds(report.elapsed);
    line(
        out,
        "ran",
        &format!("{records} of {setpoints} setpoints {how}, {took}"),
    )?;
    match &report.end {
        JobEnd::Complete => Ok(()),
        JobEnd::Stopped => line(
            out,
            "stopped",
            "by Ctrl-C; what was computed so far is written",
        ),
        JobEnd::Refused(why) => line(out, "refused", why),
        JobEnd::Fault(what) => line(
            out,
            "fault",
            &format!("{what}; what came before is written"),
        ),
    }
}

fn motion(out: &mut dyn Write, scene: &Scene, report: &RunReport) -> io::Result<()> {
    let Some(peaks) = &report.peaks else {
        return Ok(());
    };
    writeln!(out)?;
    // A scene without torques has rates only.
    let columns = if scene.torque { 3 } else { 1 };
    let row = |cells: &[String]| -> String {
        let cells = cells.iter().take(columns);
        cells.map(|cell| format!("{cell:<18}")).collect()
    };
    let header = ["peak rate", "peak torque", "peak power"].map(String::from);
    line(out, "", &row(&header))?;
    for (i, motor) in peaks.motors.iter().enumerate() {
        let cells = [
            quantity(motor.rate.value, "rad/s"),
            quantity(motor.torque.value, "N m"),
            quantity(motor.power.value, "W"),
        ];
        line(out, &format!("motor {}", i + 1), &row(&cells))?;
    }
    if scene.torque {
        let header = ["rms torque", "work given", "work returned"].map(String::from);
        line(out, "", &row(&header))?;
        for (i, load) in report.loads.iter().enumerate() {
            let cells = [
                quantity(load.rms_torque_nm, "N m"),
                quantity(load.given_j, "J"),
                quantity(load.returned_j, "J"),
            ];
            line(out, &format!("motor {}", i + 1), &row(&cells))?;
        }
    }
    writeln!(out)?;
    if let Some(found) = &report.lagrange {
        lagrange(out, found)?;
        writeln!(out)?;
    }
    let nearest = |at: At| format!("{} at t = {} s", digits(at.value), tick_time(at.t));
    let (leg, serial) = least(&peaks.serial);
    line(
        out,
        "least distance to singularity (scale-free, 0 to 1)",
        "",
    )?;
    line(
        out,
        "  serial",
        &format!("{}, leg {}", nearest(serial), leg + 1),
    )?;
    line(out, "  parallel", &nearest(peaks.parallel))
}

/// Differences from Lagrange's equations.
pub(crate) fn lagrange(out: &mut dyn Write, found: &LagrangeFound) -> io::Result<()> {
    for (number, text) in found.lines().iter().enumerate() {
        line(out, if number == 0 { "lagrange" } else { "" }, text)?;
    }
    Ok(())
}

/// The least of the three and its leg, 0 to 2.
fn least(serial: &[At; 3]) -> (usize, At) {
    let mut least = (0, serial[0]);
    for (leg, at) in serial.iter().enumerate() {
        if at.value < least.1.value {
            least = (leg, *at);
        }
    }
    least
}

fn timing(out: &mut dyn Write, scene: &Scene, report: &RunReport) -> io::Result<()> {
    times(
        out,
        scene.tick_rate_hz,
        &report.computation,
        report.deadlines.as_ref(),
    )
}

/// Times of the computation of a tick, and of the deadlines.
pub(crate) fn times(
    out: &mut dyn Write,
    tick_rate_hz: f64,
    computation: &Histogram,
    deadlines: Option<&Deadlines>,
) -> io::Result<()> {
    writeln!(out)?;
    line(
        out,
        "microseconds",
        &["min", "median", "p99", "max"]
            .map(|s| format!("{s:>10}"))
            .concat(),
    )?;
    let row = |out: &mut dyn Write, label: &str, times: &Histogram| {
        let times = [
            times.min(),
            times.percentile(50.0),
            times.percentile(99.0),
            times.max(),
        ];
        let columns = times.map(|time| format!("{:>10.2}", time.as_secs_f64() * 1e6));
        line(out, label, &columns.concat())
    };
    row(out, "  computing", computation)?;
    let Some(deadlines) = deadlines else {
        return Ok(());
    };
    row(out, "  jitter", &deadlines.release)?;
    line(out, "", "(jitter: how long after its time a tick began)")?;
    let period = Duration::from_secs_f64(1.0 / tick_rate_hz);
    let (late, total) = (deadlines.late, deadlines.release.count());
    let period_us = period.as_secs_f64() * 1e6;
    line(
        out,
        "late ticks",
        &format!("{late} of {total} (a result after {period_us} microseconds)"),
    )
}

fn files(out: &mut dyn Write, report: &RunReport) -> io::Result<()> {
    writeln!(out)?;
    let of_drives = report.drives.iter().flat_map(|drives| &drives.files);
    for (i, file) in report.files.iter().chain(of_drives).enumerate() {
        line(
            out,
            if i == 0 { "written" } else { "" },
            &file.display().to_string(),
        )?;
    }
    Ok(())
}

pub(crate) fn seconds(duration: Duration) -> String {
    let s = duration.as_secs_f64();
    match s {
        _ if s < 1e-3 => format!("{:.1} microseconds", s * 1e6),
        _ if s < 0.1 => format!("{:.2} ms", s * 1e3),
        _ => format!("{s:.3} s"),
    }
}

/// Four digits with a unit; an exponent only where zeros would hide the size.
fn quantity(value: f64, unit: &str) -> String {
    format!("{} {unit}", digits(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_have_a_unit() {
        assert_eq!(quantity(0.0, "W"), "0 W");
    }

    #[test]
    fn durations_have_a_unit_that_fits() {
        assert_eq!(seconds(Duration::from_micros(42)), "42.0 microseconds");
        assert_eq!(seconds(Duration::from_millis(1000)), "1.000 s");
        assert_eq!(seconds(Duration::from_micros(2500)), "2.50 ms");
    }
}
