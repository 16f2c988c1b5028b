//! Settings that a service takes when it is built.

use crate::pace::Ramp;
use crate::planner::Planning;
use postcard_schema::Schema;
use serde::{Deserialize, Serialize};
use trirrr_core::number::Number;
use trirrr_core::to_source;
use trirrr_core::units::Units;
use trirrr_protocol::message::{
    AngleReference, Board, FaultCode, Firmware, Identity, Message, NAME_CAPACITY, PROTOCOL,
    Request, Transmit, WINDOW,
};
use trirrr_protocol::wire::schema;

/// Settings of the service, from the scene. Times are ticks.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Settings<N: Number> {
    /// Length of a tick in the machine's unit of time.
    pub period: N::Factor,
    /// Ramp of a hold, a stop and a resume.
    pub ramp: Ramp,
    /// Silence of the host after which a machine that moves comes to rest; 0 for never.
    pub host_timeout_ticks: u32,
    /// One telemetry sample every so many ticks, until the host asks otherwise; 0 for none.
    pub telemetry_every: u16,
    /// Times that the drives and the brake take.
    pub power: PowerTimes,
    /// Stops at faults.
    pub reactions: Reactions,
    /// Tolerances and steps of the planner of paths, if the scene has one.
    pub planning: Option<Planning<N>>,
    /// Identity of the scene that the service sends in answer to a hello.
    pub scene: SceneIdentity,
    /// Description of the board that carries the service.
    pub board: Board,
    /// Build of the program that the service is in.
    pub firmware: &'static Firmware,
}

/// Times of switching drives on and off, in ticks.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct PowerTimes {
    /// From drives on until they hold the motors.
    pub drives_ticks: u16,
    /// From the brake released until it lets go.
    pub brake_release_ticks: u16,
    /// From the brake engaged until it holds.
    pub brake_engage_ticks: u16,
}

impl PowerTimes {
    /// Ticks from drives on until the machine is ready.
    pub(super) fn enable_ticks(&self) -> u16 {
        self.drives_ticks.saturating_add(self.brake_release_ticks)
    }
}

/// Stop of a machine at a fault: the categories of IEC 60204-1.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub enum StopCategory {
    /// Category 0: the drives go off at once, and the brake engages.
    Off,
    /// Category 1: the machine comes to rest on its path, the brake engages, then the drives go off.
    StopThenOff,
    /// Category 2: the machine comes to rest on its path, and the drives hold it.
    StopAndHold,
}

to_source!(pub StopCategory in trirrr_service: Off, StopThenOff, StopAndHold);

/// Stops at the faults that leave a machine controllable. At any other the drives go off at once.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct Reactions {
    /// At a [limit](FaultCode::Limit) of the results of a tick.
    pub limit: StopCategory,
    /// At a tick that came [too late](FaultCode::Overrun).
    pub overrun: StopCategory,
    /// At a [following error](FaultCode::FollowingError).
    pub following: StopCategory,
    /// At any other fault of a [drive](FaultCode::Drive).
    pub drive: StopCategory,
    /// At a [limit switch](FaultCode::LimitSwitch).
    pub limit_switch: StopCategory,
}

to_source!(pub [] Reactions [] in trirrr_service {
    limit,
    overrun,
    following,
    drive,
    limit_switch,
});

impl Default for Reactions {
    /// A machine that is controllable stops on its path. One with a drive that fails is not; one on a limit switch would go on
    /// beyond it.
    fn default() -> Self {
        Self {
            limit: StopCategory::StopThenOff,
            overrun: StopCategory::StopThenOff,
            following: StopCategory::StopThenOff,
            drive: StopCategory::Off,
            limit_switch: StopCategory::Off,
        }
    }
}

impl Reactions {
    /// The drives go off at once at every fault.
    pub const OFF: Self = Self {
        limit: StopCategory::Off,
        overrun: StopCategory::Off,
        following: StopCategory::Off,
        drive: StopCategory::Off,
        limit_switch: StopCategory::Off,
    };

    /// Stop at this fault.
    pub(super) fn to(&self, code: FaultCode) -> StopCategory {
        match code {
            FaultCode::Limit(_) => self.limit,
            FaultCode::Overrun => self.overrun,
            FaultCode::FollowingError => self.following,
            FaultCode::Drive(_) => self.drive,
            FaultCode::LimitSwitch => self.limit_switch,
            _ => StopCategory::Off,
        }
    }
}

to_source!(pub [] PowerTimes [] in trirrr_service {
    drives_ticks,
    brake_release_ticks,
    brake_engage_ticks,
});

