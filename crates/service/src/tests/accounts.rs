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
    bench.ticks(198);
    let last = *bench.telemetry.last().unwrap();
    bench.done(Command::Stop);
    bench.until(State::Idle);
    let status = bench.status();
    // The ramp leads into the next move: the job was left where it was stopped, and the machine stands behind that.
    assert_eq!((status.done, status.next), (2, 2));
    let left = Interruption {
        number: 0,
        at: last.at,
    };
    assert_eq!((last.number, status.interrupted), (0, Some(left)));
    assert_ne!(status.end.unwrap().pose, last.setpoint.pose);
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

/// In each state in which a job can be stopped it was left where its tool went off.
#[test]
fn a_job_is_left_where_its_tool_went_off() {
    let there = pose(0.28, 0.28, 0.2);
    let begin = || {
        let mut bench = Bench::<Thesis<f64>>::new();
        bench.offer(rest(0, home(), there, 200));
        bench.done(Command::Start);
        bench.ticks(120);
        bench
    };
    let place = |bench: &Bench<Thesis<f64>>| {
        let last = bench.telemetry.last().unwrap();
        Some(Interruption {
            number: last.number,
            at: last.at,
        })
    };
    let stop = |bench: &mut Bench<Thesis<f64>>| {
        bench.done(Command::Stop);
        bench.until(State::Idle);
        bench.status().interrupted
    };
    // In a hold, and on the way to it.
    for ticks in [3, 100] {
        let mut bench = begin();
        bench.done(Command::Hold);
        bench.ticks(ticks);
        let expected = place(&bench);
        assert_eq!(stop(&mut bench), expected);
    }
    // In the first tick, and so late that the ramp leads over the end: the job has no part left, but was not played.
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(rest(0, home(), there, 200));
    bench.done(Command::Start);
    bench.tick();
    assert_eq!(stop(&mut bench), Some(Interruption { number: 0, at: 0 }));
    let mut bench = begin();
    bench.ticks(78);
    let expected = place(&bench);
    assert_eq!(stop(&mut bench), expected);
    assert_eq!(bench.status().end.unwrap().pose, there);
    // A job that is played leaves the place of the one before.
    bench.offer(rest(1, there, home(), 100));
    bench.done(Command::Start);
    bench.until(State::Running);
    bench.until(State::Idle);
    assert_eq!(bench.status().interrupted, expected);
    // Drives that go off meanwhile make no difference.
    let mut bench = begin();
    let expected = place(&bench);
    bench.done(Command::Disable);
    bench.until(State::Disabled);
    assert_eq!(bench.status().interrupted, expected);
}

/// A job that was left is told until moves of another come: a host does not take those for its own.
#[test]
fn moves_behind_a_job_that_was_left_are_not_of_it() {
    let label = trirrr_protocol::message::JobLabel {
        name: crate::name("job"),
        items: 2,
        check: 7,
    };
    let there = pose(0.28, 0.28, 0.2);
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.done(Command::Job(label));
    bench.offer(rest(0, home(), there, 200));
    bench.offer(rest(1, there, home(), 200));
    bench.done(Command::Start);
    bench.ticks(50);
    bench.done(Command::Stop);
    bench.until(State::Idle);
    let status = bench.status();
    assert_eq!(status.job.unwrap().label, label);
    bench.offer(rest(1, status.end.unwrap().pose, home(), 200));
    assert_eq!(bench.status().job, None);
    bench.done(Command::Start);
    bench.until(State::Running);
    bench.until(State::Idle);
    bench.done(Command::Job(label));
    bench.offer(rest(2, home(), there, 200));
    assert_eq!(bench.status().job.unwrap().first_move, 2);
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
