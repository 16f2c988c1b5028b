//! Topics of a machine: tables as JSON with a schema that says the units, and Foxglove's own messages for the 3D panel and the log.

use crate::drawing::{self, WORLD};
use crate::error::FoxgloveError;
use foxglove::messages::{FrameTransform, Log, Quaternion, SceneUpdate, Timestamp, Vector3, log};
use foxglove::{Channel, Context, PartialMetadata, RawChannel, Schema};
use serde_json::{Value, json};
use std::sync::Arc;
use trirrr_client::drive_records::DriveRecord;
use trirrr_scene::record::Record;

/// Frame of the platform, at D.
pub(crate) const PLATFORM: &str = "platform";

/// A value of a topic: its name, its number of elements, none for a single one, and what it is.
type Field = (&'static str, Option<u32>, &'static str);

const PLATFORM_FIELDS: [Field; 11] = [
    ("x", None, "x of D, m"),
    ("y", None, "y of D, m"),
    (
        "alpha",
        None,
        "angle of the platform, rad, counter-clockwise",
    ),
    ("vx", None, "velocity of D along x, m/s"),
    ("vy", None, "velocity of D along y, m/s"),
    ("valpha", None, "rate of the platform, rad/s"),
    ("ax", None, "acceleration of D along x, m/s^2"),
    ("ay", None, "acceleration of D along y, m/s^2"),
    (
        "aalpha",
        None,
        "angular acceleration of the platform, rad/s^2",
    ),
    (
        "parallel",
        None,
        "distance from the parallel singularity, 0 to 1",
    ),
    ("tool", None, "power of the tool, 0 to 1"),
];

const MOTOR_FIELDS: [Field; 6] = [
    (
        "th1",
        Some(3),
        "angles of the motors, rad, counter-clockwise from x",
    ),
    ("dth1", Some(3), "rates of the motors, rad/s"),
    ("ddth1", Some(3), "accelerations of the motors, rad/s^2"),
    (
        "tau",
        Some(3),
        "torques of the motors on the proximal links, N m",
    ),
    ("power", Some(3), "mechanical powers of the motors, W"),
    (
        "serial",
        Some(3),
        "distances of the legs from the serial singularity, 0 to 1",
    ),
];

const DRIVE_FIELDS: [Field; 5] = [
    ("th1", Some(3), "measured angles, rad"),
    ("dth1", Some(3), "measured rates, rad/s"),
    ("tau", Some(3), "measured torques, N m"),
    ("error", Some(3), "measured less commanded angles, rad"),
    (
        "ext_tau",
        Some(3),
        "torques of the surroundings on the joints, N m",
    ),
];

/// Least time from one drawing to the next, ns: more are not seen, and would be half of a recording.
const DRAWING_NS: u64 = 16_000_000;

/// Channels of a machine.
pub(crate) struct Topics {
    platform: Arc<RawChannel>,
    motors: Arc<RawChannel>,
    drives: Arc<RawChannel>,
    state: Arc<RawChannel>,
    log: Channel<Log>,
    transform: Channel<FrameTransform>,
    scene: Channel<SceneUpdate>,
    samples: u64,
    /// Time of the last drawing, ns since 1970.
    drawn: Option<u64>,
}

impl Topics {
    /// Opens the topics for all that listens at `context`.
    ///
    /// # Errors
    /// A topic that is refused.
    pub(crate) fn new(context: &Arc<Context>) -> Result<Self, FoxgloveError> {
        let table = |topic: &str, properties: Value| {
            let name = format!("trirrr{}", topic.replace('/', "."));
            let schema = json!({ "title": name, "type": "object", "properties": properties });
            let channel = context
                .channel_builder(topic)
                .message_encoding("json")
                .schema(Schema::new(
                    name,
                    "jsonschema",
                    schema.to_string().into_bytes(),
                ))
                .build_raw();
            channel.map_err(|error| FoxgloveError::Failed(format!("{topic}: {error}")))
        };
        let state = json!({
            "state": { "type": "string", "description": "state of the machine" },
            "move": { "type": "integer", "description": "number of the move under way, or of the last one" },
            "lost": { "type": "integer", "description": "samples that the machine dropped, as nobody fetched them" },
        });
        Ok(Self {
            platform: table("/platform", properties(&PLATFORM_FIELDS))?,
            motors: table("/motors", properties(&MOTOR_FIELDS))?,
            drives: table("/drives", properties(&DRIVE_FIELDS))?,
            state: table("/state", state)?,
            log: context.channel_builder("/log").build(),
            transform: context.channel_builder("/tf").build(),
            scene: context.channel_builder("/scene").build(),
            samples: 0,
            drawn: None,
        })
    }

    /// Number of samples so far.
    pub(crate) fn samples(&self) -> u64 {
        self.samples
    }

