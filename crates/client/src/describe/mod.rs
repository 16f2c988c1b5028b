//! Words and SI units for what a machine reports.

pub mod board;
mod drive;
mod fault;
mod refusal;

pub use drive::{drive_state, not_enabled};
pub use fault::fault;
pub use refusal::{refusal, scene_need};

use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{
    Acting, Bounded, DigitalStates, Event, Identity, InputState, InputStates, ProbeRun, State,
    Transmit, Violation,
};
use trirrr_scene::words::{self, short};
use trirrr_scene::{Scene, SparePins};

/// Units of a machine's messages, and the rate of its ticks.
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
    /// Returns SI units, as the float types have them, at `tick_rate_hz` ticks per second.
    pub fn si(tick_rate_hz: f64) -> Self {
        Self {
            length_m: 1.0,
            time_s: 1.0,
            mass_kg: 1.0,
            tick_rate_hz,
        }
    }

    /// Returns the `units` of the machine of `scene`.
    pub fn of_scene(scene: &Scene, units: &trirrr_core::units::Units) -> Self {
        Self {
            length_m: units.length_m(),
            time_s: units.time_s(),
            mass_kg: units.of(0, 0, 1),
            tick_rate_hz: scene.tick_rate_hz,
        }
    }

    /// Returns the units that a machine named in its answer to a hello.
    pub fn of(identity: &Identity) -> Self {
        Self {
            length_m: identity.length_m,
            time_s: identity.time_s,
            mass_kg: identity.mass_kg,
            tick_rate_hz: identity.tick_rate_hz,
        }
    }

    /// Returns one unit of `what` in SI.
    fn of_bounded(&self, what: Bounded) -> f64 {
        let [length, time, mass] = what.dimension();
        self.length_m.powi(length) * self.time_s.powi(time) * self.mass_kg.powi(mass)
    }
}

/// Describes the limit that a move of `ticks` would break or is not proven to keep, and the time within the
/// move.
pub fn violation<N: Transmit>(violation: &Violation<N>, ticks: u32, units: &Units) -> String {
    let found = violation.scaled(units.of_bounded(violation.what));
    let mut text = words::violation(&found);
    // The range of a coordinate is no matter of an instant.
    if found.what != Bounded::Range || found.index.is_none() {
        let time = found.at * f64::from(ticks) / units.tick_rate_hz;
        text += &format!(", {} s into the move", short(time));
    }
    if let Some(shortest) = &found.shortest {
        text += &format!("; {}", words::long_enough(shortest, units.tick_rate_hz));
    }
    text
}

/// Describes an event. `None`: a move was admitted, as moves should be. `ticks` is the duration of the move that was judged, 0 where it is not
/// known.
pub fn event<N: Transmit>(event: &Event<N>, ticks: u32, units: &Units) -> Option<String> {
    Some(match event {
        Event::Verdict(verdict) => {
            let why = violation(verdict.violation.as_ref()?, ticks, units);
            let counted = verdict.number.wrapping_add(1);
            format!("move {counted} is not admitted: {why}")
        }
        Event::State {
            state: now,
            acting,
            done,
        } => format!(
            "{}, {} done",
            state(*now, *acting),
            words::counted(*done as usize, "move")
        ),
        Event::Fault(latched) => format!("fault: {}", fault(latched, units)),
        Event::Inputs(states) => inputs(states)?,
        Event::Probe(run) => probe(run, units),
        Event::Digital(states) => digital(states, &SparePins::default()),
    })
}

/// Describes the spare outputs and inputs by their names in `pins`; by their numbers where there are none.
pub fn digital(states: &DigitalStates, pins: &SparePins) -> String {
    let list = |bits: u8, name: &dyn Fn(usize) -> Option<String>| {
        let set = (0..u8::BITS as usize).filter(|index| bits >> index & 1 != 0);
        let names: Vec<String> = set
            .map(|index| name(index).unwrap_or_else(|| index.to_string()))
            .collect();
        match names.is_empty() {
            true => "none".into(),
            false => names.join(", "),
        }
    };
    let outputs = list(states.outputs, &|index| {
        pins.outputs.get(index).map(|output| output.name.clone())
    });
    let inputs = list(states.inputs, &|index| {
        pins.inputs.get(index).map(|input| input.name.clone())
    });
    format!("outputs on: {outputs}; inputs active: {inputs}")
}

/// Describes a run with a probe: where it has touched, in m and rad.
pub fn probe<N: Transmit>(run: &ProbeRun<N>, units: &Units) -> String {
    let place = |pose: &Pose<N>| {
        let [x, y] = [pose.position.x, pose.position.y].map(|each| each.to_f64() * units.length_m);
        let alpha = N::angle_to_f64(pose.angle);
        format!("({x:.6}, {y:.6}, {alpha:.6})")
    };
    match run {
        ProbeRun::Armed => "the probe is armed".into(),
        ProbeRun::NotTouched => "the probe has touched nothing".into(),
        ProbeRun::Touched(contact) => {
            let measured = contact.measured.as_ref();
            let measured = measured.map(|pose| format!(", measured {}", place(pose)));
            format!(
                "the probe's contact at {} m, m, rad{} (tick {})",
                place(&contact.pose),
                measured.unwrap_or_default(),
                contact.tick
            )
        }
    }
}

/// Describes the inputs. `None`: the scene names none.
pub fn inputs(states: &InputStates) -> Option<String> {
    told(input_parts(states).into_iter().flatten())
}

