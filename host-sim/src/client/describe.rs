//! What a machine reports, in words.

use trirrr_core::message::{Bounded, Fault, FaultCode, Transmit, Violation};

/// What goes beyond its bound, where, when, value and limit; and the duration that would pass.
pub(super) fn violation<N: Transmit>(violation: &Violation<N>) -> String {
    let place = place(violation.what, violation.index);
    let passes = match violation.shortest {
        Some(ticks) => format!("; in {ticks} ticks it would pass"),
        None => String::new(),
    };
    format!(
        "{place} would be {} at {} of the move, the limit is {}{passes}",
        violation.value.to_f64(),
        violation.at.to_f64(),
        violation.limit.to_f64(),
    )
}

/// What happened, where, when, value and limit.
pub(super) fn fault<N: Transmit>(fault: &Fault<N>) -> String {
    let what = match fault.code.bounded() {
        Some(what) => place(what, fault.index),
        None => format!("{:?}", fault.code),
    };
    let limit = match fault.code {
        FaultCode::Limit(_) => format!(" over a limit of {}", fault.limit.to_f64()),
        _ => String::new(),
    };
    format!(
        "fault in tick {}: {what}, {}{limit}",
        fault.tick,
        fault.value.to_f64()
    )
}

/// "torque of motor 2".
fn place(what: Bounded, index: Option<u8>) -> String {
    let (name, part) = match what {
        Bounded::Reach => ("span", "leg"),
        Bounded::SerialDistance => ("distance from the serial singularity", "leg"),
        Bounded::ParallelDistance => ("distance from the parallel singularity", "leg"),
        Bounded::Rate => ("rate", "motor"),
        Bounded::Acceleration => ("acceleration", "motor"),
        Bounded::Torque => ("torque", "motor"),
        Bounded::Power => ("power", "motor"),
        Bounded::Range => ("a result beyond the number's range", "leg"),
    };
    match index {
        Some(index) => format!("{name} of {part} {}", index + 1),
        None => name.into(),
    }
}
