//! A run: loops sampled at every tick, the bodies between the ticks, and what it was worth.

use super::bodies::energy;
use super::dynamics::{Coordinates, Dynamics, Joints};
use super::{COORDINATES, SLIDERS};
use crate::motor::wrapped;
use crate::refusal::Refusal;
use crate::statistics::Signal;
use std::sync::atomic::{AtomicBool, Ordering};
use trirrr_core::status::Status;
use trirrr_integrate::{Integrator, Method, System};
use trirrr_linkage::redundant::scene::{
    RedundantLoop, RedundantPipeline, RedundantPlayer, RedundantRecord, RedundantScene,
};
use trirrr_linkage::redundant::{RedundantMachine, RedundantParameters};

/// State: coordinates, rates, work put in, work lost in friction.
const STATE: usize = 2 * COORDINATES + 2;
const WORK: usize = 2 * COORDINATES;
const LOST: usize = WORK + 1;

/// Machine and loops at a tick, before the loops answer.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RedundantRow {
    /// Time since the start of the job, s.
    pub t: f64,
    /// Pose of the platform: m, m, rad.
    pub pose: [f64; 3],
    /// Pose less that of the setpoint.
    pub error: [f64; 3],
    /// Angle of each motor less that of the setpoint, rad.
    pub joint_errors: Vec<f64>,
    /// Torque of each motor until the next tick, N m.
    pub torques: Vec<f64>,
    /// Position of each slider less that of the setpoint, m; none for a leg without one.
    pub slider_errors: Vec<Option<f64>>,
    /// Force of each slider until the next tick, N; none for a leg without one.
    pub forces: Vec<Option<f64>>,
}

/// Result of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RedundantOutcome {
    /// Time that was simulated, s.
    pub simulated_s: f64,
    /// Reason why the run ended early, if it did.
    pub failure: Option<String>,
    /// The caller stopped the run.
    pub is_stopped: bool,
    /// Distance of D from its setpoint, m.
    pub path_error: Signal,
    /// Angle of the platform less that of the setpoint, rad.
    pub angle_error: Signal,
    /// Torque of each motor, N m.
    pub torques: Vec<Signal>,
    /// Force of each slider, N, in the order of the legs that have one.
    pub forces: Vec<Signal>,
    /// Work of motors, sliders and wrench, J.
    pub work_j: f64,
    /// Energy gained by the bodies, J.
    pub stored_j: f64,
    /// Work lost in friction, J.
    pub lost_j: f64,
    /// Integration steps.
    pub steps: u64,
}

impl RedundantOutcome {
    /// Work that is neither stored nor lost, J: the error of the simulation.
    pub fn balance_error_j(&self) -> f64 {
        self.work_j - self.stored_j - self.lost_j
    }
}

/// Simulates the machine of `scene` under its `[plant]` loops, over the job. Rows go to `sink`, one for each tick; `stop`
/// ends the run early.
///
/// # Errors
/// A scene without a plant, or a machine that is refused.
pub fn simulate(
    scene: &RedundantScene,
    stop: &AtomicBool,
    sink: &mut dyn FnMut(&RedundantRow),
) -> Result<RedundantOutcome, Refusal> {
    match scene.kind.legs() {
        4 => simulate_legs::<4>(scene, stop, sink),
        6 => simulate_legs::<6>(scene, stop, sink),
        _ => simulate_legs::<3>(scene, stop, sink),
    }
}

fn simulate_legs<const LEGS: usize>(
    scene: &RedundantScene,
    stop: &AtomicBool,
    sink: &mut dyn FnMut(&RedundantRow),
) -> Result<RedundantOutcome, Refusal> {
    let refused = |reason: &dyn std::fmt::Display| Refusal::Machine(reason.to_string());
    let loops = scene
        .plant
        .ok_or_else(|| refused(&"the scene has no [plant]"))?;
    let mut parameters = scene
        .parameters::<LEGS>()
        .ok_or_else(|| refused(&"another number of legs"))?;
    parameters.platform.mass_kg += loops.extra_mass_kg;
    let machine = RedundantMachine::build(&parameters).map_err(|error| refused(&error))?;
    let directions = parameters.sliders.map(|it| it.map(|it| it.direction_rad));
    let mut plant = SampledPlant {
        dynamics: Dynamics::new(machine, &directions),
        parameters,
        loops,
        torques: [0.0; LEGS],
        forces: [0.0; SLIDERS],
    };
    let model = scene.pipeline().map_err(|error| refused(&error))?;
    let player = RedundantPlayer::new(scene);
    let mut run = RedundantRun {
        rate_hz: scene.tick_rate_hz,
        model: &*model,
        player: &player,
        stop,
        sink,
    };
    run.simulate(&mut plant)
}

