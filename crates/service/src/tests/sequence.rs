//! Sequence numbers: executed once, in order.

use super::*;
use trirrr_protocol::message::{Acting, WINDOW};

fn commands() -> [Command<f64>; 5] {
    [
        Command::Move(rest(0, home(), pose(0.28, 0.28, 0.2), 100)),
        Command::Start,
        Command::Hold,
        Command::Resume,
        Command::Stop,
    ]
}

/// A repeated command gets the same answer and is not executed again.
#[test]
fn a_repeated_command_is_acknowledged_and_not_executed() {
    let play = |repeats: u32| {
        let mut bench = Bench::<Thesis<f64>>::new();
        let mut outputs = Vec::new();
        for (sequence, command) in (0..).zip(commands()) {
            for _ in 0..repeats {
                assert_eq!(bench.ask_as(sequence, command), Reply::Done, "{command:?}");
            }
            bench.judge();
            for _ in 0..25 {
                outputs.push(bench.tick());
                for _ in 1..repeats {
                    assert_eq!(bench.ask_as(sequence, command), Reply::Done, "{command:?}");
                }
            }
        }
        (outputs, bench.status())
    };
    let (once, again) = (play(1), play(3));
    assert!(once.0 == again.0);
    assert_eq!(once.1, again.1);
}

/// The same for the commands around a fault, and for overrides.
#[test]
fn what_is_repeated_around_a_fault_is_not_executed_again() {
    use trirrr_protocol::message::scene::{Leg, Section};
    use trirrr_protocol::message::{FaultCode, Recovery};
    let leg = Leg {
        distal_m: 0.201,
        ..Leg::from(&example().legs[0])
    };
    let recovery = Recovery {
        to: pose(0.25, 0.25, 0.1),
        ticks: 20,
    };
    let commands = [
        Command::telemetry(3),
        Command::Replace(Section::Leg { index: 0, leg }),
        Command::ClearFault,
        Command::Enable,
        Command::Recover(recovery),
        Command::Stop,
    ];
    let play = |repeats: u32| {
        let mut bench = Bench::<Thesis<f64>>::new();
        let mut outputs = Vec::new();
        for (sequence, command) in (0..).zip(commands) {
            if command == Command::ClearFault {
                bench
                    .service
                    .foreground
                    .raise(FaultCode::Board, None, 0.0, 0.0);
                outputs.push(bench.tick());
            }
            for _ in 0..repeats {
                assert_eq!(bench.ask_as(sequence, command), Reply::Done, "{command:?}");
            }
            for _ in 0..30 {
                outputs.push(bench.tick());
                for _ in 1..repeats {
                    assert_eq!(bench.ask_as(sequence, command), Reply::Done, "{command:?}");
                }
            }
        }
        (outputs, bench.status(), bench.telemetry, bench.events)
    };
    let (once, again) = (play(1), play(4));
    assert!(once == again);
    // The recovery was executed: it stands where that led.
    assert_eq!(once.1.end.unwrap().pose, recovery.to);
}

#[test]
fn a_repeated_refusal_is_the_same_refusal() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let nan = Move {
        ticks: 10,
        ..rest(0, pose(f64::NAN, 0.0, 0.0), home(), 10)
    };
    for (sequence, command, refusal) in [
        (0, Command::Start, Refusal::NothingQueued),
        (1, Command::Hold, Refusal::State(State::Idle)),
        (2, Command::Move(nan), Refusal::NotFinite),
    ] {
        for _ in 0..3 {
            let reply = bench.ask_as(sequence, command);
            assert_eq!(reply, Reply::Refused(refusal));
        }
    }
    // Even where it would be accepted by now.
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.ask_as(0, Command::Hold);
    assert_eq!(
        bench.ask_as(0, Command::Hold),
        Reply::Refused(Refusal::State(State::Idle))
    );
}

/// Requests that the machine keeps, or answers again.
const WINDOW_SEQUENCES: u32 = WINDOW as u32;

#[test]
fn numbers_outside_of_the_window_are_refused_with_the_expected_one() {
    let mut bench = Bench::<Thesis<f64>>::new();
    for _ in 0..20 {
        bench.done(Command::telemetry(5));
        bench.tick();
    }
    let far = [20 + WINDOW_SEQUENCES, 20 - WINDOW_SEQUENCES - 1];
    for sequence in far.into_iter().chain([0, u32::MAX]) {
        assert_eq!(
            bench.ask_as(sequence, Command::Stop),
            Reply::Refused(Refusal::Sequence { expected: 20 })
        );
    }
    // What is repeated must be the same.
    for behind in 1..=WINDOW_SEQUENCES {
        let sequence = 20 - behind;
        let again = bench.ask_as(sequence, Command::telemetry(5));
        assert_eq!(again, Reply::Done);
        assert_eq!(
            bench.ask_as(sequence, Command::Stop),
            Reply::Refused(Refusal::SequenceReused)
        );
    }
    assert_eq!(bench.greet().next_sequence, 20);
    bench.done(Command::Stop);
}

