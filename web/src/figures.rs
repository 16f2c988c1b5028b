//! Figures of a machine at one instant.

use trirrr_core::limits::LimitParameters;
use trirrr_scene::record::{LegRecord, Record};
use trirrr_scene::words::short;
use wasm_bindgen::prelude::wasm_bindgen;

/// Figures of one pose with its motion. Without a motion, lists that need one are empty.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Figures {
    /// Reason why there is no motion at the pose.
    pub reason: Option<String>,
    /// Motor angles, rad.
    pub angles: Vec<f64>,
    /// Motor rates, rad/s.
    pub rates: Vec<f64>,
    /// Motor accelerations, rad/s^2.
    pub accelerations: Vec<f64>,
    /// Torques of the motors at the joints, N m.
    pub torques: Vec<f64>,
    /// Powers of the motors, W.
    pub powers: Vec<f64>,
    /// Distance of each leg from its serial singularity, 0 to 1.
    pub serial: Vec<f64>,
    /// Distance of the machine from its parallel singularity, 0 to 1.
    pub parallel: f64,
    /// Base joints A, m.
    pub base: Vec<f64>,
    /// Elbows B, m.
    pub elbows: Vec<f64>,
    /// Platform joints C, m; known without a motion, too.
    pub platform: Vec<f64>,
    /// Limits of the scene that the instant breaks, a sentence each.
    pub breaches: Vec<String>,
}

impl Figures {
    pub(crate) fn of(record: &Record, limits: &LimitParameters) -> Self {
        let each = |value: fn(&LegRecord) -> f64| record.legs.iter().map(value).collect();
        Self {
            reason: None,
            angles: each(|leg| leg.th1),
            rates: each(|leg| leg.dth1),
            accelerations: each(|leg| leg.ddth1),
            torques: each(|leg| leg.torque),
            powers: each(|leg| leg.power),
            serial: each(|leg| leg.serial),
            parallel: record.parallel,
            base: record.legs.iter().flat_map(|leg| leg.base).collect(),
            elbows: record.legs.iter().flat_map(LegRecord::elbow).collect(),
            platform: joints_of(record),
            breaches: breaches(record, limits),
        }
    }
}

/// Platform joints of a record.
pub(crate) fn joints_of(record: &Record) -> Vec<f64> {
    let joints = record.legs.iter().flat_map(LegRecord::platform_joint);
    joints.collect()
}

/// Limits of the motors in the scene; empty lists where there is none.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MotorLimits {
    /// Largest rates, rad/s.
    pub rates: Vec<f64>,
    /// Largest accelerations, rad/s^2.
    pub accelerations: Vec<f64>,
    /// Largest torques, N m.
    pub torques: Vec<f64>,
    /// Largest powers, W.
    pub powers: Vec<f64>,
    /// Least distance from a serial singularity.
    pub serial: f64,
    /// Least distance from the parallel singularity.
    pub parallel: f64,
}

impl MotorLimits {
    pub(crate) fn of(limits: &LimitParameters) -> Self {
        let list = |limit: Option<[f64; 3]>| limit.map_or_else(Vec::new, Vec::from);
        Self {
            rates: list(limits.rate_rad_s),
            accelerations: list(limits.acceleration_rad_s2),
            torques: list(limits.torque_nm),
            powers: list(limits.power_w),
            serial: limits.serial_distance_min,
            parallel: limits.parallel_distance_min,
        }
    }
}

/// Limits that `record` breaks.
pub(crate) fn breaches(record: &Record, limits: &LimitParameters) -> Vec<String> {
    let mut found = Vec::new();
    for (index, leg) in record.legs.iter().enumerate() {
        let number = index + 1;
        for (name, value, limit, unit) in [
            ("rate", leg.dth1, limits.rate_rad_s, "rad/s"),
            (
                "acceleration",
                leg.ddth1,
                limits.acceleration_rad_s2,
                "rad/s^2",
            ),
            ("torque", leg.torque, limits.torque_nm, "N m"),
            ("power", leg.power, limits.power_w, "W"),
        ] {
            if let Some(limit) = limit.map(|limit| limit[index])
                && value.abs() > limit
            {
                found.push(format!(
                    "{name} of motor {number} is {} {unit}, the most allowed is {} {unit}",
                    short(value.abs()),
                    short(limit)
                ));
            }
        }
        if leg.serial < limits.serial_distance_min {
            found.push(format!(
                "leg {number} is {} from its serial singularity, the least allowed is {}",
                short(leg.serial),
                short(limits.serial_distance_min)
            ));
        }
    }
    if record.parallel < limits.parallel_distance_min {
        found.push(format!(
            "the machine is {} from its parallel singularity, the least allowed is {}",
            short(record.parallel),
            short(limits.parallel_distance_min)
        ));
    }
    found
}
