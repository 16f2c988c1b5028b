//! Latched faults.

use super::Units;
use trirrr_protocol::message::{DriveFault, Fault, FaultCode, Transmit};
use trirrr_scene::words::{short, was_beyond};

/// Describes the failure of a drive. `value` is that of the fault.
fn drive(what: DriveFault, drive: &str, value: &str) -> String {
    match what {
        DriveFault::StepRate => {
            format!("{drive} would have to step {value} times as fast as it can")
        }
        DriveFault::Range => format!("a command to {drive} is beyond what its frames can hold"),
        DriveFault::BusBusy => format!("the bus did not carry the command to {drive} in a tick"),
        DriveFault::BusOff => "the bus failed: too many errors on it".into(),
        DriveFault::Reported => format!("{drive} reports its code {value}"),
        DriveFault::Silent => format!("{drive} was silent for {value} of its timeout"),
        DriveFault::NotOn => format!("{drive} is not on, though it should be"),
        DriveFault::Restarted => {
            format!("{drive} has restarted, and may have lost turns of its rotor")
        }
        DriveFault::Stalled => format!("{drive} signals that its motor stalls"),
    }
}

/// Describes a latched fault.
pub fn fault<N: Transmit>(fault: &Fault<N>, units: &Units) -> String {
    let part = |name: &str| match fault.index {
        Some(index) => format!("{name} {}", u32::from(index) + 1),
        None => format!("a {name}"),
    };
    let [leg, motor, joint] = ["leg", "motor", "joint"].map(part);
    // Angles are radians in any units; a machine that detects contacts computes in SI units.
    let [value, limit] = [fault.value, fault.limit].map(|value| short(value.to_f64()));
    let text = match fault.code {
        FaultCode::Limit(what) => {
            let unit = units.of_bounded(what);
            let [value, limit] = [fault.value, fault.limit].map(|value| value.to_f64() * unit);
            was_beyond(what, fault.index, value, limit)
        }
        FaultCode::Unreachable => format!("{leg} is out of reach"),
        FaultCode::SerialSingular => format!("{leg} is stretched or folded"),
        FaultCode::ParallelSingular => "parallel singular: the torques are not defined".into(),
        FaultCode::OutOfRange => "a result was out of the range of the number type".into(),
        FaultCode::Overrun => format!("a tick took {value} of its period"),
        FaultCode::Drive(what) => drive(what, &part("drive"), &value),
        FaultCode::Board if fault.value == N::ONE => {
            "the board has started anew because it had failed".into()
        }
        FaultCode::Board => format!("the board reports its code {value}"),
        FaultCode::FollowingError => {
            format!("{joint} is {value} rad from its command, the most allowed is {limit} rad")
        }
        FaultCode::Contact => {
            format!("contact: a force of {value} N at the tool, the most allowed is {limit} N")
        }
        FaultCode::ContactMoment => {
            format!("contact: a moment of {value} N m at the tool, the most allowed is {limit} N m")
        }
        FaultCode::EmergencyStop => {
            "the emergency stop was pressed, or its wire is broken: release it, then acknowledge the fault".into()
        }
        FaultCode::LimitSwitch => format!(
            "{motor} has reached its limit switch, or the wire of that is broken: acknowledge the fault, then a recovery \
             leads off it"
        ),
        FaultCode::HomingNotFound => {
            format!("homing: {motor} has not found its switch or stop within {limit} rad")
        }
        FaultCode::HomingNotReleased => {
            format!("homing: the switch of {motor} is still closed {limit} rad back from it")
        }
        FaultCode::HomingClosedAtStart => format!(
            "homing: the switch of {motor} was closed at the start, and is still closed {limit} rad away"
        ),
    };
    format!("{text} (tick {})", fault.tick)
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::Bounded;

    #[test]
    fn a_fault_names_its_leg_and_tick() {
        let (code, index) = FaultCode::of(trirrr_core::status::Status::Unreachable { leg: 2 });
        let found = Fault {
            code,
            index,
            value: 0.0,
            limit: 0.0,
            tick: 77,
        };
        assert_eq!(
            fault(&found, &Units::si(500.0)),
            "leg 3 is out of reach (tick 77)"
        );
        let found = Fault {
            code: FaultCode::Overrun,
            index: None,
            value: 1.25,
            limit: 1.0,
            tick: 9,
        };
        assert_eq!(
            fault(&found, &Units::si(500.0)),
            "a tick took 1.25 of its period (tick 9)"
        );
        let found = Fault {
            code: FaultCode::Limit(Bounded::Rate),
            index: Some(0),
            value: 5.25,
            limit: 5.0,
            tick: 8,
        };
        assert_eq!(
            fault(&found, &Units::si(500.0)),
            "rate of motor 1 was 5.25 rad/s, the most allowed is 5 rad/s (tick 8)"
        );
    }
}
