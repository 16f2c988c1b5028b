//! A run as a document. Runs of all machines share its parts.

use super::report::{JobEnd, RunReport, RunResult};
use crate::histogram::Histogram;
use crate::recording::{LoadPeaks, MotorLoad, Peaks};
use std::path::Path;
use std::time::Duration;
use trirrr_figures::document::{Document, Facts, quantity};
use trirrr_plant::statistics::Signal;
use trirrr_scene::words::{counted, short, tick_time};

/// Scene and job of a run.
pub(crate) struct RunScene<'a> {
    pub(crate) name: &'a str,
    pub(crate) description: &'a str,
    pub(crate) file: &'a Path,
    pub(crate) moves: usize,
    pub(crate) ticks: u32,
    pub(crate) rate_hz: f64,
    pub(crate) torque: bool,
    /// Numbers, or the machine.
    pub(crate) head: Facts,
    /// Longest way to rest in a hold, in words.
    pub(crate) hold: Option<String>,
}

impl RunScene<'_> {
    /// Scene, and what it is.
    fn scene(&self) -> Facts {
        let words = format!("{} ({})", self.name, self.file.display());
        Facts::new()
            .pair("scene", "scene", self.name)
            .words(words)
            .data("file", self.file)
            .text("", self.description)
    }

    /// Size of the job, and its end.
    fn job<O>(&self, report: &RunReport<O>) -> Facts {
        let played = &report.played;
        let duration_s = f64::from(self.ticks) / self.rate_hz;
        let (moves, duration) = (counted(self.moves, "move"), short(duration_s));
        let job = format!(
            "{moves}, {duration} s: {} ticks at {} Hz",
            self.ticks, self.rate_hz
        );
        let how = match &played.deadlines {
            Some(_) => "in real time",
            None => "without pacing",
        };
        let (all, took) = (u64::from(self.ticks) + 1, played.elapsed.as_secs_f64());
        let ran = format!(
            "{} of {all} setpoints {how}, {}",
            report.job.rows,
            seconds(took)
        );
        let (name, label, words) = match &played.end {
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
        let reason = match &played.end {
            JobEnd::Refused(why) | JobEnd::Fault(why) => Some(why),
            _ => None,
        };
        Facts::new()
            .text("job", job)
            .data("moves", self.moves)
            .data("ticks", self.ticks)
            .data("tick_rate_hz", self.rate_hz)
            .data("duration_s", duration_s)
            .text("a hold", self.hold.clone())
            .data("setpoints", report.job.rows)
            .pair("elapsed_s", "ran", took)
            .words(ran)
            .pair("end", label, name)
            .words(words)
            .data("reason", reason)
    }

    /// Times of the computation of a tick, and of the deadlines.
    fn times(&self, played: &RunResult) -> Facts {
        let period_us = 1e6 / self.rate_hz;
        let deadlines = played.deadlines.as_ref();
        let late = deadlines.map(|deadlines| {
            let (late, total) = (deadlines.late, deadlines.release.count());
            format!("{late} of {total} (a result after {period_us} microseconds)")
        });
        let jitter = deadlines.map(|deadlines| times(&deadlines.release));
        Facts::new()
            .group("computing_us", "computing", times(&played.computation))
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

/// Adds the peaks of the motors and their loads, and the distances to singularity. A scene without torques has rates only.
fn add_peaks(document: &mut Document, peaks: &Peaks, torque: bool, loads: &[MotorLoad]) {
    let motors = peaks.motors.iter().zip(loads).enumerate();
    let motors = motors.map(|(index, (motor, load))| {
        let row = Facts::new().text("", format!("motor {}", index + 1)).group(
            "peak_rate_rad_s",
            "peak rate",
            motor.rate.facts(),
        );
        match torque {
            false => row,
            true => row
                .group("peak_torque_nm", "peak torque", motor.torque.facts())
                .group("peak_power_w", "peak power", motor.power.facts())
                .pair("rms_torque_nm", "rms torque", load.rms_torque_nm)
                .pair("work_given_j", "work given", load.given_j)
                .pair("work_returned_j", "returned", load.returned_j),
        }
    });
    document.table("motors", motors.collect());
    if let Some(loads) = &peaks.loads {
        add_loads(document, loads);
    }
    let legs = peaks.serial.iter().zip(1..);
    let least = legs.min_by(|(one, _), (other, _)| one.value.total_cmp(&other.value));
    let serial = least.map(|(least, leg): (_, u32)| {
        let leg = leg.to_string();
        least.facts().text("leg", leg).line()
    });
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

/// Extremes that a 3-RRR does not have.
fn add_loads(document: &mut Document, peaks: &LoadPeaks) {
    let sliders = peaks.sliders.iter().map(|slider| {
        let number = slider.leg + 1;
        Facts::new()
            .pair("leg", "", number)
            .words(format!("slider {number}"))
            .group(
                "peak_velocity_m_s",
                "peak velocity",
                slider.velocity.facts(),
            )
            .group("peak_force_n", "peak force", slider.force.facts())
            .group("peak_power_w", "peak power", slider.power.facts())
    });
    document.table("slider_peaks", sliders.collect());
    let (leg, joint) = peaks.joint;
    let is_loaded = peaks.norm.value > peaks.least_norm.value * (1.0 + 1e-9);
    let least = peaks.least_norm.facts();
    let without = is_loaded.then(|| format!("without preload {}", least.line_in(Some("N m"))));
    document.pairs(
        Facts::new()
            .group("torque_norm_max_nm", "torque norm", peaks.norm.facts())
            .text("", without)
            .data("torque_norm_max_without_preload_nm", least)
            .group(
                "joint_force_max_n",
                "joint force",
                joint.facts().text("leg", (leg + 1).to_string()),
            ),
    );
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

/// The run of `scene`, without its plant.
pub(crate) fn document<O>(scene: RunScene, report: &RunReport<O>) -> Document {
    let mut document = Document::new();
    let facts = scene.scene().and(scene.head.clone());
    document.pairs(facts.and(scene.job(report)));
    match &report.job.peaks {
        Some(peaks) => add_peaks(&mut document, peaks, scene.torque, &report.job.loads),
        None => {
            let none = Facts::new().data("motors", ());
            let none = none.data("serial_distance_min", ());
            document.pairs(none.data("parallel_distance_min", ()));
        }
    }
    match &report.job.lagrange {
        Some(found) => document.pairs_in("lagrange", found.record()),
        None => document.data("lagrange", ()),
    };
    if let Some(drives) = &report.drives {
        document.pairs_in("drives", drives.peaks.record());
    }
    document.pairs(scene.times(&report.played));
    document
}
