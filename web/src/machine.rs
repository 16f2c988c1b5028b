//! The machine of a scene, asked about poses.

use crate::figures::{Figures, MotorLimits};
use crate::modes::{AssemblyList, WorkingMode};
use nalgebra::Vector3;
use trirrr_core::machine::{LegParameters, Parameters};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_design::assembly::{AssemblyModes, reach_gaps_m};
use trirrr_design::modes::MODES;
use trirrr_scene::pipeline::{self, Pipeline};
use trirrr_scene::words::short;
use trirrr_scene::{Limits, Scene};
use wasm_bindgen::prelude::wasm_bindgen;

/// Values of a state: pose, velocity and acceleration of the platform, three each.
const STATE: usize = 9;

/// Machine of a scene in f64, with torques.
#[wasm_bindgen]
pub struct Machine {
    name: String,
    description: String,
    parameters: Parameters,
    limits: Limits,
    start: [f64; 3],
    own: Box<dyn Pipeline<f64>>,
    /// The machine in its eight working modes, in the order of [`MODES`].
    modes: Vec<Box<dyn Pipeline<f64>>>,
}

impl Machine {
    pub(crate) fn of(scene: &Scene) -> Result<Self, String> {
        let parameters = scene.parameters;
        let build = |parameters: &Parameters| {
            pipeline::build::<f64>(parameters).map_err(|error| error.to_string())
        };
        let in_mode = |elbows: &[trirrr_core::machine::Elbow; 3]| {
            let mut changed = parameters;
            for (leg, elbow) in changed.legs.iter_mut().zip(elbows) {
                leg.elbow = *elbow;
            }
            build(&changed)
        };
        let start = scene.job.start;
        Ok(Self {
            name: scene.name.clone(),
            description: scene.description.clone(),
            parameters,
            limits: scene.limits,
            start: [start.position.x, start.position.y, start.angle],
            own: build(&parameters)?,
            modes: MODES.iter().map(in_mode).collect::<Result<_, _>>()?,
        })
    }
}

#[wasm_bindgen]
impl Machine {
    /// Name of the scene.
    #[wasm_bindgen(getter)]
    pub fn name(&self) -> String {
        self.name.clone()
    }

    /// Description of the scene; may be empty.
    #[wasm_bindgen(getter)]
    pub fn description(&self) -> String {
        self.description.clone()
    }

    /// Pose in which the job starts: x and y in m, alpha in rad.
    #[wasm_bindgen(getter)]
    pub fn start(&self) -> Vec<f64> {
        self.start.into()
    }

    /// Limits of the motors.
    #[wasm_bindgen(getter)]
    pub fn limits(&self) -> MotorLimits {
        MotorLimits::of(&self.limits)
    }

    /// Rectangle around the base joints with room for a proximal link beside each: least x and y, largest x and y, m.
    #[wasm_bindgen(getter)]
    pub fn frame(&self) -> Vec<f64> {
        let legs = &self.parameters.legs;
        let side = |of: fn(&LegParameters) -> f64, least: fn(f64, f64) -> f64| {
            legs.iter().map(of).reduce(least).unwrap_or_default()
        };
        vec![
            side(|leg| leg.base_m.x - leg.proximal_m, f64::min),
            side(|leg| leg.base_m.y - leg.proximal_m, f64::min),
            side(|leg| leg.base_m.x + leg.proximal_m, f64::max),
            side(|leg| leg.base_m.y + leg.proximal_m, f64::max),
        ]
    }

    /// Figures of a state of the platform: pose, velocity, acceleration.
    ///
    /// # Errors
    /// The state has not nine finite values.
    pub fn figures(&self, state: &[f64]) -> Result<Figures, String> {
        let setpoint = setpoint_of(state)?;
        Ok(match self.own.evaluate(0.0, &setpoint) {
            Ok(record) => Figures::of(&record, &self.limits),
            Err(status) => Figures {
                reason: Some(self.reason(&setpoint.pose, status)),
                base: self.parameters.legs.iter().flat_map(base_of).collect(),
                platform: self.platform(&setpoint.pose),
                ..Figures::default()
            },
        })
    }

