//! Words and SI units for what a machine reports.

pub mod board;
mod fault;
mod limit;
mod refusal;

pub use fault::fault;
pub use limit::violation;
pub use refusal::refusal;

use limit::subject;
use trirrr_protocol::message::{Acting, Bounded, Identity, State};
use trirrr_scene::Scene;

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

    /// Returns one unit of `what` in SI, and the name of the SI unit.
    fn of_bounded(&self, what: Bounded) -> (f64, &'static str) {
        let [length, time, mass] = what.dimension();
        let unit = self.length_m.powi(length) * self.time_s.powi(time) * self.mass_kg.powi(mass);
        let name = match what {
            Bounded::Reach => " m",
            Bounded::SerialDistance | Bounded::ParallelDistance | Bounded::Range => "",
            Bounded::Rate => " rad/s",
            Bounded::Acceleration => " rad/s^2",
            Bounded::Torque => " N m",
            Bounded::Power => " W",
        };
        (unit, name)
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

/// Formats a number with four significant digits, without trailing zeros.
pub fn short(value: f64) -> String {
    rounded(value, 4)
}

fn rounded(value: f64, digits: usize) -> String {
    let decimals = digits.saturating_sub(1);
    let rounded: f64 = format!("{value:.decimals$e}").parse().unwrap_or(value);
    let text = format!("{rounded:?}");
    text.strip_suffix(".0").map(Into::into).unwrap_or(text)
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

#[cfg(test)]
mod tests {
    use super::*;

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
}
