//! What is offered: refusals one by one, verdicts, the queue.

use super::*;
use trirrr_core::setpoint::{Ends, Quintics, Segment};
use trirrr_protocol::message::{Acting, Bounded, QuinticMove};

fn offered() -> Move<f64> {
    rest(0, home(), pose(0.28, 0.28, 0.2), 100)
}

fn moving(
    number: u32,
    from: Pose<f64>,
    to: Pose<f64>,
    ends: [[f64; 3]; 2],
    ticks: u32,
) -> Move<f64> {
    Move {
        start_velocity: ends[0],
        end_velocity: ends[1],
        ..rest(number, from, to, ticks)
    }
}

#[test]
fn each_refusal_by_its_name_and_nothing_lost() {
    let good = offered();
    let longest = (1 << 31) / 8 - 1;
    let duration = Refusal::Duration { longest };
    let cases: [(Move<f64>, Refusal<f64>); 21] = [
        (
            Move {
                from: pose(f64::NAN, 0.22, 0.157),
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move {
                to: pose(0.28, f64::INFINITY, 0.2),
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move {
                to: pose(0.28, 0.28, f64::NEG_INFINITY),
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move {
                start_velocity: [0.0, f64::NAN, 0.0],
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move {
                end_velocity: [0.0, 0.0, f64::INFINITY],
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move {
                tool_power: f64::NAN,
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move {
                tool_speed: f64::INFINITY,
                ..good
            },
            Refusal::NotFinite,
        ),
        (
            Move { number: 1, ..good },
            Refusal::MoveNumber { expected: 0 },
        ),
        (
            Move {
                number: u32::MAX,
                ..good
            },
            Refusal::MoveNumber { expected: 0 },
        ),
        (Move { ticks: 0, ..good }, duration),
        (
            Move {
                ticks: longest + 1,
                ..good
            },
            duration,
        ),
        (
            Move {
                ticks: u32::MAX,
                ..good
            },
            duration,
        ),
        (
            Move {
                from: pose(0.21, 0.22, 0.157_000_000_000_000_1),
                ..good
            },
            Refusal::StartPose,
        ),
        (
            Move {
                from: pose(0.2100001, 0.22, 0.157),
                ..good
            },
            Refusal::StartPose,
        ),
        (
            Move {
                start_velocity: [1e-300, 0.0, 0.0],
                ..good
            },
            Refusal::StartVelocity,
        ),
        (
            Move {
                tool_power: -0.1,
                ..good
            },
            Refusal::Tool,
        ),
        (
            Move {
                tool_power: 1.5,
                tool_speed: 0.1,
                ..good
            },
            Refusal::Tool,
        ),
        (
            Move {
                tool_power: 0.5,
                tool_speed: -0.1,
                ..good
            },
            Refusal::Tool,
        ),
        (
            Move {
                tool_power: 1e-300,
                tool_speed: -1e-300,
                ..good
            },
            Refusal::Tool,
        ),
        (
            Move {
                ticks: 0,
                number: 1,
                ..good
            },
            Refusal::MoveNumber { expected: 0 },
        ),
        (
            Move {
                to: pose(f64::MAX, f64::NAN, 0.0),
                ticks: 0,
                ..good
            },
            Refusal::NotFinite,
        ),
    ];
    let mut bench = Bench::new();
    for (bad, refusal) in cases {
        let before = bench.status();
        assert_eq!(bench.refused(Command::Move(bad)), refusal, "{bad:?}");
        assert_eq!(bench.status(), before, "{bad:?}");
    }
    // After all that, the good one still plays.
    bench.offer(good);
    bench.done(Command::Start);
    assert_eq!(bench.until(State::Idle), 102);
    assert_eq!(bench.status().done, 1);
}

#[test]
fn a_full_queue_refuses_and_goes_on_when_there_is_room() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let (a, b) = (home(), pose(0.22, 0.23, 0.16));
    let nth = |number: u32| {
        let ends = if number.is_multiple_of(2) {
            (a, b)
        } else {
            (b, a)
        };
        rest(number, ends.0, ends.1, 20)
    };
    for number in 0..7 {
        assert_eq!(bench.status().room as u32, 7 - number);
        bench.done(Command::Move(nth(number)));
    }
    assert_eq!(bench.refused(Command::Move(nth(7))), Refusal::QueueFull);
    bench.judge();
    assert_eq!(bench.refused(Command::Move(nth(7))), Refusal::QueueFull);
    assert_eq!(bench.status().next, 7);
    bench.done(Command::Start);
    // The one under way has left its place.
    bench.ticks(1);
    bench.done(Command::Move(nth(7)));
    assert_eq!(bench.refused(Command::Move(nth(8))), Refusal::QueueFull);
    bench.judge();
    // Eight moves of 20 ticks, one after another, and one tick to be idle again.
    let ticks = 1 + bench.until(State::Idle);
    assert_eq!(ticks, 8 * 20 + 2);
    assert_eq!(bench.status().done, 8);
}

/// All that the queue holds is less than a ramp takes: the machine starts, and leaves each hold, as fast as that allows.
#[test]
fn a_full_queue_of_short_moves_is_played_slowly() {
    let settings = Settings {
        ramp: Ramp::within(50, None),
        ..settings()
    };
    let mut bench = Bench::<Thesis<f64>>::set(
        Adjustable::new(example(), LimitParameters::default()),
        home(),
        settings,
    );
    let (mut from, mut start, mut holds) = (home(), [0.0; 3], 0);
    for number in 0..40 {
        let end = if number < 39 {
            [0.002, 0.0, 0.0]
        } else {
            [0.0; 3]
        };
        let to = pose(
            from.position.x + 0.5 * PERIOD_S * (start[0] + end[0]),
            0.22,
            0.157,
        );
        bench.offer(moving(number, from, to, [start, end], 1));
        (from, start) = (to, end);
        if number < 6 {
            assert_eq!(bench.refused(Command::Start), Refusal::EndsMoving);
        }
        if number == 6 {
            bench.done(Command::Start);
        }
        for _ in 0..12 * u32::from(number >= 6) {
            bench.tick();
            holds += u32::from(bench.state() == State::Holding);
        }
        for _ in 0..1000 {
            if number >= 6 && bench.status().room == 0 {
                bench.tick();
            }
        }
    }
    assert!(holds > 0);
    bench.until(State::Idle);
    assert_eq!(
        (bench.status().done, bench.status().end.unwrap().pose),
        (40, from)
    );
}

#[test]
fn start_says_what_it_waits_for() {
    let mut bench = Bench::<Thesis<f64>>::new();
    assert_eq!(bench.refused(Command::Start), Refusal::NothingQueued);
    bench.done(Command::Move(offered()));
    assert_eq!(bench.refused(Command::Start), Refusal::Undecided);
    bench.judge();
    bench.done(Command::Start);
    assert_eq!(
        bench.refused(Command::Start),
        Refusal::State(State::Running)
    );

    // Four ticks that end moving: less than the ramp of ten takes, five.
    let mut bench = Bench::<Thesis<f64>>::new();
    let (middle, end) = (pose(0.2101, 0.22, 0.157), pose(0.2103, 0.22, 0.157));
    let speed = [0.005, 0.0, 0.0];
    bench.offer(moving(0, home(), middle, [[0.0; 3], speed], 4));
    assert_eq!(bench.refused(Command::Start), Refusal::EndsMoving);
    bench.done(Command::Move(moving(1, middle, end, [speed, [0.0; 3]], 6)));
    assert_eq!(bench.refused(Command::Start), Refusal::Undecided);
    bench.judge();
    bench.done(Command::Start);
    bench.until(State::Idle);
    assert_eq!(bench.status().end.unwrap().pose, end);
}

/// A move that is not admitted is named with its violation, those behind it are dropped, and the
/// next to offer takes its place.
#[test]
fn a_refused_move_takes_those_behind_it_along() {
    let limits = LimitParameters {
        rate_rad_s: Some([1.0; 3]),
        ..LimitParameters::default()
    };
    let mut bench = Bench::<Thesis<f64>>::with(example(), limits);
    let (a, b) = (home::<f64>(), pose(0.28, 0.28, 0.2));
    bench.done(Command::Move(rest(0, a, b, 200)));
    bench.done(Command::Move(rest(1, b, a, 20)));
    bench.done(Command::Move(rest(2, a, b, 200)));
    bench.judge();
    let status = bench.status();
    assert_eq!((status.next, status.admitted), (1, 1));
    let verdict = status.refused.unwrap();
    assert_eq!(verdict.number, 1);
    let violation = verdict.violation.unwrap();
    assert_eq!(violation.what, Bounded::Rate);
    assert!(violation.value > violation.limit && violation.limit == 1.0);
    // The one behind it started where it would have ended, which is where the first starts.
    assert_eq!(
        bench.refused(Command::Move(rest(2, a, b, 200))),
        Refusal::MoveNumber { expected: 1 }
    );
    // What it says would pass, passes.
    let shortest = violation.shortest.unwrap().enough;
    bench.done(Command::Move(rest(1, b, a, shortest)));
    bench.judge();
    assert_eq!(bench.status().admitted, 2);
    assert_eq!(bench.status().refused, None);
    bench.done(Command::Start);
    bench.until(State::Idle);
    assert_eq!(bench.status().done, 2);
    let verdicts = bench.events.iter().filter_map(|event| match event {
        Event::Verdict(verdict) => Some((verdict.number, verdict.violation.is_none())),
        _ => None,
    });
    let verdicts: Vec<(u32, bool)> = verdicts.collect();
    assert_eq!(verdicts, [(0, true), (1, false), (1, true)]);
}

#[test]
fn a_stop_drops_what_is_queued() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let (a, b) = (home(), pose(0.28, 0.28, 0.2));
    for (number, from, to) in [(0, a, b), (1, b, a), (2, a, b)] {
        bench.offer(rest(number, from, to, 100));
    }
    // One more that is not judged yet.
    bench.done(Command::Move(rest(3, b, a, 100)));
    bench.done(Command::Start);
    bench.ticks(120);
    bench.done(Command::Stop);
    assert_eq!(
        bench.refused(Command::Move(rest(4, a, b, 100))),
        Refusal::State(State::Stopping)
    );
    bench.until(State::Idle);
    // What is not to be played any more leaves the queue one by one.
    bench.ticks(2);
    let status = bench.status();
    assert_eq!(status.acting, Acting::Stop);
    // The second was under way: its number is not used again, those behind it are.
    assert_eq!((status.next, status.admitted, status.done), (2, 2, 2));
    assert_eq!(status.room, 7);
    let end = status.end.unwrap();
    assert_eq!(end.velocity, nalgebra::Vector3::new(0.0, 0.0, 0.0));
    assert_eq!(bench.refused(Command::Start), Refusal::NothingQueued);
    // The machine stands on the path, and goes on from there.
    bench.offer(rest(2, end.pose, a, 100));
    bench.done(Command::Start);
    bench.until(State::Idle);
    assert_eq!(bench.status().end.unwrap().pose, a);
}

#[test]
fn a_stop_in_idle_empties_the_queue() {
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(offered());
    bench.done(Command::Stop);
    bench.ticks(3);
    let status = bench.status();
    assert_eq!(
        (status.state, status.next, status.room),
        (State::Idle, 0, 7)
    );
    assert_eq!(status.end.unwrap().pose, home());
    bench.offer(offered());
    bench.done(Command::Start);
    bench.until(State::Idle);
    assert_eq!(bench.status().done, 1);
}

/// The tick never waits: who does not fetch telemetry loses it, and is told how much.
#[test]
fn telemetry_that_nobody_fetches_is_counted() {
    let mut bench = Bench::<Thesis<f64>>::new();
    for _ in 0..100 {
        bench.service.foreground.tick();
    }
    bench.tick();
    // 63 fit.
    assert_eq!(bench.telemetry.len(), 63);
    assert_eq!(bench.status().lost, 101 - 63);
    bench.telemetry.clear();
    bench.done(Command::telemetry(10));
    bench.ticks(100);
    assert_eq!(bench.telemetry.len(), 10);
    let ticks: Vec<u32> = bench.telemetry.iter().map(|sample| sample.tick).collect();
    assert!(ticks.windows(2).all(|pair| pair[1] - pair[0] == 10));
    bench.telemetry.clear();
    bench.done(Command::telemetry(0));
    bench.ticks(100);
    assert!(bench.telemetry.is_empty());
}

fn quintic(common: Move<f64>, [start, end]: [[f64; 3]; 2]) -> Command<f64> {
    Command::Quintic(QuinticMove {
        common,
        start_acceleration: start,
        end_acceleration: end,
    })
}

/// Setpoints of a chain of quintics, and the accelerations where they meet: from the end of the one before.
#[test]
fn quintics_chain_with_their_accelerations() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let (a, b, c) = (home(), pose(0.215, 0.225, 0.16), pose(0.22, 0.23, 0.165));
    let (speed, bent, none) = ([0.05, 0.05, 0.05], [0.2, -0.1, 0.3], [0.0; 3]);
    let first = moving(0, a, b, [none, speed], 100);
    let second = moving(1, b, c, [speed, none], 100);
    // From rest a quintic starts without an acceleration.
    assert_eq!(
        bench.refused(quintic(first, [bent, bent])),
        Refusal::StartAcceleration
    );
    bench.done(quintic(first, [none, bent]));
    assert_eq!(
        bench.refused(quintic(second, [none, none])),
        Refusal::StartAcceleration
    );
    let infinite = [f64::INFINITY, 0.0, 0.0];
    assert_eq!(
        bench.refused(quintic(second, [bent, infinite])),
        Refusal::NotFinite
    );
    bench.done(quintic(second, [bent, none]));
    bench.judge();
    bench.done(Command::Start);
    let ends = |from, to, velocities: [[f64; 3]; 2], accelerations| Ends::<f64, Quintics> {
        from,
        to,
        velocities: velocities.map(Into::into),
        accelerations: Some(accelerations),
    };
    let period = PERIOD_S;
    let segments = [
        Segment::new(&ends(a, b, [none, speed], [none, bent]), 100, period),
        Segment::new(&ends(b, c, [speed, none], [bent, none]), 100, period),
    ];
    for tick in 0..=200_u32 {
        bench.service.tick();
        let (setpoint, _) = bench.service.motion().expect("a motion");
        let index = usize::from(tick >= 100);
        let expected = segments[index].at(tick - 100 * index as u32);
        assert_eq!(*setpoint, expected, "{tick}");
    }
}

#[test]
fn a_cubic_may_follow_a_quintic() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let (a, b, c) = (home(), pose(0.215, 0.225, 0.16), pose(0.22, 0.23, 0.165));
    let (speed, bent, none) = ([0.05, 0.05, 0.05], [0.2, -0.1, 0.3], [0.0; 3]);
    bench.done(quintic(moving(0, a, b, [none, speed], 100), [none, bent]));
    bench.done(Command::Move(moving(1, b, c, [speed, none], 100)));
    // Behind a cubic a quintic starts anew.
    let third = rest(2, c, b, 100);
    assert_eq!(
        bench.refused(quintic(third, [bent, none])),
        Refusal::StartAcceleration
    );
    bench.done(quintic(third, [none, none]));
}
