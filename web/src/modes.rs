//! Working modes and assembly modes, as the page lists them.

use crate::figures::{breaches, joints_of};
use trirrr_core::forward::Completeness;
use trirrr_core::machine::Elbow;
use trirrr_design::assembly::{AssemblyModes, elbows_of};
use trirrr_scene::Limits;
use trirrr_scene::record::{LegRecord, Record};
use wasm_bindgen::prelude::wasm_bindgen;

/// The machine in one of its eight working modes at a pose.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WorkingMode {
    /// Elbow signs, such as `+-+`.
    pub name: String,
    /// It is the mode of the scene.
    #[wasm_bindgen(js_name = isOwn)]
    pub is_own: bool,
    /// Reason why the mode is not possible here: no motion, or a limit that breaks.
    pub reason: Option<String>,
    /// Motor angles, rad; empty without a motion.
    pub angles: Vec<f64>,
    /// Torques of the motors, N m; empty without a motion.
    pub torques: Vec<f64>,
    /// Least distance of a leg from its serial singularity.
    pub serial: f64,
    /// Distance from the parallel singularity.
    pub parallel: f64,
    /// Elbows B, m; empty without a motion.
    pub elbows: Vec<f64>,
}

impl WorkingMode {
    pub(crate) fn of(
        elbows: [Elbow; 3],
        is_own: bool,
        evaluated: Result<Record, String>,
        limits: &Limits,
    ) -> Self {
        let name = elbows.map(|elbow| sign(Some(elbow))).concat();
        match evaluated {
            Ok(record) => Self {
                name,
                is_own,
                reason: breaches(&record, limits).into_iter().next(),
                angles: record.legs.iter().map(|leg| leg.th1).collect(),
                torques: record.legs.iter().map(|leg| leg.torque).collect(),
                serial: record.legs.iter().map(|leg| leg.serial).fold(1.0, f64::min),
                parallel: record.parallel,
                elbows: record.legs.iter().flat_map(LegRecord::elbow).collect(),
            },
            Err(reason) => Self {
                name,
                is_own,
                reason: Some(reason),
                ..Self::default()
            },
        }
    }
}

/// The platform in one of its assembly modes.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblyMode {
    /// Pose: x and y in m, alpha in rad.
    pub pose: Vec<f64>,
    /// Elbow signs, such as `+-+`; `0` of a leg that is stretched or folded.
    pub name: String,
    /// Distance from the parallel singularity.
    pub parallel: f64,
    /// Platform joints C, m.
    pub platform: Vec<f64>,
    /// Two modes meet here.
    #[wasm_bindgen(js_name = isDouble)]
    pub is_double: bool,
    /// It is the mode nearest to the pose that was asked for.
    #[wasm_bindgen(js_name = isHere)]
    pub is_here: bool,
}

/// All assembly modes for three motor angles.
#[wasm_bindgen(getter_with_clone)]
#[derive(Clone, Debug, PartialEq)]
pub struct AssemblyList {
    /// The modes, by the angle of the platform.
    pub modes: Vec<AssemblyMode>,
    /// The list is known to be complete.
    #[wasm_bindgen(js_name = isComplete)]
    pub is_complete: bool,
}

impl AssemblyList {
    pub(crate) fn of(found: &AssemblyModes, here: Option<usize>) -> Self {
        let modes = found.modes.iter().enumerate().map(|(index, mode)| {
            let record = &mode.record;
            AssemblyMode {
                pose: record.pose.into(),
                name: elbows_of(record).map(sign).concat(),
                parallel: record.parallel,
                platform: joints_of(record),
                is_double: mode.double,
                is_here: here == Some(index),
            }
        });
        Self {
            modes: modes.collect(),
            is_complete: found.completeness != Completeness::Undecided,
        }
    }
}

fn sign(elbow: Option<Elbow>) -> &'static str {
    match elbow {
        Some(Elbow::Positive) => "+",
        Some(Elbow::Negative) => "-",
        None => "0",
    }
}
