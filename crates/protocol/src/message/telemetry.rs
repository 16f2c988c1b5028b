//! Telemetry: results of a tick, as many of them as the host has asked for.

use super::Transmit;
use super::state::{Acting, State};
use crate::wire::schema::longest;
use core::fmt;
use core::marker::PhantomData;
use core::ops::BitOr;
use postcard_schema::Schema;
use serde::de::{Error, SeqAccess, Visitor};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};

/// Fields of a [`Telemetry`] sample, a bit for each: setpoint 1, angles 2, rates 4, accelerations 8, torques 16, tool 32,
/// duration 64. All of them are 127. Other bits are ignored. Angles, rates, accelerations and torques of the motors
/// follow from the setpoint; a client that computes them gets more samples over a slow line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Schema)]
pub struct TelemetryFields(pub u16);

impl TelemetryFields {
    /// None: the sample tells the tick, the state, and the place on the path.
    pub const NONE: Self = Self(0);
    /// The setpoint. All that the motors do can be computed from it.
    pub const SETPOINT: Self = Self(1);
    /// Angles of the motors.
    pub const ANGLES: Self = Self(1 << 1);
    /// Rates of the motors.
    pub const RATES: Self = Self(1 << 2);
    /// Accelerations of the motors.
    pub const ACCELERATIONS: Self = Self(1 << 3);
    /// Torques of the motors.
    pub const TORQUES: Self = Self(1 << 4);
    /// Power of the tool.
    pub const TOOL: Self = Self(1 << 5);
    /// Duration of the tick before.
    pub const DURATION: Self = Self(1 << 6);
    /// All of them.
    pub const ALL: Self = Self((1 << 7) - 1);

    /// Each of them, with its name.
    pub const NAMES: [(&'static str, Self); 7] = [
        ("setpoint", Self::SETPOINT),
        ("angles", Self::ANGLES),
        ("rates", Self::RATES),
        ("accelerations", Self::ACCELERATIONS),
        ("torques", Self::TORQUES),
        ("tool", Self::TOOL),
        ("duration", Self::DURATION),
    ];

    /// Returns true if all of `fields` are among these.
    pub const fn contain(self, fields: Self) -> bool {
        self.0 & fields.0 == fields.0
    }
}

impl BitOr for TelemetryFields {
    type Output = Self;

