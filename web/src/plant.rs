//! The plant of a scene under its job: measured against commanded.

use std::sync::atomic::AtomicBool;
use trirrr_drives::stepper::Line;
use trirrr_plant::motor::wrapped;
use trirrr_plant::statistics::{MotorStatistics, Signal};
use trirrr_plant::table::Row;
use trirrr_plant::{Outcome, PlantRun, job};
use trirrr_scene::Scene;
use trirrr_scene::words::short;
use wasm_bindgen::prelude::wasm_bindgen;

/// Columns of the table: time, pose, distance of D from its setpoint, and of each motor the error of its joint and its torque. SI units.
const COLUMNS: [&str; 11] = [
    "t", "x", "y", "alpha", "off", "error1", "error2", "error3", "tau1", "tau2", "tau3",
];

/// A run of a plant in binary64: what the summary of `trirrr run` says, and its table.
#[wasm_bindgen]
#[derive(Clone, Debug)]
pub struct SimulatedPlant {
    /// One list for each of [`COLUMNS`].
    values: Vec<Vec<f64>>,
    outcome: Outcome,
}

impl SimulatedPlant {
    /// Simulates the plant of `scene`; nothing without one.
    pub(crate) fn of(scene: &Scene, rows: u32) -> Result<Option<Self>, String> {
        let Some(settings) = &scene.plant else {
            return Ok(None);
        };
        let span_s = scene.duration_s() + settings.settle_s;
        let every = (span_s / settings.record_s) as u64 / u64::from(rows.max(1)) + 1;
        let mut values = vec![Vec::new(); COLUMNS.len()];
        let mut number = 0;
        let mut keep = |row: &Row| {
            if number % every == 0 {
                for (column, value) in values.iter_mut().zip(values_of(row)) {
                    column.push(value);
                }
            }
            number += 1;
        };
        let outputs = job::outputs(scene).map_err(|refusal| refusal.to_string())?;
        let line = Line::default();
        let run = PlantRun::<f64>::build(scene, &line);
        let mut run = run.map_err(|refusal| refusal.to_string())?;
        for output in &outputs {
            run.tick(output, &mut keep);
        }
        let outcome = run.finish(&AtomicBool::new(false), &mut keep);
        Ok(Some(Self { values, outcome }))
    }

    /// The outcome, for tests.
    pub fn outcome(&self) -> &Outcome {
        &self.outcome
    }

    fn motors(&self) -> &[MotorStatistics; 3] {
        &self.outcome.statistics.motors
    }
}

fn values_of(row: &Row) -> [f64; COLUMNS.len()] {
    let [x, y, alpha] = row.pose;
    let off = (x - row.setpoint[0]).hypot(y - row.setpoint[1]);
    let error = |motor: usize| wrapped(row.references[motor] - row.angles[motor]);
    let [tau1, tau2, tau3] = row.torques;
    [
        row.t,
        x,
        y,
        alpha,
        off,
        error(0),
        error(1),
        error(2),
        tau1,
        tau2,
        tau3,
    ]
}

/// Peak, its time and root mean square.
fn figures(signal: &Signal) -> [f64; 3] {
    [signal.peak, signal.peak_t, signal.rms()]
}

#[wasm_bindgen]
impl SimulatedPlant {
    /// Values of the column `name`; none of a name that is none.
    pub fn values(&self, name: &str) -> Option<Vec<f64>> {
        let column = COLUMNS.iter().position(|column| *column == name)?;
        self.values.get(column).cloned()
    }

    /// Distance of D from its setpoint, m, then the error of alpha, rad: peak, time of the peak, root mean square of each.
    #[wasm_bindgen(getter)]
    pub fn tool(&self) -> Vec<f64> {
        let statistics = &self.outcome.statistics;
        let both = [&statistics.tool_position, &statistics.tool_angle];
        both.into_iter().flat_map(figures).collect()
    }

    /// Motor by motor: peak and root mean square of the error of the joint, rad, the torque, N m, the current, A, and the power, W.
    #[wasm_bindgen(getter)]
    pub fn loads(&self) -> Vec<f64> {
        let of = |motor: &MotorStatistics| {
            let signals = [&motor.error, &motor.torque, &motor.current, &motor.power];
            signals.map(|signal| [signal.peak, signal.rms()])
        };
        let all = self.motors().iter().flat_map(of);
        all.flatten().collect()
    }

    /// Notes on the run: an end before that of the job, saturated motors, lost steps, warnings.
    #[wasm_bindgen(getter)]
    pub fn notes(&self) -> Vec<String> {
        let mut notes: Vec<String> = self.outcome.end.reason().into_iter().collect();
        for (number, motor) in (1..).zip(self.motors()) {
            for (what, active) in [
                ("current", &motor.current_limit),
                ("voltage", &motor.voltage_limit),
            ] {
                notes.extend(active.first.map(|first| {
                    let total = short(active.total);
                    format!("motor {number} saturated ({what}) from t = {first:.4} s, for {total} s in all")
                }));
            }
            notes.extend(motor.first_slip.map(|first| {
                format!(
                    "motor {number} lost steps: {} slips of four full steps, the first at t = {first:.4} s",
                    motor.slips
                )
            }));
        }
        notes.extend(self.outcome.warnings.iter().cloned());
        notes
    }

    /// Energies: how well they close, in parts of the largest.
    #[wasm_bindgen(getter)]
    pub fn balance(&self) -> f64 {
        self.outcome.balance.error().abs()
    }
}
