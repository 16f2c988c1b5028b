//! Motions of frames that no measurement can see, in words.

use crate::closure::turned;
use crate::parameter::{DEVICE, KinematicVector, PARAMETER_COUNT, PER_LEG, TARGET, parameter_name};
use nalgebra::DVector;

type KinematicDirection = [f64; PARAMETER_COUNT];

/// Candidates for directions that are not seen, with their words: single parameters, shifts and rotations of the machine
/// and of the platform's frame, joints of a platform that has always the angle `alpha`. In parameters, scaled by `expected`, of the indices in `free`.
pub(crate) fn candidates(
    values: &KinematicVector,
    (centres, alpha): (&[[f64; 2]], f64),
    free: &[usize],
    expected: &[f64],
) -> Vec<(String, DVector<f64>)> {
    let mut found: Vec<(String, KinematicDirection)> = Vec::new();
    for &index in free {
        let mut direction = [0.0; PARAMETER_COUNT];
        direction[index] = 1.0;
        found.push((parameter_name(index), direction));
    }
    for (axis, name) in ["x", "y"].into_iter().enumerate() {
        for leg in 0..3 {
            let words = format!(
                "platform joint {name} of leg {} together with its base joint: the platform was measured at one angle only",
                leg + 1
            );
            found.push((words, leg_moved(leg, axis, alpha)));
        }
        found.push((
            format!("place of the whole machine along {name}: base joints together with the device's frame"),
            machine_moved(axis),
        ));
        found.push((
            format!("place of the platform's frame along its {name}: platform joints together with the target"),
            platform_moved(axis),
        ));
    }
    found.push((
        "angle of the whole machine: base joints and encoder offsets together with the device's frame".into(),
        machine_turned(values, [0.0; 2], true),
    ));
    let mut named = centres.to_vec();
    named.dedup();
    for centre in named {
        found.push((
            format!(
                "angle of the whole machine about the fixed point at x = {}, y = {} m: base joints together with encoder offsets",
                centre[0], centre[1]
            ),
            machine_turned(values, centre, false),
        ));
    }
    for with_angle in [false, true] {
        found.push((
            "angle of the platform's frame: platform joints together with the target".into(),
            platform_turned(values, with_angle),
        ));
    }
    let inside = found.into_iter().filter(|(_, direction)| {
        (0..PARAMETER_COUNT).all(|index| direction[index] == 0.0 || free.contains(&index))
    });
    inside
        .map(|(words, direction)| {
            let scaled = free
                .iter()
                .map(|index| direction[*index] / expected[*index]);
            (words, DVector::from_iterator(free.len(), scaled))
        })
        .collect()
}

/// The machine moves along an axis, and the device's frame with it.
fn machine_moved(axis: usize) -> KinematicDirection {
    let mut direction = [0.0; PARAMETER_COUNT];
    for leg in 0..3 {
        direction[leg * PER_LEG + axis] = 1.0;
    }
    direction[DEVICE + axis] = 1.0;
    direction
}

/// The platform joint of a leg moves along an axis of the platform, and the base joint by the same in the fixed frame.
fn leg_moved(leg: usize, axis: usize, alpha: f64) -> KinematicDirection {
    let mut direction = [0.0; PARAMETER_COUNT];
    direction[leg * PER_LEG + 4 + axis] = 1.0;
    let mut unit = [0.0; 2];
    unit[axis] = 1.0;
    direction[leg * PER_LEG..leg * PER_LEG + 2].copy_from_slice(&turned(unit, alpha));
    direction
}

/// The machine turns about a point; the device's frame turns with it, or stays.
fn machine_turned(
    values: &KinematicVector,
    about: [f64; 2],
    with_device: bool,
) -> KinematicDirection {
    let mut direction = [0.0; PARAMETER_COUNT];
    for leg in 0..3 {
        let own = &values.0[leg * PER_LEG..];
        direction[leg * PER_LEG] = about[1] - own[1];
        direction[leg * PER_LEG + 1] = own[0] - about[0];
        direction[leg * PER_LEG + 6] = 1.0;
    }
    if with_device {
        let [x, y, _] = values.device();
        direction[DEVICE..TARGET].copy_from_slice(&[about[1] - y, x - about[0], 1.0]);
    }
    direction
}

fn platform_moved(axis: usize) -> KinematicDirection {
    let mut direction = [0.0; PARAMETER_COUNT];
    for leg in 0..3 {
        direction[leg * PER_LEG + 4 + axis] = 1.0;
    }
    direction[TARGET + axis] = 1.0;
    direction
}

fn platform_turned(values: &KinematicVector, with_angle: bool) -> KinematicDirection {
    let mut direction = [0.0; PARAMETER_COUNT];
    for leg in 0..3 {
        let own = &values.0[leg * PER_LEG..];
        direction[leg * PER_LEG + 4] = -own[5];
        direction[leg * PER_LEG + 5] = own[4];
    }
    let [x, y, _] = values.target();
    direction[TARGET] = -y;
    direction[TARGET + 1] = x;
    direction[TARGET + 2] = if with_angle { 1.0 } else { 0.0 };
    direction
}