    /// Gives out the record of a tick, `at` nanoseconds since 1970.
    pub(crate) fn record(&mut self, record: &Record, at: u64) {
        self.samples += 1;
        let ([x, y, alpha], [vx, vy, valpha]) = (record.pose, record.velocity);
        let [ax, ay, aalpha] = record.acceleration;
        let values = [
            x,
            y,
            alpha,
            vx,
            vy,
            valpha,
            ax,
            ay,
            aalpha,
            record.parallel,
            record.tool,
        ];
        send(&self.platform, at, || single(&PLATFORM_FIELDS, values));
        let of_legs =
            |value: fn(&trirrr_scene::record::LegRecord) -> f64| record.legs.each_ref().map(value);
        let values = [
            of_legs(|leg| leg.th1),
            of_legs(|leg| leg.dth1),
            of_legs(|leg| leg.ddth1),
            of_legs(|leg| leg.torque),
            of_legs(|leg| leg.power),
            of_legs(|leg| leg.serial),
        ];
        send(&self.motors, at, || triples(&MOTOR_FIELDS, values));
        let meta = PartialMetadata::with_log_time(at);
        let (sin, cos) = (0.5 * alpha).sin_cos();
        let transform = FrameTransform {
            timestamp: Some(timestamp(at)),
            parent_frame_id: WORLD.into(),
            child_frame_id: PLATFORM.into(),
            translation: Some(Vector3 { x, y, z: 0.0 }),
            rotation: Some(Quaternion {
                x: 0.0,
                y: 0.0,
                z: sin,
                w: cos,
            }),
        };
        self.transform.log_with_meta(&transform, meta);
        // Drawings are made for somebody who looks.
        let is_due = self.drawn.is_none_or(|drawn| at >= drawn + DRAWING_NS);
        if is_due && self.scene.has_sinks() {
            self.drawn = Some(at);
            let update = drawing::update(record, timestamp(at));
            self.scene.log_with_meta(&update, meta);
        }
    }

    /// Gives out readings of the drives.
    pub(crate) fn drives(&self, record: &DriveRecord, at: u64) {
        let each = |value: fn(&trirrr_client::drive_records::JointState) -> f64| {
            record.measured.each_ref().map(value)
        };
        let error = [0, 1, 2].map(|motor| {
            let error = record.measured[motor].angle - record.commanded[motor].angle;
            error.sin().atan2(error.cos())
        });
        let values = [
            each(|joint| joint.angle),
            each(|joint| joint.rate),
            each(|joint| joint.torque),
            error,
            record.external,
        ];
        send(&self.drives, at, || triples(&DRIVE_FIELDS, values));
    }

    /// Gives out the state.
    pub(crate) fn state(&self, state: &str, number: u32, lost: u32, at: u64) {
        send(
            &self.state,
            at,
            || json!({ "state": state, "move": number, "lost": lost }),
        );
    }

    /// Gives out a sentence.
    pub(crate) fn say(&self, text: &str, is_warning: bool, at: u64) {
        let level = match is_warning {
            true => log::Level::Warning,
            false => log::Level::Info,
        };
        let message = Log {
            timestamp: Some(timestamp(at)),
            level: level.into(),
            message: text.into(),
            name: "trirrr".into(),
            ..Log::default()
        };
        let meta = PartialMetadata::with_log_time(at);
        self.log.log_with_meta(&message, meta);
    }
}

fn properties(fields: &[Field]) -> Value {
    let property = |(name, count, what): &Field| {
        let property = match count {
            None => json!({ "type": "number", "description": what }),
            Some(count) => json!({
                "type": "array", "items": { "type": "number" }, "minItems": count, "maxItems": count, "description": what,
            }),
        };
        ((*name).to_owned(), property)
    };
    Value::Object(fields.iter().map(property).collect())
}

fn single<const COUNT: usize>(fields: &[Field; COUNT], values: [f64; COUNT]) -> Value {
    let named = fields.iter().zip(values);
    Value::Object(
        named
            .map(|((name, ..), value)| ((*name).into(), value.into()))
            .collect(),
    )
}

fn triples<const COUNT: usize>(fields: &[Field; COUNT], values: [[f64; 3]; COUNT]) -> Value {
    let named = fields.iter().zip(values);
    Value::Object(
        named
            .map(|((name, ..), value)| ((*name).into(), json!(value)))
            .collect(),
    )
}

/// Sends what `value` makes, if somebody listens.
fn send(channel: &RawChannel, at: u64, value: impl FnOnce() -> Value) {
    if channel.has_sinks() {
        let meta = PartialMetadata::with_log_time(at);
        channel.log_with_meta(value().to_string().as_bytes(), meta);
    }
}

/// Time of so many nanoseconds since 1970.
fn timestamp(at: u64) -> Timestamp {
    let (seconds, nanoseconds) = (at / 1_000_000_000, at % 1_000_000_000);
    // Until the year 2106.
    Timestamp::new(seconds as u32, nanoseconds as u32)
}