/// Describes the inputs that are other than `before`; all of them where that is not known. `None`: none is.
pub fn input_changes(before: Option<&InputStates>, states: &InputStates) -> Option<String> {
    let before = before.map(input_parts).unwrap_or_default();
    let now = input_parts(states).into_iter().zip(before);
    told(
        now.filter(|(now, before)| now != before)
            .filter_map(|(now, _)| now),
    )
}

fn told(parts: impl Iterator<Item = String>) -> Option<String> {
    let parts: Vec<String> = parts.collect();
    (!parts.is_empty()).then(|| parts.join("; "))
}

/// Words for emergency stop, door, probe and limit switches; none for what the scene does not name.
fn input_parts(states: &InputStates) -> [Option<String>; 4] {
    let stop = match states.emergency_stop {
        InputState::Absent => None,
        InputState::Clear => Some("emergency stop released"),
        InputState::Active => Some("emergency stop pressed, or its wire broken"),
    };
    let door = match states.door {
        InputState::Absent => None,
        InputState::Clear => Some("door closed"),
        InputState::Active => Some("door open"),
    };
    let probe = match states.probe {
        InputState::Absent => None,
        InputState::Clear => Some("probe open"),
        InputState::Active => Some("probe touches"),
    };
    let reached = (1..).zip(states.limits);
    let reached: Vec<String> = reached
        .filter(|(_, limit)| limit.is_active())
        .map(|(motor, _): (u32, _)| motor.to_string())
        .collect();
    let limits = match states.limits.contains(&InputState::Clear) || !reached.is_empty() {
        false => None,
        true if reached.is_empty() => Some("no motor on its limit switch".into()),
        true => Some(format!("motor {} on its limit switch", reached.join(", "))),
    };
    let [stop, door, probe] = [stop, door, probe].map(|part| part.map(str::to_owned));
    [stop, door, probe, limits]
}

/// Describes the state, and the cause that keeps the machine from normal speed.
pub fn state(state: State, acting: Acting) -> String {
    let state = match state {
        State::Idle => "idle",
        State::Running => "running",
        State::Slowing => "slowing",
        State::Stopping => "stopping",
        State::Holding => "holding",
        State::Fault => "fault",
        State::Cleared => "on, pose unknown",
        State::Recovering => "recovering",
        State::Unhomed => "not homed",
        State::Homing => "homing",
        State::Disabled => "disabled",
        State::Enabling => "enabling",
        State::Disabling => "disabling",
        State::Reacting => "stopping after a fault",
    };
    let acting = match acting {
        Acting::Nothing => return state.into(),
        Acting::Hold => "hold",
        Acting::Resume => "resume",
        Acting::Stop => "stop",
        Acting::Silence => "host silent",
        Acting::QueueDry => "waiting for moves",
        Acting::Door => "door",
        Acting::Probe => "probe",
        Acting::Limit(what) => return format!("{state} ({})", words::subject(what, None)),
    };
    format!("{state} ({acting})")
}

#[cfg(test)]
mod tests {
    use super::*;
    use trirrr_protocol::message::LeastDuration;

    #[test]
    fn inputs_that_changed_are_told() {
        let before = InputStates {
            emergency_stop: InputState::Clear,
            door: InputState::Active,
            ..InputStates::default()
        };
        let now = InputStates {
            door: InputState::Clear,
            ..before
        };
        assert_eq!(
            input_changes(Some(&before), &now).as_deref(),
            Some("door closed")
        );
        assert_eq!(input_changes(Some(&now), &now), None);
        assert_eq!(input_changes(None, &now), inputs(&now));
        assert_eq!(
            inputs(&before).as_deref(),
            Some("emergency stop released; door open")
        );
    }

    #[test]
    fn a_violation_is_told_in_si_units_and_seconds() {
        let units = Units {
            length_m: 0.5,
            time_s: 0.1,
            mass_kg: 2.0,
            tick_rate_hz: 1000.0,
        };
        let found = |what| Violation {
            what,
            index: Some(1),
            at: 0.25,
            value: 2.0f32,
            error: Some(0.0),
            limit: 1.0,
            certain: true,
            ramp: false,
            shortest: Some(LeastDuration {
                enough: 640,
                too_short: 639,
            }),
        };
        for (what, text) in [
            (
                Bounded::Reach,
                "span of leg 2 would be 1 m, the most allowed is 0.5 m",
            ),
            (
                Bounded::Rate,
                "rate of motor 2 would be 20 rad/s, the most allowed is 10 rad/s",
            ),
            (
                Bounded::Acceleration,
                "acceleration of motor 2 would be 200 rad/s^2, the most allowed is 100 rad/s^2",
            ),
            // 2 kg 0.25 m^2 / 0.01 s^2 = 50 N m.
            (
                Bounded::Torque,
                "torque of motor 2 would be 100 N m, the most allowed is 50 N m",
            ),
            (
                Bounded::Power,
                "power of motor 2 would be 1000 W, the most allowed is 500 W",
            ),
            (
                Bounded::Jerk,
                "jerk of motor 2 would be 2000 rad/s^3, the most allowed is 1000 rad/s^3",
            ),
            (
                Bounded::AccelerationJump,
                "jump of the acceleration of motor 2 would be 200 rad/s^2, the most allowed is 100 rad/s^2",
            ),
        ] {
            let after =
                "0.1 s into the move; 640 ticks (0.64 s) would be long enough, 639 are too few";
            assert_eq!(
                violation(&found(what), 400, &units),
                format!("{text}, {after}")
            );
        }
    }
}
