//! Random jobs.

use crate::faulty_link::Random;
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{AnyMove, Move, QuinticMove};

/// Moves of a job: 1 to this many.
const MOST_MOVES: u64 = 40;

/// A job that starts and ends at `home`, in m and rad. Its moves lead a few millimetres and hundredths of a
/// radian away, are short, some chained without a stop, some quintics if the machine plays `quintics`, and slow
/// enough to be admitted at 1000 ticks per second.
pub fn random_job(random: &mut Random, home: Pose<f64>, quintics: bool) -> Vec<AnyMove<f64>> {
    let count = 1 + random.below(MOST_MOVES);
    let mut moves: Vec<AnyMove<f64>> = Vec::new();
    let (mut from, mut start_velocity, mut start_acceleration) = (home, [0.0; 3], [0.0; 3]);
    for index in 0..count {
        let last = index + 1 == count;
        let to = if last { home } else { near(random, home) };
        let end_velocity = match last || random.below(3) > 0 {
            true => [0.0; 3],
            false => [0; 3].map(|_| random.fraction() * 0.1 - 0.05),
        };
        let common = Move {
            number: 0,
            from,
            to,
            start_velocity,
            end_velocity,
            ticks: 20 + random.below(30) as u32,
            tool_power: 0.0,
            tool_speed: 0.0,
        };
        if quintics && random.below(2) > 0 {
            let end_acceleration = match last || random.below(3) > 0 {
                true => [0.0; 3],
                false => [0; 3].map(|_| random.fraction() * 4.0 - 2.0),
            };
            moves.push(AnyMove::Quintic(QuinticMove {
                common,
                start_acceleration,
                end_acceleration,
            }));
            start_acceleration = end_acceleration;
        } else {
            moves.push(AnyMove::Cubic(common));
            start_acceleration = [0.0; 3];
        }
        (from, start_velocity) = (to, end_velocity);
    }
    moves
}

/// A pose a few millimetres and hundredths of a radian from `home`.
pub fn near(random: &mut Random, home: Pose<f64>) -> Pose<f64> {
    let mut about = |middle: f64, width: f64| middle + (random.fraction() - 0.5) * width;
    Pose::from_f64(
        about(home.position.x, 0.01),
        about(home.position.y, 0.01),
        about(home.angle, 0.02),
    )
}
