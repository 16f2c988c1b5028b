use super::*;
use crate::wire::schema::{key, longest};
use crate::wire::{Decoder, FrameError, encode, frame_length};
use core::fmt::Debug;
use nalgebra::Vector3;
use std::vec;
use trirrr_core::limits::LimitParameters;
use trirrr_core::setpoint::{Pose, Setpoint};

fn telemetry<N: Number>() -> Telemetry<N> {
    let n = N::from_f64;
    Telemetry {
        tick: u32::MAX,
        state: State::Recovering,
        acting: Acting::Limit(Bounded::Range),
        number: u32::MAX,
        at: u32::MAX,
        part: u32::MAX,
        lost: u32::MAX,
        fields: TelemetryFields::ALL,
        setpoint: Setpoint {
            pose: Pose::from_f64(0.25, -0.5, 1.0),
            velocity: Vector3::new(n(1.0), n(2.0), n(3.0)),
            acceleration: Vector3::new(n(4.0), n(5.0), n(6.0)),
        },
        angles: [0.5, -1.0, 2.0].map(N::angle_from_f64),
        rates: [7.0, 8.0, 9.0].map(n),
        accelerations: [10.0, 11.0, 12.0].map(n),
        torques: [13.0, 14.0, 15.0].map(n),
        tool: n(0.5),
        duration: u32::MAX,
    }
}

fn survives<T: Transmitted>(message: T) {
    let mut room = vec![0; frame_length(longest::<T>())];
    let frame = encode(&message, &mut room).unwrap();
    let mut line = frame;
    let back: Option<Result<T, _>> = Decoder::<512>::new().take(&mut line);
    assert_eq!(back, Some(Ok(message)));
}

trait Transmitted: Serialize + DeserializeOwned + Schema + Debug + PartialEq {}
impl<T: Serialize + DeserializeOwned + Schema + Debug + PartialEq> Transmitted for T {}

/// Each variant of a kind travels and comes back the same, and the greatest length that the wire
/// reckons with is enough.
#[test]
fn messages_survive_the_line() {
    survives(Message::<f32>::Telemetry(telemetry()));
    survives(Message::<f64>::Telemetry(telemetry()));
    survives(Request::<f32> {
        sequence: 8,
        command: Command::Job(JobLabel {
            name: [b'a'; NAME_CAPACITY],
            items: u32::MAX,
            check: u32::MAX,
        }),
    });
    survives(Request::<f32> {
        sequence: 7,
        command: Command::Move(Move {
            number: 3,
            from: Pose::<f32>::from_f64(0.1, 0.2, 0.3),
            to: Pose::from_f64(0.4, 0.5, 0.6),
            start_velocity: [0.0; 3],
            end_velocity: [1.0, 2.0, 3.0],
            ticks: 100,
            tool_power: 0.5,
            tool_speed: 0.1,
        }),
    });
    survives(Request::<f32> {
        sequence: 9,
        command: Command::Update(UpdateStep::Block(ImageBlock::new(u32::MAX, &[0xA5; BLOCK]))),
    });
    survives(Message::<f64>::Reply {
        sequence: 9,
        reply: Reply::Refused(Refusal::Recovery(Violation {
            what: Bounded::Rate,
            index: Some(2),
            at: 0.5,
            value: 3.0,
            error: Some(0.5),
            limit: 2.0,
            certain: true,
            ramp: false,
            shortest: Some(LeastDuration {
                enough: 150,
                too_short: 149,
            }),
        })),
    });
}

/// A machine that takes no part of a scene has the layout of all others, and reads what a part is as
/// little as whether it is one.
#[test]
fn a_part_that_is_not_read_may_be_anything() {
    type Short = Request<f32, Unread>;
    assert_eq!(
        key::<Request<f32>, Message<f32>>(),
        key::<Short, Message<f32>>()
    );
    assert_eq!(longest::<Request<f32>>(), longest::<Short>());
    fn heard(content: impl Serialize) -> Result<Short, FrameError> {
        let mut room = [0; 256];
        let mut line = encode(&content, &mut room).unwrap();
        Decoder::<256>::new().take(&mut line).unwrap()
    }
    let expected = Request {
        sequence: 7,
        command: Command::Replace(Unread::CONTENT),
    };
    let limits = scene::Limits::from(&LimitParameters::default());
    let whole = Request::<f32> {
        sequence: 7,
        command: Command::Replace(scene::Section::Limits(limits)),
    };
    assert_eq!(heard(whole), Ok(expected));
    // By its place in the enum, with nothing and with nonsense behind it.
    assert_eq!(heard((7u32, 3u32)), Ok(expected));
    assert_eq!(heard((7u32, 3u32, [0xFFu8; 32])), Ok(expected));
    // What is not a part of a scene is read as ever.
    assert_eq!(heard((7u32, 13u32)), Err(FrameError::Message));
    assert_eq!(heard((7u32, 5u32, 1u8)), Err(FrameError::Trailing));
    let moved = Recovery {
        to: Pose::from_f64(0.1, 0.2, 0.3),
        ticks: 300,
    };
    let recover = Request::<f32> {
        sequence: 8,
        command: Command::Recover(moved),
    };
    let Ok(request) = heard(recover) else {
        panic!("a recovery is read");
    };
    assert_eq!(request.command, Command::Recover(moved));
}