/// Requests that come before one that is missing wait for it, and are executed in their order.
#[test]
fn what_comes_early_is_kept_and_executed_in_its_turn() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let there = pose(0.28, 0.28, 0.2);
    let moves: [Command<f64>; WINDOW] = core::array::from_fn(|i| {
        let (from, to) = match i % 2 {
            0 => (home(), there),
            _ => (there, home()),
        };
        Command::Move(rest(i as u32, from, to, 100))
    });
    // The last first; all but the first wait.
    for sequence in (1..WINDOW_SEQUENCES).rev() {
        for _ in 0..2 {
            let reply = bench.ask_as(sequence, moves[sequence as usize]);
            assert_eq!(reply, Reply::Kept { missing: 0 });
        }
        assert_eq!(bench.service.answer_kept(), None);
        assert_eq!(
            bench.ask_as(sequence, Command::Stop),
            Reply::Refused(Refusal::SequenceReused)
        );
    }
    assert_eq!(bench.status().next, 0);
    assert_eq!(bench.ask_as(0, moves[0]), Reply::Done);
    // The queue of the bench has room for one move less.
    for sequence in 1..WINDOW_SEQUENCES {
        let expected = match sequence < WINDOW_SEQUENCES - 1 {
            true => Reply::Done,
            false => Reply::Refused(Refusal::QueueFull),
        };
        assert_eq!(bench.service.answer_kept(), Some((sequence, expected)));
    }
    assert_eq!(bench.service.answer_kept(), None);
    assert_eq!(bench.status().next, WINDOW_SEQUENCES - 1);
    // Each has its answer when it is asked for again.
    for sequence in 0..WINDOW_SEQUENCES {
        let again = bench.ask_as(sequence, moves[sequence as usize]);
        assert_eq!(again == Reply::Done, sequence < WINDOW_SEQUENCES - 1);
    }
    assert_eq!(bench.greet().next_sequence, WINDOW_SEQUENCES);
}

/// What was kept is of the conversation before.
#[test]
fn a_hello_drops_what_was_kept() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let kept = bench.ask_as(1, Command::telemetry(7));
    assert_eq!(kept, Reply::Kept { missing: 0 });
    assert_eq!(bench.greet().next_sequence, 0);
    assert_eq!(bench.ask_as(0, Command::Stop), Reply::Done);
    assert_eq!(bench.service.answer_kept(), None);
    // Nor is its number used up.
    assert_eq!(bench.ask_as(1, Command::Stop), Reply::Done);
}

/// A request of an old conversation may arrive in the new one, where it would be the next, or kept.
#[test]
fn what_comes_late_from_another_conversation_is_not_executed() {
    let mut bench = Bench::<Thesis<f64>>::new();
    for sequence in 0..3 {
        assert_eq!(bench.ask_as(sequence, Command::Stop), Reply::Done);
    }
    let hello = Hello {
        protocol: PROTOCOL,
        schema: SCHEMA,
        scene: SCENE,
    };
    let mut first = None;
    // A repeated hello is answered as it was.
    for _ in 0..2 {
        let Reply::Hello(identity) = bench.ask_as(777, Command::Hello(hello)) else {
            panic!("a hello that fits is answered");
        };
        assert_eq!(
            *first.get_or_insert(identity.next_sequence),
            identity.next_sequence
        );
    }
    let next = first.unwrap();
    for late in 0..3 + WINDOW_SEQUENCES {
        assert_eq!(
            bench.ask_as(late, Command::Start),
            Reply::Refused(Refusal::Sequence { expected: next })
        );
    }
    assert_eq!(bench.ask_as(next, Command::Stop), Reply::Done);
}

#[test]
fn sequence_numbers_go_round() {
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.service.background.next_sequence_is(u32::MAX);
    assert_eq!(bench.ask_as(u32::MAX, Command::Stop), Reply::Done);
    assert_eq!(bench.ask_as(0, Command::Stop), Reply::Done);
    assert_eq!(bench.ask_as(0, Command::Stop), Reply::Done);
}

/// Questions are answered anew when they are repeated.
#[test]
fn a_repeated_question_has_a_fresh_answer() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let tick = |reply| match reply {
        Reply::Status(status) => status.tick,
        other => panic!("{other:?}"),
    };
    let first = tick(bench.ask_as(0, Command::Status));
    bench.ticks(5);
    assert_eq!(tick(bench.ask_as(0, Command::Status)), first + 5);
}

#[test]
fn nothing_is_heard_before_a_hello_that_fits() {
    let channels: Channels<Thesis<f64>, 8, 8> = Channels::new();
    let scene = Adjustable::new(example(), LimitParameters::default());
    let (_, mut background) = Box::leak(Box::new(channels))
        .split(scene, home(), settings())
        .unwrap();
    let mut ask = |command| hear(&mut background, 0, command);
    assert_eq!(ask(Command::Status), Reply::Refused(Refusal::HelloFirst));
    let right = Hello {
        protocol: PROTOCOL,
        schema: SCHEMA,
        scene: SCENE,
    };
    let cases = [
        (
            Hello {
                protocol: PROTOCOL + 1,
                ..right
            },
            Refusal::Protocol { expected: PROTOCOL },
        ),
        (
            Hello {
                schema: SCHEMA + 1,
                ..right
            },
            Refusal::Schema { expected: SCHEMA },
        ),
        (
            Hello {
                scene: SCENE + 1,
                ..right
            },
            Refusal::Scene { expected: SCENE },
        ),
    ];
    for (hello, refusal) in cases {
        assert_eq!(ask(Command::Hello(hello)), Reply::Refused(refusal));
        assert_eq!(ask(Command::Status), Reply::Refused(Refusal::HelloFirst));
    }
    let any = Hello { scene: 0, ..right };
    let Reply::Hello(identity) = ask(Command::Hello(any)) else {
        panic!("a hello that fits is answered");
    };
    assert_eq!((identity.scene, identity.queue), (SCENE, 7));
    background.next_sequence_is(0);
    let mut ask = |command| hear(&mut background, 0, command);
    let Reply::Status(status) = ask(Command::Status) else {
        panic!("and then a question too");
    };
    assert_eq!(
        (status.state, status.acting),
        (State::Disabled, Acting::Nothing)
    );
}
