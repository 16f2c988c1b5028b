//! The example frames: encoded, they are what the document shows; decoded, they are the messages.

use super::document;
use nalgebra::Vector3;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fmt::Debug;
use std::fmt::Write;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::{
    Acting, AngleReference, AnyMove, Board, Bounded, Clock, Command, Event, Firmware, Hello,
    Identity, JobLabel, LeastDuration, LevelPiece, LevelRange, ListedMove, Message, Move,
    MoveBatch, NAME_CAPACITY, PROTOCOL, QuinticMove, Refusal, Reply, Request, Start, State,
    Telemetry, TelemetryFields, Transmit, Verdict, Violation,
};
use trirrr_protocol::wire::schema::key;
use trirrr_protocol::wire::{Decoder, encode};

/// An example's section in the document. Its frame is decoded on the way.
fn section<T>(name: &str, what: &str, message: &T) -> String
where
    T: Serialize + DeserializeOwned + PartialEq + Debug,
{
    let mut room = [0; 512];
    let plain = postcard::to_slice(message, &mut room).expect(name).to_vec();
    let frame = encode(message, &mut room).expect(name).to_vec();

    let mut decoder = Decoder::<512>::new();
    for byte in &frame[..frame.len() - 1] {
        assert_eq!(decoder.feed::<T>(*byte), None, "{name}");
    }
    let decoded = decoder
        .feed::<T>(0)
        .expect("the frame is over")
        .expect(name);
    assert_eq!(&decoded, message, "{name}");

    let hex = |bytes: &[u8]| {
        let mut text = String::new();
        for line in bytes.chunks(24) {
            text += "\n ";
            line.iter()
                .for_each(|byte| write!(text, " {byte:02X}").expect("a String takes it"));
        }
        text
    };
    format!(
        "### `{name}`\n\n{what}\n\n```text\nmessage:{}\nframe:{}\n```\n\n",
        hex(&plain),
        hex(&frame)
    )
}

fn hello<N: Transmit>(sequence: u32) -> Request<N> {
    Request {
        sequence,
        command: Command::Hello(Hello {
            protocol: PROTOCOL,
            schema: key::<Request<N>, Message<N>>(),
            scene: 0,
        }),
    }
}

fn plain<N: Transmit>(sequence: u32, command: Command<N>) -> Request<N> {
    Request { sequence, command }
}

/// x 0.21 -> 0.28 m, y 0.22 -> 0.28 m, alpha 0.15 -> 0.2 rad in 300 ticks, to a speed of 0.1 m/s.
fn a_move<N: Transmit>() -> Request<N> {
    let n = N::from_f64;
    Request {
        sequence: 300,
        command: Command::Move(Move {
            number: 2,
            from: Pose::from_f64(0.21, 0.22, 0.15),
            to: Pose::from_f64(0.28, 0.28, 0.2),
            start_velocity: [N::ZERO; 3],
            end_velocity: [n(0.1), n(0.0), n(0.0)],
            ticks: 300,
            tool_power: n(0.75),
            tool_speed: n(0.1),
        }),
    }
}

/// The same move with an acceleration at its end: 0.5 m/s^2 along x.
fn a_quintic() -> Request<f32> {
    let Command::Move(common) = a_move().command else {
        unreachable!("it is one");
    };
    plain(
        300,
        Command::Quintic(QuinticMove {
            common,
            start_acceleration: [0.0; 3],
            end_acceleration: [0.5, 0.0, 0.0],
        }),
    )
}

/// Two moves behind it: a cubic, and a quintic with the tool.
fn moves() -> Request<f32> {
    let Command::Move(before) = a_move().command else {
        unreachable!("it is one");
    };
    let corner = Pose::from_f64(0.29, 0.28, 0.2);
    let cubic = Move {
        number: 3,
        from: before.to,
        to: corner,
        start_velocity: before.end_velocity,
        end_velocity: before.end_velocity,
        ticks: 100,
        tool_power: 0.0,
        tool_speed: 0.0,
    };
    let common = Move {
        number: 4,
        from: corner,
        to: Pose::from_f64(0.3, 0.28, 0.2),
        end_velocity: [0.0; 3],
        ticks: 200,
        tool_power: 0.75,
        tool_speed: 0.1,
        ..cubic
    };
    let quintic = QuinticMove {
        common,
        start_acceleration: [0.0; 3],
        end_acceleration: [0.0; 3],
    };
    let moves = [AnyMove::Cubic(cubic), AnyMove::Quintic(quintic)];
    let batch = MoveBatch::new(3, &AnyMove::Cubic(before).end(), &moves);
    plain(303, Command::Moves(batch))
}

/// Four levels for a move, behind 1000 that were given before.
fn levels() -> Request<f32> {
    plain(
        303,
        Command::Levels(LevelPiece::new(1000, &[0, 85, 170, 255])),
    )
}

/// The move: over 3.5 levels, from the middle of the first on.
fn listed() -> Request<f32> {
    let Command::Move(before) = a_move().command else {
        unreachable!("it is one");
    };
    let cubic = Move {
        number: 3,
        from: before.to,
        to: Pose::from_f64(0.29, 0.28, 0.2),
        start_velocity: before.end_velocity,
        ticks: 100,
        ..before
    };
    let range = LevelRange {
        first: 1000,
        count: 4,
        offset: 32_768,
        span: 229_376,
    };
    let start = AnyMove::Cubic(before).end();
    let listed = ListedMove::new(3, &start, &AnyMove::Cubic(cubic), range);
    plain(304, Command::Listed(listed))
}