/// Machine whose loops hold their torques from tick to tick.
struct SampledPlant<const LEGS: usize> {
    dynamics: Dynamics<LEGS>,
    parameters: RedundantParameters<LEGS>,
    loops: RedundantLoop,
    torques: [f64; LEGS],
    forces: [f64; SLIDERS],
}

fn split(y: &[f64; STATE]) -> (Coordinates, Coordinates) {
    (
        std::array::from_fn(|i| y[i]),
        std::array::from_fn(|i| y[COORDINATES + i]),
    )
}

impl<const LEGS: usize> SampledPlant<LEGS> {
    fn still(&self, y: &[f64; STATE]) -> Result<Joints<LEGS>, Status> {
        let (q, v) = split(y);
        self.dynamics.joints(&q, &v, &[0.0; COORDINATES])
    }

    fn energy(&self, joints: &Joints<LEGS>, y: &[f64; STATE]) -> f64 {
        let (q, v) = split(y);
        energy(&self.parameters, &self.dynamics, joints, &q, &v)
    }

    /// Lets the loops answer to the state `y`, and returns the row of the tick.
    fn sample(
        &mut self,
        record: &RedundantRecord,
        joints: &Joints<LEGS>,
        y: &[f64; STATE],
    ) -> RedundantRow {
        let loops = &self.loops;
        let ahead = if loops.feed_forward { 1.0 } else { 0.0 };
        let mut row = RedundantRow {
            t: record.t,
            pose: [y[0], y[1], y[2]],
            error: [0, 1, 2].map(|axis: usize| y[axis] - record.pose[axis]),
            slider_errors: vec![None; LEGS],
            forces: vec![None; LEGS],
            ..RedundantRow::default()
        };
        for (index, leg) in record.legs.iter().enumerate() {
            let motor = &joints.motion.motors[index];
            let error = wrapped(motor.angle - leg.leg.th1);
            let rate_error = motor.rate - leg.leg.dth1;
            self.torques[index] =
                ahead * leg.leg.torque - loops.kp_nm_rad * error - loops.kd_nm_s_rad * rate_error;
            row.joint_errors.push(error);
        }
        row.torques = self.torques.to_vec();
        for (number, &leg) in self.dynamics.sliders.iter().enumerate() {
            let wanted = record.legs[leg].slider.unwrap_or_default();
            let error = y[3 + number] - wanted.position;
            let rate_error = y[COORDINATES + 3 + number] - wanted.velocity;
            let force = ahead * wanted.force
                - loops.slider_kp_n_m * error
                - loops.slider_kd_n_s_m * rate_error;
            self.forces[number] = force;
            row.slider_errors[leg] = Some(error);
            row.forces[leg] = Some(force);
        }
        row
    }
}

impl<const LEGS: usize> System<STATE> for SampledPlant<LEGS> {
    type Refusal = Status;

    fn derivative(&self, _: f64, y: &[f64; STATE], dy: &mut [f64; STATE]) -> Result<(), Status> {
        let (q, v) = split(y);
        let joints = self.still(y)?;
        let mut torques = self.torques;
        let mut forces = self.forces;
        let (mut work, mut lost) = (0.0, 0.0);
        for (torque, motor) in torques.iter_mut().zip(&joints.motion.motors) {
            let friction = self.loops.friction_nm_s_rad * motor.rate;
            work += *torque * motor.rate;
            lost += friction * motor.rate;
            *torque -= friction;
        }
        for number in 0..self.dynamics.sliders.len() {
            let rate = v[3 + number];
            let friction = self.loops.slider_friction_n_s_m * rate;
            work += forces[number] * rate;
            lost += friction * rate;
            forces[number] -= friction;
        }
        let wrench = self.parameters.wrench_force_n;
        work += wrench.x * v[0] + wrench.y * v[1] + self.parameters.wrench_torque_nm * v[2];
        let a = self
            .dynamics
            .accelerations(&q, &v, &joints, &torques, &forces)?;
        dy[..COORDINATES].copy_from_slice(&v);
        dy[COORDINATES..WORK].copy_from_slice(&a);
        (dy[WORK], dy[LOST]) = (work, lost);
        Ok(())
    }

