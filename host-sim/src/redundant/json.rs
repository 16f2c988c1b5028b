//! The summary of a run of a redundant machine as one JSON object.

use super::plant::SimulatedMachine;
use super::play::RedundantReport;
use crate::run::json::{at, times};
use serde_json::{Value, json};
use std::path::Path;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::statistics::Signal;

/// Sliders at the start of the job.
pub(super) fn sliders(scene: &RedundantScene) -> Vec<Value> {
    let legs = scene.sliders.iter().enumerate();
    legs.filter_map(|(leg, slider)| {
        let slider = (*slider)?;
        Some(json!({
            "leg": leg + 1,
            "position_m": slider.position_m,
            "placed": slider.is_placed,
        }))
    })
    .collect()
}

/// Gain of the placement of the sliders.
pub(super) fn placement(scene: &RedundantScene) -> Option<Value> {
    let placement = scene.placement.as_ref()?;
    Some(json!({
        "distance_before": placement.before,
        "distance_after": placement.after,
        "looked_at": placement.looked_at,
    }))
}

/// The run of `scene`, read from `file`.
pub(super) fn summary(file: &Path, scene: &RedundantScene, report: &RedundantReport) -> Value {
    let peaks = report.peaks.as_ref();
    let motors = peaks.map(|peaks| {
        let motor = |motor: &crate::recording::MotorPeaks| {
            json!({
                "peak_rate_rad_s": at(motor.rate),
                "peak_torque_nm": at(motor.torque),
                "peak_power_w": at(motor.power),
            })
        };
        peaks.motors.iter().map(motor).collect::<Vec<_>>()
    });
    let slider_peaks = peaks.map(|peaks| {
        let slider = |slider: &super::peaks::SliderPeaks| {
            json!({
                "leg": slider.leg + 1,
                "peak_velocity_m_s": at(slider.velocity),
                "peak_force_n": at(slider.force),
                "peak_power_w": at(slider.power),
            })
        };
        peaks.sliders.iter().map(slider).collect::<Vec<_>>()
    });
    json!({
        "scene": scene.name,
        "file": file,
        "kind": scene.kind.name(),
        "number": "f64",
        "tick_rate_hz": scene.tick_rate_hz,
        "moves": scene.job.moves.len(),
        "ticks": scene.ticks(),
        "duration_s": scene.duration_s(),
        "setpoints": report.rows,
        "end": if report.is_complete { "complete" } else { "stopped" },
        "elapsed_s": report.elapsed.as_secs_f64(),
        "computing_us": times(&report.computation),
        "jitter_us": report.deadlines.as_ref().map(|deadlines| times(&deadlines.release)),
        "late_ticks": report.deadlines.as_ref().map(|deadlines| deadlines.late),
        "sliders": sliders(scene),
        "placement": placement(scene),
        "motors": motors,
        "slider_peaks": slider_peaks,
        "torque_norm_max_nm": peaks.map(|peaks| at(peaks.norm)),
        "torque_norm_max_without_preload_nm": peaks.map(|peaks| at(peaks.least_norm)),
        "joint_force_max_n": peaks.map(|peaks| at(peaks.joint.1)),
        "serial_distance_min": peaks.map(|peaks| at(peaks.serial.1)),
        "parallel_distance_min": peaks.map(|peaks| at(peaks.parallel)),
        "lagrange": report.lagrange.map(|found| found.json()),
        "plant": report.plant.as_ref().map(plant),
        "files": report.all_files(),
    })
}

fn plant(simulated: &SimulatedMachine) -> Value {
    let outcome = &simulated.outcome;
    let signal =
        |signal: &Signal| json!({ "peak": signal.peak, "t_s": signal.peak_t, "rms": signal.rms() });
    json!({
        "simulated_s": outcome.simulated_s,
        "reason": outcome.failure,
        "steps": outcome.steps,
        "path_error_m": signal(&outcome.path_error),
        "angle_error_rad": signal(&outcome.angle_error),
        "torques_nm": outcome.torques.iter().map(signal).collect::<Vec<_>>(),
        "forces_n": outcome.forces.iter().map(signal).collect::<Vec<_>>(),
        "work_j": outcome.work_j,
        "stored_j": outcome.stored_j,
        "lost_j": outcome.lost_j,
        "balance_error_j": outcome.balance_error_j(),
    })
}
