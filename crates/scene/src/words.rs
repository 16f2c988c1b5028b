//! Words for what a limit bounds, in SI units.

use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Bounded, LeastDuration, Violation};

/// A number of things: `1 move`, `3 moves`.
pub fn counted(count: usize, thing: &str) -> String {
    let plural = if count == 1 { "" } else { "s" };
    format!("{count} {thing}{plural}")
}

/// Names the bounded quantity and its leg or motor, counted from 1: `torque of motor 2`.
pub fn subject(what: Bounded, index: Option<u8>) -> String {
    let (name, part) = match what {
        Bounded::Reach => ("span", "leg"),
        Bounded::SerialDistance => ("distance from the serial singularity", "leg"),
        Bounded::ParallelDistance => ("distance from the parallel singularity", "leg"),
        Bounded::Rate => ("rate", "motor"),
        Bounded::Acceleration => ("acceleration", "motor"),
        Bounded::Torque => ("torque", "motor"),
        Bounded::Power => ("power", "motor"),
        Bounded::Range => ("range of the number type", "leg"),
        Bounded::Jerk => ("jerk", "motor"),
        Bounded::AccelerationJump => ("jump of the acceleration", "motor"),
    };
    match index {
        Some(index) => format!("{name} of {part} {}", index + 1),
        None => name.into(),
    }
}

/// Returns the name of the SI unit, with a space before it where there is one.
pub fn unit(what: Bounded) -> &'static str {
    match what {
        Bounded::Reach => " m",
        Bounded::SerialDistance | Bounded::ParallelDistance | Bounded::Range => "",
        Bounded::Rate => " rad/s",
        Bounded::Acceleration | Bounded::AccelerationJump => " rad/s^2",
        Bounded::Jerk => " rad/s^3",
        Bounded::Torque => " N m",
        Bounded::Power => " W",
    }
}

/// Describes a limit: `the most allowed is 9 N m`. `value` is beyond it, or near it.
fn allowed(what: Bounded, value: f64, limit: f64, digits: usize) -> String {
    let is_least = match what {
        Bounded::SerialDistance | Bounded::ParallelDistance => true,
        // A leg can be too short as well as too long.
        Bounded::Reach => value < limit,
        _ => false,
    };
    let bound = if is_least { "least" } else { "most" };
    format!(
        "the {bound} allowed is {}{}",
        rounded(limit, digits),
        unit(what)
    )
}

/// Returns the fewest digits, 4 or more, that tell `values` from `limit`.
fn telling(values: &[f64], limit: f64) -> usize {
    let differ = |digits: &usize| {
        let limit = rounded(limit, *digits);
        values.iter().all(|value| rounded(*value, *digits) != limit)
    };
    // The first instant at which a limit is broken is one at which it is broken by little.
    (4..17).find(differ).unwrap_or(17)
}

/// Describes a value beyond its limit: `torque of motor 2 was 9.3 N m, the most allowed is 9 N m`.
pub fn was_beyond(what: Bounded, index: Option<u8>, value: f64, limit: f64) -> String {
    let subject = subject(what, index);
    if what == Bounded::Range {
        return format!("a result was beyond the {subject}");
    }
    let digits = telling(&[value], limit);
    let (value_si, limit) = (rounded(value, digits), allowed(what, value, limit, digits));
    format!("{subject} was {value_si}{}, {limit}", unit(what))
}

/// Describes the limit that a move would break, or is not proven to keep. The time is left out.
pub fn violation(found: &Violation<f64>) -> String {
    let (what, value, limit) = (found.what, found.value, found.limit);
    if what == Bounded::Range {
        return range(found);
    }
    if found.certain && what == Bounded::ParallelDistance && value <= 0.0 {
        return "crosses a parallel singularity, det A changes its sign".into();
    }
    let subject = subject(what, found.index);
    let unit = unit(what);
    let during = match found.ramp {
        true => " in a hold or a resume there",
        false => "",
    };
    let Some(error) = found.error else {
        let allowed = allowed(what, limit, limit, 4);
        return format!("{subject} has no bounds there{during}, {allowed}");
    };
    // All are sizes.
    let ends = [(value - error).max(0.0), value + error];
    let digits = telling(&ends, limit);
    let [least, greatest] = ends.map(|end| rounded(end, digits));
    let middle = rounded(value, digits);
    let allowed = allowed(what, value, limit, digits);
    let known = match least == greatest {
        true => String::new(),
        false => format!(" (from {least} to {greatest})"),
    };
    match found.certain {
        true => format!("{subject} would be {middle}{unit}{known}{during}, {allowed}"),
        false => format!(
            "{subject} is not proven to keep its limit: it would be {middle}{unit}{known}{during}, {allowed}"
        ),
    }
}

/// Describes what the number type cannot hold. For an angle `limit` is where its rounding becomes too large.
fn range(found: &Violation<f64>) -> String {
    match found.index {
        Some(2) => format!(
            "alpha would be {} rad, the most that the number type holds to 1e-4 rad is {} rad",
            short(found.value),
            short(found.limit)
        ),
        Some(0) => "x is beyond the range of the number type".into(),
        Some(_) => "y is beyond the range of the number type".into(),
        None => "a result is not proven to be in the range of the number type".into(),
    }
}

/// Describes the duration that would do, and the longest that would not:
/// `640 ticks (1.28 s) would be long enough, 639 are too few`.
pub fn long_enough(duration: &LeastDuration, tick_rate_hz: f64) -> String {
    let LeastDuration { enough, too_short } = *duration;
    let seconds = short(f64::from(enough) / tick_rate_hz);
    let less = match too_short {
        0 => "fewer are not proven to be".into(),
        _ if too_short + 1 == enough => format!("{too_short} are too few"),
        _ => format!("{too_short} are too few, between them nothing is proven"),
    };
    format!("{enough} ticks ({seconds} s) would be long enough, {less}")
}

