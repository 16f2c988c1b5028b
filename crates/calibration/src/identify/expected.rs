//! Knowledge about bodies before their identification: expected deviations, and masses that no motion tells apart.

use super::bodies::{BODY_COUNT, FRICTION, PER_BODY_LEG, PLATFORM, READING, body_name};
use super::equations::TorqueEquation;
use nalgebra::DVector;
use trirrr_core::machine::Parameters;

/// Deviation that is expected of each parameter: half of what the scene has, and of a body without mass half of a tenth of the heaviest.
pub(super) fn scales(machine: &Parameters, equations: &[TorqueEquation]) -> [f64; BODY_COUNT] {
    let links = machine
        .legs
        .iter()
        .flat_map(|leg| [&leg.proximal, &leg.distal]);
    let heaviest = links
        .map(|link| link.mass_kg)
        .fold(machine.platform.mass_kg, f64::max);
    let heaviest = if heaviest > 0.0 { heaviest } else { 0.1 };
    let mass_of = |own: f64| 0.5 * own.max(0.1 * heaviest);
    let mut scales = [0.0; BODY_COUNT];
    for (leg, own) in machine.legs.iter().zip(scales.chunks_mut(PER_BODY_LEG)) {
        let (one, two) = (mass_of(leg.proximal.mass_kg), mass_of(leg.distal.mass_kg));
        let (l1, l2) = (leg.proximal_m, leg.distal_m);
        let rotor = 0.5 * leg.rotor_inertia_kgm2;
        own.copy_from_slice(&[
            one * 0.5 * l1,
            one * l1 * l1 / 3.0 + rotor,
            two,
            two * 0.5 * l2,
            two * l2 * l2 / 3.0,
        ]);
    }
    let radius = machine
        .legs
        .iter()
        .fold(0.01, |most: f64, leg| most.max(leg.joint_radius_m));
    let mass = mass_of(machine.platform.mass_kg);
    let inertia = (0.5 * machine.platform.inertia_kgm2).max(mass * radius * radius);
    scales[PLATFORM..FRICTION].copy_from_slice(&[mass, mass * radius, mass * radius, inertia]);
    let mean = |of: &dyn Fn(&TorqueEquation) -> f64| {
        let squares = equations.iter().map(|equation| of(equation) * of(equation));
        (squares.sum::<f64>() / equations.len().max(1) as f64).sqrt()
    };
    let torque = mean(&|equation| equation.torque).max(1e-9);
    let rate = mean(&|equation| equation.slopes[FRICTION + 2 * equation.motor]).max(1e-3);
    for pair in scales[FRICTION..READING].chunks_mut(2) {
        pair.copy_from_slice(&[0.5 * torque / rate, 0.5 * torque]);
    }
    scales[READING..].fill(0.5 * torque / rate);
    scales
}

/// Candidates for directions that no motion sees: single parameters, and masses at a joint that may belong to either body there.
pub(super) fn exchanges(
    machine: &Parameters,
    free: &[usize],
    scales: &[f64],
) -> Vec<(String, DVector<f64>)> {
    let mut found: Vec<(String, [f64; BODY_COUNT])> = Vec::new();
    for &index in free {
        let mut direction = [0.0; BODY_COUNT];
        direction[index] = 1.0;
        found.push((body_name(index), direction));
    }
    for (leg, own) in machine.legs.iter().enumerate() {
        let first = leg * PER_BODY_LEG;
        let (l1, l2) = (own.proximal_m, own.distal_m);
        for with_moment in [true, false] {
            let mut elbow = [0.0; BODY_COUNT];
            elbow[first] = if with_moment { l1 } else { 0.0 };
            elbow[first + 1] = l1 * l1;
            elbow[first + 2] = -1.0;
            found.push((
                format!(
                    "mass at the elbow of leg {}: of the proximal or of the distal link",
                    leg + 1
                ),
                elbow,
            ));
        }
        let (sin, cos) = own.joint_angle_rad.sin_cos();
        let radius = own.joint_radius_m;
        let mut joint = [0.0; BODY_COUNT];
        joint[first + 2..first + 5].copy_from_slice(&[-1.0, -l2, -l2 * l2]);
        joint[PLATFORM..FRICTION].copy_from_slice(&[
            1.0,
            radius * cos,
            radius * sin,
            radius * radius,
        ]);
        found.push((
            format!(
                "mass at the platform joint of leg {}: of the distal link or of the platform",
                leg + 1
            ),
            joint,
        ));
    }
    let inside = found.into_iter().filter(|(_, direction)| {
        (0..BODY_COUNT).all(|index| direction[index] == 0.0 || free.contains(&index))
    });
    inside
        .map(|(words, direction)| {
            let scaled = free
                .iter()
                .zip(scales)
                .map(|(index, scale)| direction[*index] / scale);
            (words, DVector::from_iterator(free.len(), scaled))
        })
        .collect()
}
