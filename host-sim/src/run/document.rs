//! A run as a document. Runs of all machines share its parts.

use super::report::{JobEnd, RunReport, RunResult};
use crate::histogram::Histogram;
use crate::recording::LagrangeFound;
use crate::recording::{MotorLoad, Peaks};
use std::path::Path;
use std::time::Duration;
use trirrr_figures::document::{Document, Facts, quantity};
use trirrr_plant::statistics::Signal;
use trirrr_scene::Scene;
use trirrr_scene::words::{short, tick_time};

/// Job that was played, and how.
pub(crate) struct RunOutcome<'a> {
    pub(crate) name: &'a str,
    pub(crate) description: &'a str,
    pub(crate) file: &'a Path,
    pub(crate) moves: usize,
    pub(crate) ticks: u32,
    pub(crate) rate_hz: f64,
    /// Setpoints that have a record.
    pub(crate) setpoints: u64,
    pub(crate) played: &'a RunResult,
}

/// A number of things.
pub(crate) fn counted(count: usize, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{plural}")
}

impl RunOutcome<'_> {
    /// Scene, and what it is.
    pub(crate) fn scene(&self) -> Facts {
        let words = format!("{} ({})", self.name, self.file.display());
        Facts::new()
            .pair("scene", "scene", self.name)
            .words(words)
            .data("file", self.file)
            .text("", self.description)
    }

    /// Size of the job, and its end.
    pub(crate) fn job(&self, hold: Option<String>) -> Facts {
        let duration_s = f64::from(self.ticks) / self.rate_hz;
        let (moves, duration) = (counted(self.moves, "move"), short(duration_s));
        let job = format!(
            "{moves}, {duration} s: {} ticks at {} Hz",
            self.ticks, self.rate_hz
        );
        let how = match &self.played.deadlines {
            Some(_) => "in real time",
            None => "without pacing",
        };
        let (all, took) = (u64::from(self.ticks) + 1, self.played.elapsed.as_secs_f64());
        let ran = format!(
            "{} of {all} setpoints {how}, {}",
            self.setpoints,
            seconds(took)
        );
        let (name, label, words) = match &self.played.end {
            JobEnd::Complete => ("complete", "", String::new()),
            JobEnd::Stopped => (
                "stopped",
                "stopped",
                "by Ctrl-C; what was computed so far is written".into(),
            ),
            JobEnd::Refused(why) => ("refused", "refused", why.clone()),
            JobEnd::Fault(what) => (
                "fault",
                "fault",
                format!("{what}; what came before is written"),
            ),
        };
        let reason = match &self.played.end {
            JobEnd::Refused(why) | JobEnd::Fault(why) => Some(why),
            _ => None,
        };
        Facts::new()
            .text("job", job)
            .data("moves", self.moves)
            .data("ticks", self.ticks)
            .data("tick_rate_hz", self.rate_hz)
            .data("duration_s", duration_s)
            .text("a hold", hold)
            .data("setpoints", self.setpoints)
            .pair("elapsed_s", "ran", took)
            .words(ran)
            .pair("end", label, name)
            .words(words)
            .data("reason", reason)
    }

    /// Times of the computation of a tick, and of the deadlines.
    pub(crate) fn times(&self) -> Facts {
        let period_us = 1e6 / self.rate_hz;
        let deadlines = self.played.deadlines.as_ref();
        let late = deadlines.map(|deadlines| {
            let (late, total) = (deadlines.late, deadlines.release.count());
            format!("{late} of {total} (a result after {period_us} microseconds)")
        });
        let jitter = deadlines.map(|deadlines| times(&deadlines.release));
        Facts::new()
            .group("computing_us", "computing", times(&self.played.computation))
            .group("jitter_us", "jitter", jitter)
            .text(
                "",
                late.as_ref()
                    .map(|_| "(jitter: how long after its time a tick began)".to_owned()),
            )
            .pair("late_ticks", "late ticks", deadlines.map(|it| it.late))
            .words(late.unwrap_or_default())
    }
}

/// Time that a computation took.
pub(super) fn seconds(took_s: f64) -> String {
    match took_s < 0.1 {
        true => quantity(took_s, "s"),
        false => format!("{took_s:.3} s"),
    }
}