fn identity() -> Message<f32> {
    let mut name = [0; NAME_CAPACITY];
    name[..6].copy_from_slice(b"thesis");
    Message::Reply {
        sequence: 7,
        reply: Reply::Hello(Identity {
            protocol: PROTOCOL,
            schema: key::<Request<f32>, Message<f32>>(),
            scene: 0x1234_5678,
            name,
            tick_rate_hz: 1000.0,
            length_m: 1.0,
            time_s: 1.0,
            mass_kg: 1.0,
            ramp_ticks: 100,
            silence_ticks: 1000,
            queue: 256,
            window: 8,
            batch: 4,
            next_sequence: 300,
            reference: AngleReference::Homed,
            board: Board {
                timer_hz: 168_000_000,
                clock: Clock::Crystal,
                start: Start::Power,
            },
            levels: 4096,
            firmware: Firmware::new("0.2.0", "13154213b7-dirty", "generic-f405", "stm32f405rg"),
        }),
    }
}

fn job() -> Request<f32> {
    let mut name = [0; NAME_CAPACITY];
    name[..6].copy_from_slice(b"thesis");
    let label = JobLabel {
        name,
        items: 25,
        check: 0x89AB_CDEF,
    };
    plain(302, Command::Job(label))
}

fn telemetry() -> Message<f32> {
    Message::Telemetry(Telemetry {
        tick: 100_000,
        state: State::Running,
        acting: Acting::Nothing,
        number: 2,
        at: 150,
        part: 0,
        lost: 0,
        fields: TelemetryFields::ALL,
        setpoint: Setpoint {
            pose: Pose::from_f64(0.25, 0.5, 0.125),
            velocity: Vector3::new(0.1, -0.2, 0.3),
            acceleration: Vector3::new(-1.0, 2.0, 0.0),
        },
        angles: [1.5, -0.5, 3.0],
        rates: [0.5, -1.5, 0.25],
        accelerations: [10.0, -20.0, 30.0],
        torques: [0.0125, -0.03, 0.5],
        tool: 0.75,
        duration: 499,
    })
}

#[test]
fn the_example_frames_are_the_messages() {
    let sections = [
        section(
            "hello",
            "To an f32 machine with any scene.",
            &hello::<f32>(7),
        ),
        section(
            "hello-f64",
            "To an f64 machine with any scene.",
            &hello::<f64>(7),
        ),
        section(
            "identity",
            "Its answer: the scene `thesis`, 1000 ticks per second.",
            &identity(),
        ),
        section(
            "status",
            "The question; a request without content.",
            &plain::<f32>(301, Command::Status),
        ),
        section(
            "move",
            "From (0.21 m, 0.22 m, 0.15 rad) at rest to (0.28 m, 0.28 m, 0.2 rad) at 0.1 m/s along \
             x, in 300 ticks, the tool at 0.75 for a speed of 0.1 m/s.",
            &a_move::<f32>(),
        ),
        section("move-f64", "The same to an f64 machine.", &a_move::<f64>()),
        section(
            "quintic",
            "The same as a quintic, from no acceleration to 0.5 m/s^2 along x.",
            &a_quintic(),
        ),
        section(
            "moves",
            "Behind `move`: move 3, a cubic over 0.01 m in 100 ticks at the same speed, with the tool off; move 4, a quintic over \
             0.01 m to rest in 200 ticks, with the tool as before.",
            &moves(),
        ),
        section(
            "telemetry-rate",
            "A sample every tenth tick.",
            &plain::<f32>(302, Command::telemetry(10)),
        ),
        section(
            "done",
            "The move is taken.",
            &Message::<f32>::Reply {
                sequence: 300,
                reply: Reply::Done,
            },
        ),
        section(
            "out-of-sequence",
            "Request 315 is too far from the next one.",
            &Message::<f32>::Reply {
                sequence: 315,
                reply: Reply::Refused(Refusal::Sequence { expected: 303 }),
            },
        ),
        section(
            "kept",
            "Request 304 came before 303.",
            &Message::<f32>::Reply {
                sequence: 304,
                reply: Reply::Kept { missing: 303 },
            },
        ),
        section(
            "not-admitted",
            "Move 2 would need 1.125 to 1.375 N m of motor 2, which may give 1 N m, at a half of its way; \
             640 ticks pass, 639 are too few.",
            &Message::<f32>::Event(Event::Verdict(Verdict {
                number: 2,
                violation: Some(Violation {
                    what: Bounded::Torque,
                    index: Some(1),
                    at: 0.5f32,
                    value: 1.25,
                    error: Some(0.125),
                    limit: 1.0,
                    certain: true,
                    ramp: true,
                    shortest: Some(LeastDuration {
                        enough: 640,
                        too_short: 639,
                    }),
                }),
            })),
        ),
        section(
            "telemetry",
            "A sample of tick 100,000, with all fields.",
            &telemetry(),
        ),
        section(
            "levels",
            "Four levels for a move, behind 1000 that were given before.",
            &levels(),
        ),
        section(
            "listed",
            "The move, behind `move`: 0.01 m along x in 100 ticks at the same speed and with the same tool, over 3.5 levels from \
             the middle of the first on.",
            &listed(),
        ),
        section("job", "The next 25 moves are the job `thesis`.", &job()),
    ];
    let expected = sections.concat();
    document::compare(
        "unless the\nname says otherwise.\n\n",
        "## The schema key\n",
        &expected,
    );
}
