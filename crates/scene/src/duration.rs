//! Durations as whole numbers of ticks.

use nalgebra::Vector3;
use trirrr_core::setpoint::Pose;

/// A duration may be this far from a whole number of ticks, for it is written in decimals.
const TOLERANCE_TICKS: f64 = 1e-6;

/// The ticks of a duration given in seconds, positive, at `rate` ticks per second.
///
/// # Errors
/// Why the duration is refused: no whole number of ticks, with the nearest that are; or too many.
pub(crate) fn whole_ticks(duration_s: f64, rate: f64) -> Result<u32, String> {
    let exact = duration_s * rate;
    let whole = exact.round();
    check_count(whole, rate)?;
    if whole >= 1.0 && (exact - whole).abs() <= TOLERANCE_TICKS {
        return Ok(whole as u32);
    }
    let below = exact.floor() / rate;
    let above = (exact.floor() + 1.0) / rate;
    let nearest = match below > 0.0 {
        true => format!("the nearest durations are {below:?} and {above:?}"),
        false => format!("the shortest duration is {above:?}"),
    };
    Err(format!(
        "must be a whole number of ticks, it is {exact:?} of them at {rate:?} Hz; {nearest} (s)"
    ))
}

/// The ticks of a move whose duration is left out: at constant acceleration along the straight
/// line d between its poses, T = 2 d^2 / (d . (v0 + v1)), rounded up to whole ticks. d is taken in
/// the plane; in a move that only turns, it is the angle.
///
/// # Errors
/// Why there is no such duration.
pub(crate) fn ticks_at_constant_acceleration(
    from: &Pose<f64>,
    to: &Pose<f64>,
    start_velocity: Vector3<f64>,
    end_velocity: Vector3<f64>,
    rate: f64,
) -> Result<u32, String> {
    let position = to.position - from.position;
    let turn = to.angle - from.angle;
    let velocity = start_velocity + end_velocity;
    let (squared, along) = if position.x != 0.0 || position.y != 0.0 {
        let along = position.x * velocity.x + position.y * velocity.y;
        (position.x * position.x + position.y * position.y, along)
    } else {
        (turn * turn, turn * velocity.z)
    };
    if start_velocity == Vector3::zeros() && end_velocity == Vector3::zeros() {
        return Err("missing: a move from rest to rest needs its duration (s)".into());
    }
    if squared == 0.0 {
        return Err("missing: a move that ends where it starts needs its duration (s)".into());
    }
    if along <= 0.0 {
        return Err(format!(
            "missing, and it cannot be computed: the velocities at the two ends do not lead \
             along the move, d . (v0 + v1) = {along:?}; give a duration (s)"
        ));
    }
    let ticks = (2.0 * squared / along * rate - TOLERANCE_TICKS)
        .ceil()
        .max(1.0);
    check_count(ticks, rate)?;
    Ok(ticks as u32)
}

fn check_count(ticks: f64, rate: f64) -> Result<(), String> {
    // Written so that a value that is not a number is refused.
    if ticks <= f64::from(u32::MAX) {
        return Ok(());
    }
    Err(format!(
        "is {ticks:?} ticks at {rate:?} Hz, more than the {} that a job can have",
        u32::MAX
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimal_durations_are_whole_ticks() {
        for (duration_s, rate, ticks) in [
            (1.0, 100.0, 100),
            (0.1 + 0.2, 100.0, 30),
            (0.29, 100.0, 29),
            (1.1, 1000.0, 1100),
            (0.001, 1000.0, 1),
            (2.0, 62.5, 125),
            (42949.67295, 100_000.0, u32::MAX),
        ] {
            assert_eq!(
                whole_ticks(duration_s, rate),
                Ok(ticks),
                "{duration_s} {rate}"
            );
        }
    }

    #[test]
    fn other_durations_are_refused_with_their_neighbours() {
        let refusal = whole_ticks(0.015, 100.0).unwrap_err();
        assert!(
            refusal.contains("it is 1.5 of them at 100.0 Hz"),
            "{refusal}"
        );
        assert!(
            refusal.contains("nearest durations are 0.01 and 0.02"),
            "{refusal}"
        );
        let refusal = whole_ticks(0.9999, 100.0).unwrap_err();
        assert!(
            refusal.contains("nearest durations are 0.99 and 1.0"),
            "{refusal}"
        );
        for tiny in [0.004, 1e-9, 5e-324] {
            let refusal = whole_ticks(tiny, 100.0).unwrap_err();
            assert!(refusal.contains("shortest duration is 0.01"), "{refusal}");
        }
        for huge in [42949.67296, 1e300, f64::MAX] {
            let refusal = whole_ticks(huge, 100_000.0).unwrap_err();
            assert!(refusal.contains("more than the 4294967295"), "{refusal}");
        }
    }

    fn pose(x: f64, y: f64, alpha: f64) -> Pose<f64> {
        Pose::from_f64(x, y, alpha)
    }

    #[test]
    fn constant_acceleration_along_a_line() {
        // 0.3 m from rest to 0.2 m/s: mean speed 0.1 m/s, 3 s; with 0.1 m/s at the start, 2 s.
        let (from, to) = (pose(0.1, 0.0, 0.0), pose(0.4, 0.0, 1.0));
        let v = Vector3::new(0.2, 5.0, -7.0);
        let rest = Vector3::zeros();
        assert_eq!(
            ticks_at_constant_acceleration(&from, &to, rest, v, 100.0),
            Ok(300)
        );
        assert_eq!(
            ticks_at_constant_acceleration(&from, &to, v / 2.0, v, 100.0),
            Ok(200)
        );
        // 3 s at 33.5 Hz is 100.5 ticks.
        assert_eq!(
            ticks_at_constant_acceleration(&from, &to, rest, v, 33.5),
            Ok(101)
        );
    }

    #[test]
    fn a_turn_on_the_spot_uses_the_angle() {
        let (from, to) = (pose(0.1, 0.2, 0.5), pose(0.1, 0.2, -0.5));
        let v = Vector3::new(0.0, 0.0, -0.5);
        assert_eq!(
            ticks_at_constant_acceleration(&from, &to, v, v, 10.0),
            Ok(20)
        );
    }

    #[test]
    fn velocities_that_lead_away_are_refused() {
        let (from, to) = (pose(0.0, 0.0, 0.0), pose(1.0, 0.0, 0.0));
        let back = Vector3::new(-1.0, 0.0, 0.0);
        let rest = Vector3::zeros();
        let refusal =
            |from, to, v0, v1| ticks_at_constant_acceleration(from, to, v0, v1, 10.0).unwrap_err();
        assert!(refusal(&from, &to, back, back / 2.0).contains("d . (v0 + v1) = -1.5"));
        assert!(refusal(&from, &to, back, -back).contains("do not lead"));
        assert!(refusal(&from, &to, rest, rest).contains("from rest to rest"));
        assert!(refusal(&from, &from, back, rest).contains("ends where it starts"));
        let tiny = Vector3::new(1e-300, 0.0, 0.0);
        assert!(refusal(&from, &to, tiny, rest).contains("more than the 4294967295"));
    }
}