/// Names an instant of a move and the pose there.
pub fn instant(time_s: f64, pose: &Pose<f64>) -> String {
    format!(
        "at t = {} s of the move, x = {} m, y = {} m, alpha = {} rad",
        short(time_s),
        short(pose.position.x),
        short(pose.position.y),
        short(pose.angle)
    )
}

/// Formats a number with four significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    rounded(value, 4)
}

/// Formats a time in s, to microseconds: durations are told with all their ticks, and without the rounding of binary64.
pub fn tick_time(time_s: f64) -> String {
    let text = format!("{time_s:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    match text {
        "-0" => "0".into(),
        text => text.into(),
    }
}

/// A number with few digits, but for the rounding of binary64, stays that number.
const BELOW: f64 = 1.0 - 1e-12;

/// Formats a value of a scene as it is written: with twelve significant digits, which hide the rounding of another unit's conversion.
pub fn written(value: f64) -> String {
    rounded(value, 12)
}

/// The next number with so many significant digits that is not less than `value`, which is not negative.
pub fn rounded_up(value: f64, digits: i32) -> f64 {
    if !(value > 0.0 && value.is_finite()) {
        return value;
    }
    let decimals = digits - 1 - value.log10().floor() as i32;
    let scale = 10f64.powi(decimals.abs());
    match decimals >= 0 {
        true => (value * scale * BELOW).ceil() / scale,
        false => (value / scale * BELOW).ceil() * scale,
    }
}

/// A value as people read it: six significant digits at most.
pub fn six_digits(value: f64) -> String {
    rounded(value, 6)
}

fn rounded(value: f64, digits: usize) -> String {
    let decimals = digits.saturating_sub(1);
    let rounded: f64 = format!("{value:.decimals$e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map(Into::into).unwrap_or(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    const TORQUE: Violation<f64> = Violation {
        what: Bounded::Torque,
        index: Some(1),
        at: 0.25,
        value: 9.31234,
        error: Some(1e-9),
        limit: 9.0,
        certain: true,
        ramp: true,
        shortest: None,
    };

    #[test]
    fn a_broken_limit_is_told_from_one_that_is_not_proven_to_be_kept() {
        assert_eq!(
            violation(&TORQUE),
            "torque of motor 2 would be 9.312 N m in a hold or a resume there, the most allowed is 9 N m"
        );
        let near = Violation {
            value: 8.99,
            error: Some(0.085),
            certain: false,
            ramp: false,
            ..TORQUE
        };
        assert_eq!(
            violation(&near),
            "torque of motor 2 is not proven to keep its limit: it would be 8.99 N m (from 8.905 to \
             9.075), the most allowed is 9 N m"
        );
        let unknown = Violation {
            error: None,
            ..near
        };
        assert_eq!(
            violation(&unknown),
            "torque of motor 2 has no bounds there, the most allowed is 9 N m"
        );
    }

    #[test]
    fn distances_have_a_least_value() {
        let near = Violation {
            what: Bounded::ParallelDistance,
            index: None,
            value: 0.0031,
            error: Some(0.0),
            limit: 0.01,
            ramp: false,
            ..TORQUE
        };
        assert_eq!(
            violation(&near),
            "distance from the parallel singularity would be 0.0031, the least allowed is 0.01"
        );
        let across = Violation { value: 0.0, ..near };
        assert!(violation(&across).contains("det A changes its sign"));
        let folded = Violation {
            what: Bounded::Reach,
            index: Some(0),
            ..near
        };
        assert_eq!(
            violation(&folded),
            "span of leg 1 would be 0.0031 m, the least allowed is 0.01 m"
        );
    }

    #[test]
    fn numbers_near_a_limit_have_the_digits_that_show_it() {
        for (value, limit, text) in [
            (1.000_02, 1.0, "1.00002 rad/s, the most allowed is 1 rad/s"),
            (
                22.028_946,
                22.026_598,
                "22.029 rad/s, the most allowed is 22.027 rad/s",
            ),
        ] {
            let text = format!("rate of motor 1 was {text}");
            assert_eq!(was_beyond(Bounded::Rate, Some(0), value, limit), text);
        }
    }

    #[test]
    fn times_have_no_rounding_of_binary64() {
        for (time_s, text) in [
            (9.197_000_000_000_001, "9.197"),
            (700.0 * (1.0 / 500.0), "1.4"),
            (86_400.001, "86400.001"),
            (1.0 / 3.0, "0.333333"),
            (20.0, "20"),
            (0.0, "0"),
            (-1e-9, "0"),
        ] {
            assert_eq!(tick_time(time_s), text);
        }
        assert_eq!(written(346.41 / 1e3), "0.34641");
        assert_eq!(written(-0.12), "-0.12");
        assert_eq!(written(0.173_205_080_756_887_7), "0.173205080757");
    }

    #[test]
    fn too_many_turns_are_a_matter_of_alpha() {
        let turned = Violation {
            what: Bounded::Range,
            index: Some(2),
            value: 1696.67,
            limit: 1677.72,
            ..TORQUE
        };
        assert_eq!(
            violation(&turned),
            "alpha would be 1697 rad, the most that the number type holds to 1e-4 rad is 1678 rad"
        );
    }

    #[test]
    fn a_duration_says_how_sure_it_is() {
        let text = |enough, too_short| long_enough(&LeastDuration { enough, too_short }, 500.0);
        assert_eq!(
            text(640, 639),
            "640 ticks (1.28 s) would be long enough, 639 are too few"
        );
        assert!(text(640, 500).ends_with("500 are too few, between them nothing is proven"));
        assert!(text(640, 0).ends_with("fewer are not proven to be"));
    }
}
