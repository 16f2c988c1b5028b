//! The twelve results that motors need, as numbers.

use crate::evaluate::evaluate;
use crate::results;
use trirrr_core::machine::Parameters;
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::status::Status;
use trirrr_core::tick::Motor;
use trirrr_core::units::Units;

/// Angle, rate, acceleration and torque of each motor, SI.
pub type Motors = [[f64; 4]; 3];

/// What the four are called.
pub const STAGES: [&str; 4] = ["angle", "rate", "acceleration", "torque"];

/// The results as they are.
pub fn numbers<N: Number>(motors: &[Motor<N>; 3]) -> Motors {
    motors.each_ref().map(|motor| {
        [
            N::angle_to_f64(motor.angle),
            motor.rate.to_f64(),
            motor.acceleration.to_f64(),
            motor.torque.to_f64(),
        ]
    })
}

/// The machine's results in the number type `N`.
///
/// # Errors
/// The status that the setpoint ends in.
pub fn motors<N: Number>(
    parameters: &Parameters,
    setpoint: &Setpoint<N>,
) -> Result<Motors, Status> {
    evaluate(parameters, setpoint).map(|motion| numbers(&motion.motors))
}

/// Results that are given in `units` in SI units.
pub fn in_si(motors: Motors, units: &Units) -> Motors {
    let per_stage = [
        1.0,
        units.rate_rad_s(),
        units.acceleration_rad_s2(),
        units.torque_nm(),
    ];
    motors.map(|motor| std::array::from_fn(|stage| motor[stage] * per_stage[stage]))
}

/// The motors' part of a list of results.
pub fn of_list(list: &[f64]) -> Motors {
    let mut motors = [[0.0; 4]; 3];
    for (name, value) in results::names().into_iter().zip(list) {
        let stage = ["th1", "dth1", "ddth1", "tau"]
            .iter()
            .position(|stem| *stem == name.stem);
        if let (Some(stage), Some(leg)) = (stage, name.leg) {
            motors[leg][stage] = *value;
        }
    }
    motors
}

/// The setpoint rounded to another number type.
pub fn rounded<N: Number, M: Number>(setpoint: &Setpoint<M>) -> Setpoint<N> {
    let pose = &setpoint.pose;
    let number = |x: M| N::from_f64(x.to_f64());
    Setpoint {
        pose: Pose::from_f64(
            pose.position.x.to_f64(),
            pose.position.y.to_f64(),
            M::angle_to_f64(pose.angle),
        ),
        velocity: setpoint.velocity.map(number),
        acceleration: setpoint.acceleration.map(number),
    }
}
