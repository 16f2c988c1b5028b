//! Obstacles on a path in words.

use crate::words;
use trirrr_plan::cell::{Limited, Obstacle};
use trirrr_plan::course::PathRefusal;

/// Describes an obstacle and its place.
pub(crate) fn obstacle(refusal: &PathRefusal) -> String {
    let PathRefusal {
        place,
        pose,
        obstacle,
    } = refusal;
    let reason = match obstacle {
        Obstacle::Reach(leg) => format!("leg {} does not reach the platform", leg + 1),
        Obstacle::SerialDistance(leg) => format!(
            "leg {} comes nearer to its serial singularity than [limits] serial_distance_min, or is not proven to stay away from it",
            leg + 1
        ),
        Obstacle::ParallelDistance => {
            "the machine comes nearer to a parallel singularity than [limits] \
             parallel_distance_min, crosses one, or is not proven to stay away from it"
                .into()
        }
        Obstacle::Standing(what) => format!(
            "the machine cannot stand there: {} is beyond its limit at rest; no duration helps",
            limited(*what)
        ),
        Obstacle::Range => "a value leaves the range of the number type".into(),
        Obstacle::Refused => {
            "the moves of the plan are refused, however slow: the limits leave no room for the \
             number type or the tick rate of the scene"
                .into()
        }
    };
    format!(
        "at p = {} of the piece, x = {} m, y = {} m, alpha = {} rad: {reason}",
        words::short(place.p),
        words::short(pose.position.x),
        words::short(pose.position.y),
        words::short(pose.angle)
    )
}

/// Names a limited quantity.
pub fn limited(what: Limited) -> String {
    let of_motor = |quantity: &str, motor: usize| format!("the {quantity} of motor {}", motor + 1);
    match what {
        Limited::Rate(motor) => of_motor("rate", motor),
        Limited::Acceleration(motor) => of_motor("acceleration", motor),
        Limited::Torque(motor) => of_motor("torque", motor),
        Limited::Power(motor) => of_motor("power", motor),
        Limited::Jerk(motor) => of_motor("jerk", motor),
        Limited::Feed => "the feed".into(),
        Limited::Tolerance => "the tolerance".into(),
        Limited::Number => "the number type".into(),
    }
}
