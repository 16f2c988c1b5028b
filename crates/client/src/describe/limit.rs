//! Limits: the bounded quantity, its value and the limit.

use super::{Units, short};
use trirrr_protocol::message::{Bounded, Transmit, Violation};

/// Names the bounded quantity and its leg or motor, counted from 1: `torque of motor 2`.
pub(super) fn subject(what: Bounded, index: Option<u8>) -> String {
    let (name, part) = match what {
        Bounded::Reach => ("span", "leg"),
        Bounded::SerialDistance => ("distance from the serial singularity", "leg"),
        Bounded::ParallelDistance => ("distance from the parallel singularity", "leg"),
        Bounded::Rate => ("rate", "motor"),
        Bounded::Acceleration => ("acceleration", "motor"),
        Bounded::Torque => ("torque", "motor"),
        Bounded::Power => ("power", "motor"),
        Bounded::Range => ("range of the number type", "leg"),
    };
    match index {
        Some(index) => format!("{name} of {part} {}", index + 1),
        None => name.into(),
    }
}

/// Returns true if the bound is the least allowed value, and false if the most.
fn is_least(what: Bounded) -> bool {
    matches!(what, Bounded::SerialDistance | Bounded::ParallelDistance)
}

/// Describes a value beyond its limit: `torque of motor 2 would be 9.3 N m, the most allowed is 9 N m`.
pub(super) fn beyond<N: Transmit>(
    what: Bounded,
    index: Option<u8>,
    verb: &str,
    [value, limit]: [N; 2],
    units: &Units,
) -> String {
    let subject = subject(what, index);
    if what == Bounded::Range {
        return format!("a result {verb} beyond the {subject}");
    }
    let bound = match is_least(what) {
        true => "least",
        false => "most",
    };
    let [value, limit] = [value, limit].map(|value| value.to_f64());
    // The first instant at which a limit is broken is one at which it is broken by little.
    let value = (4..=17)
        .map(|digits| units.quantity(what, value, digits))
        .find(|text| *text != units.quantity(what, limit, 4))
        .unwrap_or_else(|| units.quantity(what, value, 17));
    let limit = units.quantity(what, limit, 4);
    format!("{subject} {verb} {value}, the {bound} allowed is {limit}")
}

/// Describes the limit that a move of `ticks` would break, and the time within the move.
pub fn violation<N: Transmit>(violation: &Violation<N>, ticks: u32, units: &Units) -> String {
    let values = [violation.value, violation.limit];
    if let (Bounded::Range, Some(index)) = (violation.what, violation.index) {
        return coordinate(index, values);
    }
    let mut text = beyond(violation.what, violation.index, "would be", values, units);
    let fraction = violation.at.to_f64();
    let time = fraction * f64::from(ticks) / units.tick_rate_hz;
    text += &format!(", {} s into the move", short(time));
    if violation.ramp {
        text += ", in a hold or a resume there";
    }
    if let Some(shortest) = violation.shortest {
        text += &format!("; {} would be long enough", units.ticks(shortest));
    }
    text
}

/// Describes a coordinate of a move that its number type cannot hold well enough. For an angle `limit` is where
/// its rounding becomes too large.
fn coordinate<N: Transmit>(index: u8, [value, limit]: [N; 2]) -> String {
    match index {
        2 => format!(
            "alpha would be {} rad, the most that the number type holds to 1e-4 rad is {} rad",
            short(value.to_f64()),
            short(limit.to_f64())
        ),
        0 => "x is beyond the range of the number type".into(),
        _ => "y is beyond the range of the number type".into(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn too_many_turns_are_a_matter_of_alpha() {
        let found = Violation {
            what: Bounded::Range,
            index: Some(2),
            at: 0.0f32,
            value: 1696.67,
            limit: 1677.72,
            ramp: false,
            shortest: None,
        };
        assert_eq!(
            violation(&found, 100, &Units::si(100.0)),
            "alpha would be 1697 rad, the most that the number type holds to 1e-4 rad is 1678 rad"
        );
    }

    #[test]
    fn a_violation_names_what_which_when_value_limit_and_the_way_out() {
        let found = Violation {
            what: Bounded::Torque,
            index: Some(1),
            at: 0.25,
            value: -9.31234,
            limit: 9.0,
            ramp: true,
            shortest: Some(640),
        };
        assert_eq!(
            violation(&found, 400, &Units::si(500.0)),
            "torque of motor 2 would be -9.312 N m, the most allowed is 9 N m, 0.2 s into the \
             move, in a hold or a resume there; 640 ticks (1.28 s) would be long enough"
        );
        let found = Violation {
            what: Bounded::ParallelDistance,
            index: None,
            at: 1.0,
            value: 0.0031f32,
            limit: 0.01,
            ramp: false,
            shortest: None,
        };
        assert_eq!(
            violation(&found, 100, &Units::si(500.0)),
            "distance from the parallel singularity would be 0.0031, the least allowed is 0.01, \
             0.2 s into the move"
        );
    }

    #[test]
    fn a_value_little_beyond_its_limit_has_the_digits_that_show_it() {
        let found = Violation {
            what: Bounded::Rate,
            index: Some(0),
            at: 0.5,
            value: 1.000_02,
            limit: 1.0,
            ramp: false,
            shortest: None,
        };
        assert_eq!(
            violation(&found, 100, &Units::si(100.0)),
            "rate of motor 1 would be 1.00002 rad/s, the most allowed is 1 rad/s, 0.5 s into the move"
        );
    }
}