/// What lies elsewhere is sent as it would be sent from a message.
#[test]
fn a_message_around_what_lies_elsewhere_has_the_same_bytes() {
    fn same(message: &Message<f32>) {
        let around = match message {
            Message::Reply { sequence, reply } => MessageRef::Reply {
                sequence: *sequence,
                reply,
            },
            Message::Event(event) => MessageRef::Event(event),
            Message::Telemetry(sample) => MessageRef::Telemetry(sample),
            Message::Drives(sample) => MessageRef::Drives(sample),
        };
        let (mut one, mut other) = ([0; 256], [0; 256]);
        assert_eq!(encode(&around, &mut one), encode(message, &mut other));
    }
    same(&Message::Telemetry(telemetry()));
    same(&Message::Drives(DriveSample {
        tick: 70_000,
        drives: [0.5, -0.25, 3.0].map(DriveReading::unheard),
    }));
    same(&Message::Event(Event::State {
        state: State::Slowing,
        acting: Acting::Hold,
        done: 700,
    }));
    same(&Message::Reply {
        sequence: 70_000,
        reply: Reply::Refused(Refusal::Busy),
    });
}

/// A full telemetry sample in f32 a thousand times a second takes less than 1.5 Mbaud: ten bits on
/// the line for each byte.
#[test]
fn telemetry_fits_the_line() {
    let bits = |bytes: usize| 10 * 1000 * frame_length(bytes);
    let longest = longest::<Telemetry<f32>>() + 1;
    assert!(bits(longest) < 1_500_000, "{longest}");
    // It is not small because something is missing: 21 numbers at least.
    assert!(longest > 21 * 4);
}

/// A sample carries the fields that were asked for and no other, and is no longer than what is said of it.
#[test]
fn a_sample_has_the_fields_that_were_chosen() {
    let all = telemetry::<f32>();
    let none = Telemetry {
        fields: TelemetryFields::NONE,
        setpoint: Setpoint {
            pose: Pose::from_f64(0.0, 0.0, 0.0),
            velocity: Vector3::zeros(),
            acceleration: Vector3::zeros(),
        },
        angles: [0.0; 3],
        rates: [0.0; 3],
        accelerations: [0.0; 3],
        torques: [0.0; 3],
        tool: 0.0,
        duration: 0,
        ..all
    };
    let mut lengths = vec![];
    for bits in 0..=TelemetryFields::ALL.0 {
        let fields = TelemetryFields(bits);
        let sent = Telemetry { fields, ..all };
        let mut room = [0; 256];
        let bytes = postcard::to_slice(&sent, &mut room).unwrap();
        assert!(bytes.len() <= Telemetry::<f32>::longest(fields));
        lengths.push(bytes.len());
        let mut expected = Telemetry { fields, ..none };
        let has = |field| fields.contain(field);
        if has(TelemetryFields::SETPOINT) {
            expected.setpoint = all.setpoint;
        }
        if has(TelemetryFields::ANGLES) {
            expected.angles = all.angles;
        }
        if has(TelemetryFields::RATES) {
            expected.rates = all.rates;
        }
        if has(TelemetryFields::ACCELERATIONS) {
            expected.accelerations = all.accelerations;
        }
        if has(TelemetryFields::TORQUES) {
            expected.torques = all.torques;
        }
        if has(TelemetryFields::TOOL) {
            expected.tool = all.tool;
        }
        if has(TelemetryFields::DURATION) {
            expected.duration = all.duration;
        }
        let (back, rest) = postcard::take_from_bytes::<Telemetry<f32>>(bytes).unwrap();
        assert_eq!((back, rest.len()), (expected, 0), "{bits:#b}");
    }
    // Setpoint, four vectors, power: 4 bytes a number; a duration of 5 bytes.
    assert_eq!(
        lengths[usize::from(TelemetryFields::ALL.0)] - lengths[0],
        4 * (9 + 12 + 1) + 5
    );
}