fn times(times: &Histogram) -> Facts {
    let us = |time: Duration| time.as_secs_f64() * 1e6;
    Facts::new()
        .pair("min", "min", us(times.min()))
        .pair("median", "median", us(times.percentile(50.0)))
        .pair("p99", "p99", us(times.percentile(99.0)))
        .pair("max", "max", us(times.max()))
}

/// Adds the peaks of the motors, with their loads where they are known, and `more` extremes. A scene without torques has rates only.
pub(crate) fn add_peaks(
    document: &mut Document,
    peaks: &Peaks,
    torque: bool,
    loads: &[MotorLoad],
    more: impl FnOnce(&mut Document),
) {
    let motors = peaks.motors.iter().enumerate().map(|(index, motor)| {
        let row = Facts::new().text("", format!("motor {}", index + 1)).group(
            "peak_rate_rad_s",
            "peak rate",
            motor.rate.facts(),
        );
        let row = match torque {
            false => return row,
            true => row
                .group("peak_torque_nm", "peak torque", motor.torque.facts())
                .group("peak_power_w", "peak power", motor.power.facts()),
        };
        match loads.get(index) {
            None => row,
            Some(load) => row
                .pair("rms_torque_nm", "rms torque", load.rms_torque_nm)
                .pair("work_given_j", "work given", load.given_j)
                .pair("work_returned_j", "returned", load.returned_j),
        }
    });
    document.table("motors", motors.collect());
    more(document);
    let legs = peaks.serial.iter().zip(1..);
    let least = legs.min_by(|(one, _), (other, _)| one.value.total_cmp(&other.value));
    let serial =
        least.map(|(least, leg): (_, u32)| least.facts().text("leg", leg.to_string()).line());
    let distances = Facts::new()
        .rows(
            "serial_distance_min",
            peaks.serial.iter().map(|leg| leg.facts()),
        )
        .text("serial", serial)
        .group("parallel_distance_min", "parallel", peaks.parallel.facts());
    document
        .heading("least distance to singularity (scale-free, 0 to 1)")
        .pairs(distances);
}

/// Peak of a signal with its time, and the root mean square.
pub(crate) fn signal(signal: &Signal) -> Facts {
    let time = format!("{} s", tick_time(signal.peak_t));
    Facts::new()
        .pair("peak", "peak", signal.peak)
        .pair("t_s", "at t =", signal.peak_t)
        .words(time)
        .pair("rms", "rms", signal.rms())
}

/// Differences from Lagrange's equations; null where they were not asked for.
pub(crate) fn add_lagrange(document: &mut Document, found: Option<&LagrangeFound>) {
    match found {
        Some(found) => document.pairs_in("lagrange", found.record()),
        None => document.data("lagrange", ()),
    };
}

/// The run of `scene`, read from `file`.
pub(super) fn document(file: &Path, scene: &Scene, report: &RunReport) -> Document {
    let played = RunOutcome {
        name: &scene.name,
        description: &scene.description,
        file,
        moves: scene.job.count(),
        ticks: scene.ticks(),
        rate_hz: scene.tick_rate_hz,
        setpoints: report.job.rows,
        played: &report.played,
    };
    let mut document = Document::new();
    let numbers = (report.scalar.name(), report.scalar.to_string());
    let hold = scene.longest_stop().map(|longest| longest.to_string());
    document.pairs(
        played
            .scene()
            .pair("number", "numbers", numbers.0)
            .words(numbers.1)
            .and(played.job(hold)),
    );
    match &report.job.peaks {
        Some(peaks) => add_peaks(
            &mut document,
            peaks,
            scene.torque,
            &report.job.loads,
            |_| (),
        ),
        None => {
            let none = Facts::new().data("motors", ());
            let none = none.data("serial_distance_min", ());
            document.pairs(none.data("parallel_distance_min", ()));
        }
    }
    add_lagrange(&mut document, report.job.lagrange.as_ref());
    if let Some(drives) = &report.drives {
        document.pairs_in("drives", drives.peaks.record());
    }
    document.pairs(played.times());
    document
}
