//! Random jobs on the thesis machine.

use trirrr_core::message::Move;
use trirrr_core::setpoint::{Hermite, Pose, RestToRest, Segment};
use trirrr_rig::device::{TICK_RATE_HZ, home};
use trirrr_rig::faulty_link::Random;

/// Moves of a job: 1 to this many.
const MOST_MOVES: u64 = 40;

/// A job that starts and ends where the machine was switched on. Its moves are short, some chained
/// without a stop, and slow enough to be admitted.
pub(crate) fn random_job(random: &mut Random) -> Vec<Move<f64>> {
    let count = 1 + random.below(MOST_MOVES);
    let mut moves: Vec<Move<f64>> = Vec::new();
    let (mut from, mut start_velocity) = (home(), [0.0; 3]);
    for index in 0..count {
        let last = index + 1 == count;
        let to = if last { home() } else { near_home(random) };
        let end_velocity = match last || random.below(3) > 0 {
            true => [0.0; 3],
            false => [0; 3].map(|_| random.fraction() * 0.1 - 0.05),
        };
        moves.push(Move {
            number: 0,
            from,
            to,
            start_velocity,
            end_velocity,
            ticks: 20 + random.below(30) as u32,
            tool_power: 0.0,
            tool_speed: 0.0,
        });
        (from, start_velocity) = (to, end_velocity);
    }
    moves
}

/// A pose within a few millimetres of home.
fn near_home(random: &mut Random) -> Pose<f64> {
    let mut about = |middle: f64, width: f64| middle + (random.fraction() - 0.5) * width;
    let home = home();
    Pose::from_f64(
        about(home.position.x, 0.01),
        about(home.position.y, 0.01),
        about(home.angle, 0.02),
    )
}

/// The setpoints of a move, as a client would compute them.
pub(crate) fn segment(each: &Move<f64>) -> Segment<f64> {
    let period = 1.0 / TICK_RATE_HZ;
    if each.is_rest_to_rest() {
        return Segment::RestToRest(RestToRest::new(each.from, each.to, each.ticks, period));
    }
    let [start, end] = [each.start_velocity, each.end_velocity].map(Into::into);
    Segment::Hermite(Hermite::new(
        each.from, start, each.to, end, each.ticks, period,
    ))
}