    fn scales(&self) -> [f64; STATE] {
        let mut scales = [0.1; STATE];
        (scales[WORK], scales[LOST]) = (f64::INFINITY, f64::INFINITY);
        scales
    }
}

struct RedundantRun<'a> {
    rate_hz: f64,
    model: &'a dyn RedundantPipeline,
    player: &'a RedundantPlayer<'a>,
    stop: &'a AtomicBool,
    sink: &'a mut dyn FnMut(&RedundantRow),
}

impl RedundantRun<'_> {
    fn simulate<const LEGS: usize>(
        &mut self,
        plant: &mut SampledPlant<LEGS>,
    ) -> Result<RedundantOutcome, Refusal> {
        let refused = |reason: &dyn std::fmt::Display| Refusal::Machine(reason.to_string());
        let method = Method::DormandPrince {
            tolerance: Method::DORMAND_PRINCE_TOLERANCE,
        };
        let mut integrator = Integrator::new(&*plant, method).map_err(|error| refused(&error))?;
        let mut y = self.start(plant);
        let at_start = plant.still(&y).map_err(|status| refused(&status))?;
        let energy_at_start = plant.energy(&at_start, &y);
        let mut outcome = RedundantOutcome {
            simulated_s: 0.0,
            failure: None,
            is_stopped: false,
            path_error: Signal::default(),
            angle_error: Signal::default(),
            torques: vec![Signal::default(); LEGS],
            forces: vec![Signal::default(); plant.dynamics.sliders.len()],
            work_j: 0.0,
            stored_j: 0.0,
            lost_j: 0.0,
            steps: 0,
        };
        for tick in 0..=self.player.ticks() {
            let t = f64::from(tick) / self.rate_hz;
            if self.stop.load(Ordering::Relaxed) {
                outcome.is_stopped = true;
                break;
            }
            let sampled = plant.still(&y).and_then(|joints| {
                let record = self.player.record(self.model, tick)?;
                Ok((
                    plant.sample(&record, &joints, &y),
                    plant.energy(&joints, &y),
                ))
            });
            let (row, energy) = match sampled {
                Ok(sampled) => sampled,
                Err(status) => {
                    outcome.failure = Some(format!("at t = {t} s: {status}"));
                    break;
                }
            };
            outcome.take(&row, plant);
            outcome.simulated_s = t;
            outcome.stored_j = energy - energy_at_start;
            (outcome.work_j, outcome.lost_j) = (y[WORK], y[LOST]);
            (self.sink)(&row);
            if tick == self.player.ticks() {
                break;
            }
            integrator.input_changed();
            let next = f64::from(tick + 1) / self.rate_hz;
            if let Err(failure) = integrator.advance(plant, t, &mut y, next, |_, _| ()) {
                outcome.failure = Some(failure.to_string());
                break;
            }
        }
        outcome.steps = integrator.tally().steps;
        Ok(outcome)
    }

    /// State at rest at the start of the job.
    fn start<const LEGS: usize>(&self, plant: &SampledPlant<LEGS>) -> [f64; STATE] {
        let pose = self.player.platform(0).pose;
        let sliders = self.player.sliders(0);
        let mut y = [0.0; STATE];
        y[..3].copy_from_slice(&[pose.position.x, pose.position.y, pose.angle]);
        for (number, &leg) in plant.dynamics.sliders.iter().enumerate() {
            y[3 + number] = sliders[leg].position;
        }
        y
    }
}

impl RedundantOutcome {
    fn take<const LEGS: usize>(&mut self, row: &RedundantRow, plant: &SampledPlant<LEGS>) {
        self.path_error
            .push(row.t, row.error[0].hypot(row.error[1]));
        self.angle_error.push(row.t, row.error[2]);
        let torques = self.torques.iter_mut().zip(&plant.torques);
        torques.for_each(|(signal, &torque)| signal.push(row.t, torque));
        let forces = self.forces.iter_mut().zip(&plant.forces);
        forces.for_each(|(signal, &force)| signal.push(row.t, force));
    }
}
