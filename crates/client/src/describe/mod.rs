//! What a machine says, in words and SI units.

pub mod board;

use trirrr_protocol::message::{
    Acting, Bounded, DriveFault, Fault, FaultCode, Identity, Refusal, State, Transmit, Violation,
};
use trirrr_scene::Scene;

/// The units that a machine's messages are in, and the rate of its ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Units {
    /// One unit of length, m.
    pub length_m: f64,
    /// One unit of time, s.
    pub time_s: f64,
    /// One unit of mass, kg.
    pub mass_kg: f64,
    /// Ticks per second.
    pub tick_rate_hz: f64,
}

impl Units {
    /// SI, as the float types have them, at `tick_rate_hz` ticks per second.
    pub fn si(tick_rate_hz: f64) -> Self {
        Self {
            length_m: 1.0,
            time_s: 1.0,
            mass_kg: 1.0,
            tick_rate_hz,
        }
    }

    /// Those that the machine of `scene` has, `units`.
    pub fn of_scene(scene: &Scene, units: &trirrr_core::units::Units) -> Self {
        Self {
            length_m: units.length_m(),
            time_s: units.time_s(),
            mass_kg: units.of(0, 0, 1),
            tick_rate_hz: scene.tick_rate_hz,
        }
    }

    /// Those that a machine named in its hello.
    pub fn of(identity: &Identity) -> Self {
        Self {
            length_m: identity.length_m,
            time_s: identity.time_s,
            mass_kg: identity.mass_kg,
            tick_rate_hz: identity.tick_rate_hz,
        }
    }

    /// One unit of `what` in SI, and the name of the SI unit.
    fn of_bounded(&self, what: Bounded) -> (f64, &'static str) {
        let (length, time, mass) = (self.length_m, self.time_s, self.mass_kg);
        let torque = mass * length * length / (time * time);
        match what {
            Bounded::Reach => (length, " m"),
            Bounded::SerialDistance | Bounded::ParallelDistance | Bounded::Range => (1.0, ""),
            Bounded::Rate => (1.0 / time, " rad/s"),
            Bounded::Acceleration => (1.0 / (time * time), " rad/s^2"),
            Bounded::Torque => (torque, " N m"),
            Bounded::Power => (torque / time, " W"),
        }
    }

    fn quantity(&self, what: Bounded, value: f64, digits: usize) -> String {
        let (unit, name) = self.of_bounded(what);
        format!("{}{name}", rounded(value * unit, digits))
    }

    /// `640 ticks (1.28 s)`.
    fn ticks(&self, ticks: u32) -> String {
        let seconds = short(f64::from(ticks) / self.tick_rate_hz);
        format!("{ticks} ticks ({seconds} s)")
    }
}

/// A number to four significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    rounded(value, 4)
}