    fn bitor(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

/// One tick: the setpoint and the motion of the motors for it. Behind `fields` come only those whose bits it has; the
/// others are read as 0.
#[derive(Clone, Copy, Debug, PartialEq, Schema)]
#[postcard(bound = "N: Transmit")]
pub struct Telemetry<N: Number> {
    /// Ticks since the machine was switched on, modulo 2^32.
    pub tick: u32,
    /// State of the service.
    pub state: State,
    /// Reason why the machine is not at normal speed.
    pub acting: Acting,
    /// Number of the move that is played, or of the last one.
    pub number: u32,
    /// Whole ticks of the move's own time that have passed.
    pub at: u32,
    /// The rest of that time, in parts of 256 `ramp_ticks` to the tick; always 0 at normal speed.
    pub part: u32,
    /// Samples dropped so far for lack of room, modulo 2^32.
    pub lost: u32,
    /// Fields that the sample has, of those that follow.
    pub fields: TelemetryFields,
    /// Pose, velocity, acceleration, time scaling included.
    pub setpoint: Setpoint<N>,
    /// theta_i1, directions of the proximal links, in (-pi, pi].
    pub angles: [N::Angle; 3],
    /// thetadot_i1.
    pub rates: [N; 3],
    /// thetaddot_i1.
    pub accelerations: [N; 3],
    /// Torques of the motors on the proximal links; 0 from a scene without torques.
    pub torques: [N; 3],
    /// Power of the tool, 0 to 1.
    pub tool: N,
    /// Latency of the tick before, from its due time until its outputs were set, in counts of the board's timer.
    pub duration: u32,
}

impl<N: Transmit> Telemetry<N> {
    /// Returns the most bytes that a sample with `fields` takes.
    pub fn longest(fields: TelemetryFields) -> usize {
        let vector = longest::<[N; 3]>();
        let left_out = TelemetryFields::NAMES
            .iter()
            .filter(|(_, field)| !fields.contain(*field));
        let bytes = left_out.map(|(_, field)| match *field {
            TelemetryFields::SETPOINT => longest::<Setpoint<N>>(),
            TelemetryFields::ANGLES => longest::<[N::Angle; 3]>(),
            TelemetryFields::TOOL => longest::<N>(),
            TelemetryFields::DURATION => longest::<u32>(),
            _ => vector,
        });
        longest::<Self>() - bytes.sum::<usize>()
    }
}

/// Name of the struct.
const NAME: &str = "Telemetry";

/// Names of all that a sample can have on the line, in its order.
const PARTS: [&str; 15] = [
    "tick",
    "state",
    "acting",
    "number",
    "at",
    "part",
    "lost",
    "fields",
    "setpoint",
    "angles",
    "rates",
    "accelerations",
    "torques",
    "tool",
    "duration",
];

impl<N: Transmit> Serialize for Telemetry<N> {
    // A part of the function that sends, as all of the encoder is.
    #[inline]
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut parts = serializer.serialize_struct(NAME, PARTS.len())?;
        parts.serialize_field("tick", &self.tick)?;
        parts.serialize_field("state", &self.state)?;
        parts.serialize_field("acting", &self.acting)?;
        parts.serialize_field("number", &self.number)?;
        parts.serialize_field("at", &self.at)?;
        parts.serialize_field("part", &self.part)?;
        parts.serialize_field("lost", &self.lost)?;
        parts.serialize_field("fields", &self.fields)?;
        let has = |field| self.fields.contain(field);
        if has(TelemetryFields::SETPOINT) {
            parts.serialize_field("setpoint", &self.setpoint)?;
        }
        if has(TelemetryFields::ANGLES) {
            parts.serialize_field("angles", &self.angles)?;
        }
        let vectors = [
            (TelemetryFields::RATES, &self.rates),
            (TelemetryFields::ACCELERATIONS, &self.accelerations),
            (TelemetryFields::TORQUES, &self.torques),
        ];
        for (field, vector) in vectors {
            if has(field) {
                parts.serialize_field("vector", vector)?;
            }
        }
        if has(TelemetryFields::TOOL) {
            parts.serialize_field("tool", &self.tool)?;
        }
        if has(TelemetryFields::DURATION) {
            parts.serialize_field("duration", &self.duration)?;
        }
        parts.end()
    }
}

impl<'de, N: Transmit> Deserialize<'de> for Telemetry<N> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_struct(NAME, &PARTS, SampleVisitor(PhantomData))
    }
}

/// Reader of a sample.
struct SampleVisitor<N>(PhantomData<N>);

impl<'de, N: Transmit> Visitor<'de> for SampleVisitor<N> {
    type Value = Telemetry<N>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a telemetry sample")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut parts: A) -> Result<Telemetry<N>, A::Error> {
        let parts = &mut parts;
        let (tick, state, acting) = (next(parts)?, next(parts)?, next(parts)?);
        let (number, at, part, lost) = (next(parts)?, next(parts)?, next(parts)?, next(parts)?);
        let fields: TelemetryFields = next(parts)?;
        let zero = [N::ZERO; 3];
        let no_angle = N::angle_from_f64(0.0);
        let nothing = Setpoint {
            pose: Pose::from_f64(0.0, 0.0, 0.0),
            velocity: zero.into(),
            acceleration: zero.into(),
        };
        Ok(Telemetry {
            tick,
            state,
            acting,
            number,
            at,
            part,
            lost,
            fields,
            setpoint: chosen(parts, fields, TelemetryFields::SETPOINT, nothing)?,
            angles: chosen(parts, fields, TelemetryFields::ANGLES, [no_angle; 3])?,
            rates: chosen(parts, fields, TelemetryFields::RATES, zero)?,
            accelerations: chosen(parts, fields, TelemetryFields::ACCELERATIONS, zero)?,
            torques: chosen(parts, fields, TelemetryFields::TORQUES, zero)?,
            tool: chosen(parts, fields, TelemetryFields::TOOL, N::ZERO)?,
            duration: chosen(parts, fields, TelemetryFields::DURATION, 0)?,
        })
    }
}

/// The next part of a sample.
fn next<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(parts: &mut A) -> Result<T, A::Error> {
    let part = parts.next_element()?;
    part.ok_or_else(|| Error::custom("a sample that ends too early"))
}

/// The next part of a sample if it is there, or else `none`.
fn chosen<'de, T: Deserialize<'de>, A: SeqAccess<'de>>(
    parts: &mut A,
    fields: TelemetryFields,
    field: TelemetryFields,
    none: T,
) -> Result<T, A::Error> {
    match fields.contain(field) {
        true => next(parts),
        false => Ok(none),
    }
}
