//! Identification of the free parameters from samples.

use super::bodies::{BODY_COUNT, BodyGroup, BodyVector, body_name, is_viscous_of_motor};
use super::equations::{TorqueEquation, equations, rms};
use super::expected::scales;
use super::linear::LinearProblem;
use super::motion::{period_of, poses, smooth};
use super::regressor::UnitMachines;
use super::result::{
    ExplainedTorque, Identification, IdentificationRefusal, IdentificationSetup, LEAST_EQUATIONS,
    LEAST_SAMPLES,
};
use super::telemetry::JointSample;
use super::units::wrong_factor;
use crate::parameter::KinematicVector;
use trirrr_core::machine::Parameters;

/// Width of the filter, in usual distances of samples.
const WIDTH: f64 = 6.0;

/// Part of a parameter that has to be seen: below it is held, and the motion says nothing of its deviation.
const LEAST_SHARE: f64 = 0.005;

/// Each so many blocks one is kept out of the fit that is checked.
const CHECKED_EVERY: usize = 5;

/// Identifies the free parameters of the machine of `machine`, whose first sample is near the pose `start` (m, m, rad). `friction` is the viscous and
/// Coulomb friction that is known of the motors.
///
/// # Errors
/// [`IdentificationRefusal`]: samples that fit no pose, or a motion that sees nothing.
pub fn identify(
    machine: &Parameters,
    start: [f64; 3],
    friction: [[f64; 2]; 3],
    samples: &[JointSample],
    setup: &IdentificationSetup,
) -> Result<Identification, IdentificationRefusal> {
    let too_few = |used: usize, hint: &'static str| IdentificationRefusal::TooFew {
        samples: samples.len(),
        used,
        hint,
    };
    if samples.len() < LEAST_SAMPLES {
        return Err(too_few(0, "record a longer motion"));
    }
    if samples.iter().all(|sample| sample.torques_nm == [0.0; 3]) {
        return Err(IdentificationRefusal::NoTorque);
    }
    let geometry = KinematicVector::of(machine, [0.0; 3], [0.0; 3]);
    let poses = poses(&geometry, start, samples).map_err(IdentificationRefusal::Row)?;
    let period_s = period_of(samples);
    let width_s = setup
        .width_s
        .unwrap_or(WIDTH * period_s)
        .max(0.5 * period_s);
    let states = smooth(samples, &poses, width_s, period_s);
    let machines = UnitMachines::new(machine).ok_or(IdentificationRefusal::Machine)?;
    let equations = equations(&machines, &states, setup, width_s);
    if equations.len() < LEAST_EQUATIONS {
        let hint = "record a longer motion whose joints turn steadily, or give a smaller --smooth or --sliding";
        return Err(too_few(equations.len(), hint));
    }

    let nominal = BodyVector::of(machine, friction);
    let is_free = |index: &usize| setup.free.contains(&BodyGroup::of(*index));
    // The columns of viscous friction and of readings are the same ones.
    let is_hidden =
        |index: &usize| setup.free.contains(&BodyGroup::Readings) && is_viscous_of_motor(*index);
    let (hidden, free): (Vec<usize>, Vec<usize>) =
        (0..BODY_COUNT).filter(is_free).partition(is_hidden);
    let scales = scales(machine, &equations);
    // Neighbours share most of what the filter has averaged.
    let shared = (2.0 * std::f64::consts::PI.sqrt() * width_s / period_s).max(1.0);
    let all: Vec<&TorqueEquation> = equations.iter().collect();
    if let Some(factor) = wrong_factor(&all, &nominal) {
        return Err(IdentificationRefusal::Factor(factor));
    }
    let problem = LinearProblem {
        nominal,
        free: free.clone(),
        scales: free.iter().map(|index| scales[*index]).collect(),
        shared,
        held: Vec::new(),
    };
    let (problem, solved) = problem.without_negatives(&all);
    if solved.sight.seen.ncols() == 0 {
        let [blind, weak] = problem.words(&solved.sight, machine);
        return Err(IdentificationRefusal::Blind(
            [blind, weak].concat().join("; "),
        ));
    }
    let checked = |equation: &&&TorqueEquation| equation.block % CHECKED_EVERY == CHECKED_EVERY / 2;
    let (check, training): (Vec<&TorqueEquation>, Vec<&TorqueEquation>) =
        all.iter().partition(|equation| checked(equation));
    let check_nm = (training.len() >= LEAST_EQUATIONS && !check.is_empty()).then(|| {
        let found = problem.solve(&training);
        [rms(&check, &nominal), rms(&check, &found.values)]
    });

    let mut shares = [0.0; BODY_COUNT];
    let mut deviations = [None; BODY_COUNT];
    let spread = &solved.sight.seen * &solved.covariance * solved.sight.seen.transpose();
    for (place, share) in solved.sight.shares().iter().enumerate() {
        shares[free[place]] = *share;
        let deviation = spread[(place, place)].max(0.0).sqrt() * problem.scales[place];
        deviations[free[place]] = (*share >= LEAST_SHARE).then_some(deviation);
    }
    let explained = |equation: &TorqueEquation| {
        let by = |values: &BodyVector| equation.by(values);
        ExplainedTorque {
            t: equation.t,
            motor: equation.motor,
            measured_nm: equation.torque,
            before_nm: by(&nominal),
            after_nm: by(&solved.values),
        }
    };
    let [mut blind, weak] = problem.words(&solved.sight, machine);
    let hidden = hidden.into_iter().map(|index| {
        let name = body_name(index);
        format!("{name}: the place in the tick at which a drive tells its torque looks the same")
    });
    blind.extend(hidden);
    let (_, impossible) = solved.values.put_into(machine);
    Ok(Identification {
        nominal,
        values: solved.values,
        deviations,
        shares,
        ratios: solved.sight.ratios.clone(),
        blind,
        weak,
        at_zero: problem.held.clone(),
        impossible,
        torques: equations.iter().map(explained).collect(),
        residual_nm: [rms(&all, &nominal), rms(&all, &solved.values)],
        check_nm,
        period_s,
        width_s,
        free,
    })
}
