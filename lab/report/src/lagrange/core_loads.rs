//! Torques and forces of the core for a machine with any number of legs.

use nalgebra::Vector3;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_linkage::redundant::{RedundantMachine, RedundantParameters, SliderState};
use trirrr_scene::pipeline;
use trirrr_truth::lagrange::{LagrangeMachine, LagrangeState};

/// Nearest that a state may be to a singularity.
const DISTANCE_MIN: f64 = 0.05;

/// Torques of the motors and forces of the sliders.
pub(super) struct CoreLoads {
    pub(super) torques: Vec<f64>,
    pub(super) forces: Vec<Option<f64>>,
    /// Greatest force of a base joint or a slider, N.
    pub(super) force_scale: f64,
    pub(super) parallel: f64,
}

impl CoreLoads {
    /// Loads of `machine`. A 3-RRR is computed by the tick, the others by the pipeline of redundant machines.
    ///
    /// Returns `None` where the machine has no motion, or is near a singularity.
    pub(super) fn of(
        machine: &LagrangeMachine,
        state: &LagrangeState,
        wanted: &[f64],
    ) -> Option<Self> {
        let has_slider = machine.sliders.iter().any(Option::is_some);
        match machine.legs.len() {
            3 if !has_slider => of_tick(machine, state),
            3 => of_legs::<3>(machine, state, wanted),
            4 => of_legs::<4>(machine, state, wanted),
            _ => of_legs::<6>(machine, state, wanted),
        }
    }
}

fn setpoint(state: &LagrangeState) -> Setpoint<f64> {
    let [x, y, alpha] = state.platform;
    Setpoint {
        pose: Pose::from_f64(x[0], y[0], alpha[0]),
        velocity: Vector3::new(x[1], y[1], alpha[1]),
        acceleration: Vector3::new(x[2], y[2], alpha[2]),
    }
}

fn of_tick(machine: &LagrangeMachine, state: &LagrangeState) -> Option<CoreLoads> {
    let parameters = Parameters {
        legs: machine.legs.as_slice().try_into().ok()?,
        platform: machine.platform,
        gravity_m_s2: machine.gravity.into(),
        wrench_force_n: machine.force.into(),
        wrench_torque_nm: machine.moment,
    };
    let tick = pipeline::build::<f64>(&parameters).ok()?;
    let record = tick.evaluate(0.0, &setpoint(state)).ok()?;
    let nearest = record.legs.iter().map(|leg| leg.serial);
    (nearest.fold(record.parallel, f64::min) > DISTANCE_MIN).then(|| CoreLoads {
        torques: record.legs.iter().map(|leg| leg.torque).collect(),
        forces: vec![None; 3],
        force_scale: 1.0,
        parallel: record.parallel,
    })
}

fn of_legs<const LEGS: usize>(
    machine: &LagrangeMachine,
    state: &LagrangeState,
    wanted: &[f64],
) -> Option<CoreLoads> {
    let parameters = RedundantParameters::<LEGS> {
        legs: machine.legs.as_slice().try_into().ok()?,
        sliders: machine.sliders.as_slice().try_into().ok()?,
        platform: machine.platform,
        gravity_m_s2: machine.gravity.into(),
        wrench_force_n: machine.force.into(),
        wrench_torque_nm: machine.moment,
    };
    let built = RedundantMachine::<f64, LEGS>::build(&parameters).ok()?;
    let states: [SliderState<f64>; LEGS] = std::array::from_fn(|leg| {
        let [position, velocity, acceleration] = state.sliders[leg];
        SliderState {
            position,
            velocity,
            acceleration,
        }
    });
    let setpoint = setpoint(state);
    let at = states.map(|state| state.position);
    let distances = built.distances(&setpoint.pose, &at).ok()?;
    let serial = distances.serial.into_iter();
    if serial.fold(distances.parallel, f64::min) <= DISTANCE_MIN {
        return None;
    }
    let wanted = wanted.try_into().ok()?;
    let motion = built.evaluate(&setpoint, &states, &wanted).ok()?;
    let forces: Vec<Option<f64>> = motion
        .sliders
        .iter()
        .map(|slider| slider.map(|slider| slider.force))
        .collect();
    let joints = motion.joints.iter().map(|it| it.base.x.hypot(it.base.y));
    let sizes = joints.chain(forces.iter().flatten().map(|force| force.abs()));
    Some(CoreLoads {
        torques: motion.motors.iter().map(|motor| motor.torque).collect(),
        force_scale: sizes.fold(0.0, f64::max),
        forces,
        parallel: motion.parallel,
    })
}