/// Identity of the scene that a machine reports.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SceneIdentity {
    /// Key of the messages' layout, see [`wire::schema`](trirrr_protocol::wire::schema).
    pub schema: u64,
    /// Key of the scene; not 0.
    pub key: u32,
    /// Name, ASCII, zeros behind it.
    pub name: [u8; NAME_CAPACITY],
    /// Ticks per second.
    pub tick_rate_hz: f64,
    /// One unit of length in m, a power of two as [`Units`] are; 1 for the float types,
    pub length_m: f64,
    /// one unit of time in s,
    pub time_s: f64,
    /// one unit of mass in kg.
    pub mass_kg: f64,
    /// The way in which the machine knows where its motors are.
    pub reference: AngleReference,
}

to_source!(pub [] SceneIdentity [] in trirrr_service {
    schema,
    key,
    name,
    tick_rate_hz,
    length_m,
    time_s,
    mass_kg,
    reference,
});

/// `name` as an identity has it: cut where it is longer, zeros behind it.
pub const fn name(name: &str) -> [u8; NAME_CAPACITY] {
    let mut bytes = [0; NAME_CAPACITY];
    let mut index = 0;
    while index < NAME_CAPACITY && index < name.len() {
        bytes[index] = name.as_bytes()[index];
        index += 1;
    }
    bytes
}

/// Key of a text: FNV-1a, 32 bits, never 0. For the text of a scene's file.
pub const fn key(text: &[u8]) -> u32 {
    let mut key = 0x811c_9dc5_u32;
    let mut index = 0;
    while index < text.len() {
        key = (key ^ text[index] as u32).wrapping_mul(0x0100_0193);
        index += 1;
    }
    // 0 means any.
    if key == 0 { 1 } else { key }
}

impl SceneIdentity {
    /// The units that the machine is built in.
    pub(super) fn units(&self) -> Units {
        // Powers of two: their exponents.
        let exponent = |unit: f64| ((unit.to_bits() >> 52) & 0x7ff) as i32 - 1023;
        Units {
            length: exponent(self.length_m),
            time: exponent(self.time_s),
            mass: exponent(self.mass_kg),
        }
    }
}

impl<N: Transmit> Settings<N> {
    /// Returns settings for a machine in SI units on a host: a stop takes a tenth of a second, the
    /// host may stay silent, and telemetry is off until a host asks for samples.
    pub fn at(tick_rate_hz: f64) -> Self {
        Self {
            period: N::factor_from_f64(1.0 / tick_rate_hz),
            // From float to integer the cast saturates.
            ramp: Ramp::within(((0.1 * tick_rate_hz) as u16).max(1), None),
            host_timeout_ticks: 0,
            telemetry_every: 0,
            power: PowerTimes::default(),
            reactions: Reactions::default(),
            planning: None,
            scene: SceneIdentity {
                schema: schema::key::<Request<N>, Message<N>>(),
                key: key(b"scene"),
                name: name("scene"),
                tick_rate_hz,
                length_m: 1.0,
                time_s: 1.0,
                mass_kg: 1.0,
                reference: AngleReference::Declared,
            },
            board: Board::HOST,
            firmware: &Firmware::SIMULATOR,
        }
    }
}

impl<N: Number> Settings<N> {
    /// The identity of a machine that has room for so many moves, takes so many in a batch, and has room for so many levels.
    pub(super) fn identity(
        &self,
        (queue, batch, levels): (u16, u8, u16),
        next_sequence: u32,
    ) -> Identity {
        let scene = &self.scene;
        Identity {
            protocol: PROTOCOL,
            schema: scene.schema,
            scene: scene.key,
            name: scene.name,
            tick_rate_hz: scene.tick_rate_hz,
            length_m: scene.length_m,
            time_s: scene.time_s,
            mass_kg: scene.mass_kg,
            ramp_ticks: self.ramp.ticks,
            silence_ticks: self.host_timeout_ticks,
            queue,
            window: WINDOW as u8,
            batch,
            next_sequence,
            reference: scene.reference,
            board: self.board,
            levels,
            firmware: *self.firmware,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_cut_and_padded() {
        assert_eq!(&name("thesis")[..8], b"thesis\0\0");
        let long = "abcdefghijklmnopqrstuvwxyz0123456789";
        assert_eq!(&name(long), &long.as_bytes()[..NAME_CAPACITY]);
    }

    #[test]
    fn the_published_test_vectors_of_fnv_1a() {
        for (text, expected) in [
            ("", 0x811c_9dc5),
            ("a", 0xe40c_292c),
            ("foobar", 0xbf9c_f968),
        ] {
            assert_eq!(key(text.as_bytes()), expected, "{text:?}");
        }
    }
}