fn rounded(value: f64, digits: usize) -> String {
    let decimals = digits.saturating_sub(1);
    let rounded: f64 = format!("{value:.decimals$e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map(Into::into).unwrap_or(text)
}

/// `torque of motor 2`: what is bounded, and of which leg or motor (counted from 1).
fn subject(what: Bounded, index: Option<u8>) -> String {
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

/// Whether the bound is the least that is allowed, and not the most.
fn is_least(what: Bounded) -> bool {
    matches!(what, Bounded::SerialDistance | Bounded::ParallelDistance)
}

/// `torque of motor 2 would be 9.3 N m, the most allowed is 9 N m`.
fn beyond<N: Transmit>(
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

/// What a move would break, and when. `ticks`: the move's duration.
pub fn violation<N: Transmit>(violation: &Violation<N>, ticks: u32, units: &Units) -> String {
    let values = [violation.value, violation.limit];
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

/// What a drive did not do. `value`: the fault's.
fn drive(what: DriveFault, index: Option<u8>, value: &str) -> String {
    let drive = match index {
        Some(index) => format!("drive {}", index + 1),
        None => "a drive".into(),
    };
    match what {
        DriveFault::StepRate => {
            format!("{drive} would have to step {value} times as fast as it can")
        }
        DriveFault::Range => format!("a command to {drive} is beyond what its frames can hold"),
        DriveFault::BusBusy => format!("the bus did not carry the command to {drive} in a tick"),
        DriveFault::BusOff => "the bus failed: too many errors on it".into(),
        DriveFault::Reported => format!("{drive} reports its code {value}"),
    }
}

/// A latched fault.
pub fn fault<N: Transmit>(fault: &Fault<N>, units: &Units) -> String {
    let value = || short(fault.value.to_f64());
    // Angles are radians in any units.
    let searched = || {
        let motor = fault.index.map_or(0, |index| index + 1);
        (motor, short(fault.limit.to_f64()))
    };
    let leg = |text: &str| match fault.index {
        Some(index) => format!("leg {} is {text}", index + 1),
        None => text.into(),
    };
    let text = match fault.code {
        FaultCode::Limit(what) => {
            let values = [fault.value, fault.limit];
            beyond(what, fault.index, "was", values, units)
        }
        FaultCode::Unreachable => leg("out of reach"),
        FaultCode::SerialSingular => leg("stretched or folded"),
        FaultCode::ParallelSingular => "parallel singular: the torques are not defined".into(),
        FaultCode::OutOfRange => "a result was out of the range of the number type".into(),
        FaultCode::Overrun => format!("a tick took {} of its period", value()),
        FaultCode::Drive(what) => drive(what, fault.index, &value()),
        FaultCode::Board if fault.value == N::ONE => {
            "the board has started anew because it had failed".into()
        }
        FaultCode::Board => format!("the board reports its code {}", value()),
        FaultCode::HomingNotFound => {
            let (motor, limit) = searched();
            format!("homing: motor {motor} has not found its switch or stop within {limit} rad")
        }
        FaultCode::HomingNotReleased => {
            let (motor, limit) = searched();
            format!("homing: the switch of motor {motor} is still closed {limit} rad back from it")
        }
        FaultCode::HomingClosedAtStart => {
            let (motor, limit) = searched();
            format!(
                "homing: the switch of motor {motor} was closed at the start, and is still closed \
                 {limit} rad away"
            )
        }
    };
    format!("{text} (tick {})", fault.tick)
}

/// The state, and what keeps the machine from normal speed.
pub fn state(state: State, acting: Acting) -> String {
    let state = match state {
        State::Idle => "idle",
        State::Running => "running",
        State::Slowing => "slowing",
        State::Stopping => "stopping",
        State::Holding => "holding",
        State::Fault => "fault",
        State::Cleared => "fault acknowledged",
        State::Recovering => "recovering",
        State::Unhomed => "not homed",
        State::Homing => "homing",
    };
    let acting = match acting {
        Acting::Nothing => return state.into(),
        Acting::Hold => "hold",
        Acting::Resume => "resume",
        Acting::Stop => "stop",
        Acting::Silence => "host silent",
        Acting::QueueDry => "waiting for moves",
        Acting::Limit(what) => return format!("{state} ({})", subject(what, None)),
    };
    format!("{state} ({acting})")
}

/// Why a command was not executed. `ticks`: the duration of the move that it is about, if it is
/// about one.
pub fn refusal<N: Transmit>(refusal: &Refusal<N>, ticks: u32, units: &Units) -> String {
    match refusal {
        Refusal::HelloFirst => "the board has had no hello since it was switched on".into(),
        Refusal::Protocol { expected } => format!(
            "the board speaks version {expected} of the protocol, this program version {}",
            trirrr_protocol::message::PROTOCOL
        ),
        Refusal::Schema { expected } => format!(
            "the board's messages have another layout (schema key {expected:#010x}): it was built \
             for another number type, or from another version of this program"
        ),
        Refusal::Scene { expected } => format!(
            "the board was built for another scene (key {expected:#010x}): build its image from \
             this one, or name the scene that it has"
        ),
        Refusal::Sequence { expected } => {
            format!("the board expects request number {expected}: has it two clients?")
        }
        Refusal::SequenceReused => {
            "the request's number was used for another command: has the board two clients?".into()
        }
        Refusal::State(state) => format!(
            "not while the machine is {}",
            self::state(*state, Acting::Nothing)
        ),
        Refusal::NothingQueued => "no move is queued".into(),
        Refusal::Undecided => "a queued move is not admitted yet".into(),
        Refusal::EndsMoving => {
            "the queued moves end before the machine could come to rest on them".into()
        }
        Refusal::QueueFull => "the queue is full".into(),
        Refusal::MoveNumber { expected } => {
            format!("the board expects move number {expected}: has it two clients?")
        }
        Refusal::NotFinite => "a value is infinite or not a number".into(),
        Refusal::Duration { longest } => {
            format!("its duration is {ticks} ticks; 1 to {longest} are allowed")
        }
        Refusal::StartPose => {
            "it does not start where the last one ends, or where the machine stands".into()
        }
        Refusal::StartVelocity => "it does not start as fast as the last one ends".into(),
        Refusal::Tool => "the tool's power is not from 0 to 1, or its speed not positive".into(),
        Refusal::NotAdjustable => "the board's image holds no code to change its scene".into(),
        Refusal::NotInImage => {
            "the board's image holds no code for such links, loads or such a centre of mass".into()
        }
        Refusal::NoSuchLeg => "there is no such leg".into(),
        Refusal::Parameter { quantity, leg } => match leg {
            Some(leg) => format!("{quantity:?} of leg {} cannot be built", leg + 1),
            None => format!("{quantity:?} cannot be built"),
        },
        Refusal::NoPose => "with the new geometry, no pose fits the motors' angles".into(),
        Refusal::Recovery(found) => violation(found, ticks, units),
        Refusal::Busy => "the board's tick has not taken the commands before this one".into(),
        Refusal::NoHoming => {
            "the scene has no [homing]: the board knows where its motors are".into()
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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

    #[test]
    fn values_are_turned_into_si_units() {
        let units = Units {
            length_m: 0.5,
            time_s: 0.1,
            mass_kg: 2.0,
            tick_rate_hz: 1000.0,
        };
        for (what, text) in [
            (Bounded::Reach, "1 m"),
            (Bounded::SerialDistance, "2"),
            (Bounded::Rate, "20 rad/s"),
            (Bounded::Acceleration, "200 rad/s^2"),
            // 2 kg 0.25 m^2 / 0.01 s^2 = 50 N m.
            (Bounded::Torque, "100 N m"),
            (Bounded::Power, "1000 W"),
        ] {
            assert_eq!(units.quantity(what, 2.0, 4), text);
        }
    }

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
