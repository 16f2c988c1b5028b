//! The exact values: every setpoint of a job and what it asks of the motors, in 31 digits, by the
//! independent model.

use rayon::prelude::*;
use trirrr_core::machine::Parameters;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_scene::{Job, JobMove, Scene};
use trirrr_truth::double_double::DoubleDouble;
use trirrr_truth::inputs::Inputs;

/// Exact values that one tick has to give.
pub(crate) struct Instant {
    /// The machine in the exact setpoint.
    pub(crate) inputs: Inputs<DoubleDouble>,
    /// Angle, rate, acceleration and torque of each motor.
    pub(crate) motors: [[DoubleDouble; 4]; 3],
}

/// All instants of the scene's job. The scene's numbers are exact; nothing else is rounded.
pub(crate) fn instants(scene: &Scene) -> Vec<Instant> {
    let ticks = (0..=scene.ticks()).into_par_iter();
    ticks.map(|tick| instant(scene, tick)).collect()
}

fn instant(scene: &Scene, tick: u32) -> Instant {
    let state = state(&scene.job, scene.tick_rate_hz, tick);
    let inputs = in_state(&scene.parameters, state);
    Instant {
        motors: motors(&inputs),
        inputs,
    }
}

/// The machine in a state: pose, velocity, acceleration.
pub(crate) fn in_state(
    parameters: &Parameters,
    state: [[DoubleDouble; 3]; 3],
) -> Inputs<DoubleDouble> {
    let [
        [x, y, angle],
        [vx, vy, angle_rate],
        [ax, ay, angle_acceleration],
    ] = state;
    // The state replaces this setpoint, whose own numbers do not matter.
    let origin: Setpoint<f64> = Setpoint {
        pose: Pose::from_f64(0.0, 0.0, 0.0),
        velocity: nalgebra::Vector3::zeros(),
        acceleration: nalgebra::Vector3::zeros(),
    };
    Inputs {
        position: [x, y],
        angle,
        velocity: [vx, vy],
        angle_rate,
        acceleration: [ax, ay],
        angle_acceleration,
        ..Inputs::exact(parameters, &origin)
    }
}

/// Angle, rate, acceleration and torque of each motor.
pub(crate) fn motors(inputs: &Inputs<DoubleDouble>) -> [[DoubleDouble; 4]; 3] {
    let kinematics = inputs.kinematics();
    let torques = inputs.dynamics(&kinematics).torques;
    std::array::from_fn(|leg| {
        let motion = &kinematics.legs[leg];
        [
            motion.angles[0],
            motion.rates[0],
            motion.accelerations[0],
            torques[leg],
        ]
    })
}

/// Pose, velocity and acceleration at `tick`, which between two moves belongs to the later one.
fn state(job: &Job, rate_hz: f64, tick: u32) -> [[DoubleDouble; 3]; 3] {
    let (mut tick, mut moves) = (tick, job.moves.iter().peekable());
    while let Some(each) = moves.next() {
        if tick < each.duration_ticks || moves.peek().is_none() {
            return on_move(each, rate_hz, tick);
        }
        tick -= each.duration_ticks;
    }
    unreachable!("a job has a move")
}

/// Pose, velocity and acceleration on one move, `tick` ticks after its start: the polynomial with the
/// move's poses and velocities at its ends, and the accelerations of a quintic.
pub(crate) fn on_move(each: &JobMove, rate_hz: f64, tick: u32) -> [[DoubleDouble; 3]; 3] {
    let number = DoubleDouble::new;
    let whole = number(each.duration_ticks.into());
    let duration = whole / number(rate_hz);
    let s = number(tick.into()) / whole;
    let coordinates = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let (from, to) = (coordinates(&each.from), coordinates(&each.to));
    let mut state = [[number(0.0); 3]; 3];
    for axis in 0..3 {
        let way = number(to[axis]) - number(from[axis]);
        let start = number(each.start_velocity[axis]) * duration;
        let end = number(each.end_velocity[axis]) * duration;
        let coefficients = match each.accelerations {
            None => {
                let square = number(3.0) * way - number(2.0) * start - end;
                vec![start, square, start + end - number(2.0) * way]
            }
            Some(both) => {
                let [bent, straightened] =
                    both.map(|one| number(one[axis]) * duration * duration / number(2.0));
                let sum = |parts: [f64; 5]| {
                    let of = [way, start, end, bent, straightened];
                    let products = of.into_iter().zip(parts);
                    products.fold(number(0.0), |sum, (value, part)| sum + value * number(part))
                };
                vec![
                    start,
                    bent,
                    sum([10.0, -6.0, -4.0, -3.0, 1.0]),
                    sum([-15.0, 8.0, 7.0, 3.0, -2.0]),
                    sum([6.0, -3.0, -3.0, -1.0, 1.0]),
                ]
            }
        };
        // Horner's rule, for the value and both derivatives.
        let [mut value, mut first, mut second] = [number(0.0); 3];
        for (index, coefficient) in coefficients.into_iter().enumerate().rev() {
            let power = index as f64 + 1.0;
            value = (value + coefficient) * s;
            first = first * s + number(power) * coefficient;
            if index > 0 {
                second = second * s + number(power * (power - 1.0)) * coefficient;
            }
        }
        state[0][axis] = number(from[axis]) + value;
        state[1][axis] = first / duration;
        state[2][axis] = second / (duration * duration);
    }
    state
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenes::shipped;
    use trirrr_scene::JobPlayer;

    /// The core's own setpoints, in f64, within a few roundings of the exact ones.
    #[test]
    fn setpoints_are_those_of_the_job() {
        for scene in shipped().unwrap() {
            let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
            let mut worst: f64 = 0.0;
            for tick in 0..=scene.ticks() {
                let setpoint = player.at(tick);
                let exact = state(&scene.job, scene.tick_rate_hz, tick);
                let pose = &setpoint.pose;
                for (axis, value) in [pose.position.x, pose.position.y, pose.angle]
                    .into_iter()
                    .enumerate()
                {
                    worst = worst.max(exact[0][axis].error_of(value).abs());
                    let error = exact[1][axis].error_of(setpoint.velocity[axis]);
                    assert!(error.abs() < 1e-14, "{} {tick}", scene.name);
                    let error = exact[2][axis].error_of(setpoint.acceleration[axis]);
                    assert!(error.abs() < 1e-11, "{} {tick}", scene.name);
                }
            }
            // Poses of about half a unit, in units of 2^-53; not zero, or nothing was compared.
            assert!((1e-17..4e-16).contains(&worst), "{}: {worst:e}", scene.name);
        }
    }
}