    /// The machine in its eight working modes, in a state of the platform.
    ///
    /// # Errors
    /// As [`figures`](Self::figures).
    #[wasm_bindgen(js_name = workingModes)]
    pub fn working_modes(&self, state: &[f64]) -> Result<Vec<WorkingMode>, String> {
        let setpoint = setpoint_of(state)?;
        let own = self.parameters.legs.each_ref().map(|leg| leg.elbow);
        let modes = MODES.iter().zip(&self.modes).map(|(elbows, machine)| {
            let evaluated = machine.evaluate(0.0, &setpoint);
            let evaluated = evaluated.map_err(|status| self.reason(&setpoint.pose, status));
            WorkingMode::of(*elbows, *elbows == own, evaluated, &self.limits)
        });
        Ok(modes.collect())
    }

    /// All poses of the platform for motor `angles`, rad. The mode nearest to `pose` is marked.
    ///
    /// # Errors
    /// Not three finite angles, or there is no finite list of modes.
    pub fn assemblies(&self, angles: &[f64], pose: &[f64]) -> Result<AssemblyList, String> {
        let angles = three(angles, "angles")?;
        let [x, y, alpha] = three(pose, "values of a pose")?;
        let found = AssemblyModes::of(&self.parameters, angles);
        let found = found.map_err(|fault| fault.to_string())?;
        let here = found.nearest(&self.parameters, Pose::from_f64(x, y, alpha));
        Ok(AssemblyList::of(&found, here))
    }
}

impl Machine {
    /// Platform joints at a pose, also where no leg reaches.
    fn platform(&self, pose: &Pose<f64>) -> Vec<f64> {
        let joints = self.parameters.legs.iter().flat_map(|leg| {
            let angle = pose.angle + leg.joint_angle_rad;
            [
                pose.position.x + leg.joint_radius_m * angle.cos(),
                pose.position.y + leg.joint_radius_m * angle.sin(),
            ]
        });
        joints.collect()
    }

    /// The reason why a pose has no motion, with the lengths that are missing.
    fn reason(&self, pose: &Pose<f64>, status: Status) -> String {
        let gaps = reach_gaps_m(&self.parameters, *pose);
        let gaps = (1..).zip(gaps).filter_map(|(leg, gap)| match gap {
            gap if gap > 0.0 => Some(format!("leg {leg} is {} mm too short", short(gap * 1e3))),
            gap if gap < 0.0 => Some(format!("leg {leg} is {} mm too long", short(gap * -1e3))),
            _ => None,
        });
        let gaps: Vec<String> = gaps.collect();
        match gaps.is_empty() {
            true => status.to_string(),
            false => format!("unreachable: {}", gaps.join(", ")),
        }
    }
}

fn base_of(leg: &LegParameters) -> [f64; 2] {
    leg.base_m.into()
}

fn three(values: &[f64], what: &str) -> Result<[f64; 3], String> {
    let values = <[f64; 3]>::try_from(values).ok();
    let values = values.filter(|values| values.iter().all(|value| value.is_finite()));
    values.ok_or_else(|| format!("expected three finite {what}"))
}

fn setpoint_of(state: &[f64]) -> Result<Setpoint<f64>, String> {
    let state = <[f64; STATE]>::try_from(state).ok();
    let state = state.filter(|values| values.iter().all(|value| value.is_finite()));
    let [x, y, alpha, vx, vy, valpha, ax, ay, aalpha] = state
        .ok_or("expected nine finite numbers: pose, velocity and acceleration of the platform")?;
    Ok(Setpoint {
        pose: Pose::from_f64(x, y, alpha),
        velocity: Vector3::new(vx, vy, valpha),
        acceleration: Vector3::new(ax, ay, aalpha),
    })
}
