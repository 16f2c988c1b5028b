//! Counts and places in the status: what was interrupted, what it took, and for how long the queue was dry.

use super::*;
use trirrr_protocol::message::{Acting, FaultCode, Interruption};

/// What a stop, a silent host and a fault leave is told by number and tick, and what it took is counted.
#[test]
fn an_interrupted_move_is_told_and_ways_to_rest_are_counted() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let there = pose(0.28, 0.28, 0.2);
    bench.offer(rest(0, home(), there, 200));
    bench.offer(rest(1, there, home(), 200));
    assert_eq!(bench.status().interrupted, None);
    bench.done(Command::Start);
    bench.ticks(251);
    bench.done(Command::Stop);
    bench.until(State::Idle);
    let status = bench.status();
    let Interruption { number, at } = status.interrupted.unwrap();
    assert_eq!((number, status.done, status.next), (1, 2, 2));
    // A machine that is not stopped is there at this tick of the move.
    let mut never = Bench::<Thesis<f64>>::new();
    never.offer(rest(0, home(), there, 200));
    never.offer(rest(1, there, home(), 200));
    never.done(Command::Start);
    never.until(State::Idle);
    let is_there = |sample: &&Telemetry<f64>| (sample.number, sample.at) == (number, at);
    let passed = never.telemetry.iter().find(is_there).unwrap();
    assert_eq!(status.end.unwrap().pose, passed.setpoint.pose);
    assert_eq!(status.longest_stop, u32::from(RAMP));
    assert_eq!((status.dry_ticks, status.late_ticks), (0, 0));

    // A fault on the third move.
    let from = status.end.unwrap().pose;
    bench.offer(rest(2, from, there, 200));
    bench.done(Command::Start);
    bench.ticks(101);
    let before = bench.telemetry.last().unwrap().at;
    bench
        .service
        .foreground
        .raise(FaultCode::Board, None, 0.0, 0.0);
    bench.tick();
    let interrupted = bench.status().interrupted.unwrap();
    assert_eq!((interrupted.number, interrupted.at), (2, before));

    // A late tick of a machine that goes on is counted.
    bench.service.count_late();
    assert_eq!(bench.status().late_ticks, 1);
}

/// Ticks in which the queue was dry are those in which the machine slowed down, or stood, for it.
#[test]
fn a_dry_queue_is_counted() {
    let mut bench = Bench::<Thesis<f64>>::new();
    let middle = pose(0.25, 0.25, 0.18);
    let velocity = [0.05, 0.05, 0.0];
    let first = Move {
        end_velocity: velocity,
        ..rest(0, home(), middle, 200)
    };
    bench.offer(first);
    bench.done(Command::Start);
    let mut waited = 0;
    for _ in 0..400 {
        bench.tick();
        waited += u32::from(bench.status().acting == Acting::QueueDry);
        bench.ask(Command::Status);
    }
    assert!(waited > 100, "{waited}");
    let second = Move {
        start_velocity: velocity,
        ..rest(1, middle, pose(0.28, 0.28, 0.2), 200)
    };
    bench.offer(second);
    for _ in 0..1000 {
        bench.tick();
        waited += u32::from(bench.status().acting == Acting::QueueDry);
        bench.ask(Command::Status);
    }
    assert_eq!(bench.state(), State::Idle);
    assert_eq!(bench.status().dry_ticks, waited);
}
