//! The summary of a run as one JSON object.

use super::plant::Simulated;
use super::{JobEnd, RunReport};
use crate::histogram::Histogram;
use crate::recording::At;
use serde_json::{Value, json};
use std::path::Path;
use trirrr_plant::statistics::{Active, Signal};
use trirrr_scene::Scene;

/// The run of `scene`, read from `file`.
pub(super) fn summary(file: &Path, scene: &Scene, report: &RunReport) -> Value {
    let (end, reason) = match &report.end {
        JobEnd::Complete => ("complete", None),
        JobEnd::Stopped => ("stopped", None),
        JobEnd::Refused(why) => ("refused", Some(why)),
        JobEnd::Fault(what) => ("fault", Some(what)),
    };
    json!({
        "scene": scene.name,
        "file": file,
        "number": report.scalar.name(),
        "tick_rate_hz": scene.tick_rate_hz,
        "moves": scene.job.count(),
        "ticks": scene.ticks(),
        "duration_s": scene.duration_s(),
        "setpoints": report.records,
        "end": end,
        "reason": reason,
        "elapsed_s": report.elapsed.as_secs_f64(),
        "computing_us": times(&report.computation),
        "jitter_us": report.deadlines.as_ref().map(|deadlines| times(&deadlines.release)),
        "late_ticks": report.deadlines.as_ref().map(|deadlines| deadlines.late),
        "motors": motors(scene, report),
        "serial_distance_min": report.peaks.map(|peaks| peaks.serial.map(at)),
        "parallel_distance_min": report.peaks.map(|peaks| at(peaks.parallel)),
        "lagrange": report.lagrange.map(|found| found.json()),
        "plant": report.plant.as_ref().map(plant),
        "files": report.all_files(),
    })
}

pub(crate) fn at(at: At) -> Value {
    json!({ "value": at.value, "t_s": at.t })
}

/// Microseconds.
pub(crate) fn times(times: &Histogram) -> Value {
    let us = |time: std::time::Duration| time.as_secs_f64() * 1e6;
    json!({
        "min": us(times.min()),
        "median": us(times.percentile(50.0)),
        "p99": us(times.percentile(99.0)),
        "max": us(times.max()),
    })
}

fn motors(scene: &Scene, report: &RunReport) -> Option<Vec<Value>> {
    let motors = report.peaks?.motors;
    let each = motors.iter().zip(&report.loads).map(|(motor, load)| {
        match scene.torque {
            // A scene without torques has rates only.
            false => json!({ "peak_rate_rad_s": at(motor.rate) }),
            true => json!({
                "peak_rate_rad_s": at(motor.rate),
                "peak_torque_nm": at(motor.torque),
                "peak_power_w": at(motor.power),
                "rms_torque_nm": load.rms_torque_nm,
                "work_given_j": load.given_j,
                "work_returned_j": load.returned_j,
            }),
        }
    });
    Some(each.collect())
}

fn plant(simulated: &Simulated) -> Value {
    let outcome = &simulated.outcome;
    let signal =
        |signal: &Signal| json!({ "peak": signal.peak, "t_s": signal.peak_t, "rms": signal.rms() });
    let active = |active: &Active| json!({ "first_s": active.first, "total_s": active.total });
    let statistics = &outcome.statistics;
    let motors = statistics.motors.iter().map(|motor| {
        json!({
            "joint_error_rad": signal(&motor.error),
            "torque_nm": signal(&motor.torque),
            "current_a": signal(&motor.current),
            "power_w": signal(&motor.power),
            "current_limit": active(&motor.current_limit),
            "voltage_limit": active(&motor.voltage_limit),
            "first_slip_s": motor.first_slip,
            "slips": motor.slips,
            "lost_steps": motor.lost_steps,
        })
    });
    json!({
        "simulated_s": outcome.simulated_s,
        "elapsed_s": outcome.elapsed.as_secs_f64(),
        "reason": simulated.reason(),
        "method": outcome.method.name(),
        "steps": outcome.tally.steps,
        "warnings": outcome.warnings,
        "tool_position_error_m": signal(&statistics.tool_position),
        "tool_angle_error_rad": signal(&statistics.tool_angle),
        "motors": motors.collect::<Vec<Value>>(),
        "work_j": outcome.balance.work,
        "stored_j": outcome.balance.stored,
        "losses_j": outcome.balance.losses,
        "balance_error_j": outcome.balance.error(),
    })
}
