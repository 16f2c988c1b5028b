//! Faults, and the way out of them.

use super::transitions::{assert_taken, taken};
use super::*;
use trirrr_core::number::{Arithmetic, Fixed};
use trirrr_protocol::message::{Acting, Bounded, DriveFault, FaultCode, Recovery};

fn running() -> Bench<Thesis<f64>> {
    let mut bench = Bench::new();
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 100));
    bench.offer(rest(1, pose(0.28, 0.28, 0.2), home(), 100));
    bench.done(Command::Start);
    bench.ticks(30);
    bench
}

fn recover(to: Pose<f64>, ticks: u32) -> Command<f64> {
    Command::Recover(Recovery { to, ticks })
}

#[test]
fn a_fault_is_latched_until_it_is_cleared() {
    let mut bench = running();
    let before = *bench.service.foreground.output();
    bench
        .service
        .foreground
        .raise(FaultCode::Overrun, None, 1.5, 1.0);
    // A later one does not take its place.
    bench
        .service
        .foreground
        .raise(FaultCode::Board, Some(2), 7.0, 0.0);
    for _ in 0..200 {
        let output = bench.tick();
        assert!(!output.is_on());
        for (motor, last) in output.motors.iter().zip(&before.motors) {
            assert_eq!((motor.angle, motor.rate), (last.angle, 0.0));
            assert_eq!((motor.acceleration, motor.torque), (0.0, 0.0));
        }
    }
    let status = bench.status();
    let fault = status.fault.unwrap();
    assert_eq!((fault.code, fault.index), (FaultCode::Overrun, None));
    assert_eq!((fault.value, fault.limit, fault.tick), (1.5, 1.0, 31));
    assert_eq!(
        (status.state, status.acting),
        (State::Fault, Acting::Nothing)
    );
    // The move under way was begun, the one behind it not.
    assert_eq!((status.next, status.done), (1, 1));
    assert_eq!(status.end, None);
    for command in [
        Command::Start,
        Command::Resume,
        Command::Move(rest(1, home(), home(), 10)),
        recover(home(), 100),
    ] {
        assert_eq!(bench.refused(command), Refusal::State(State::Fault));
    }
    let faults = bench
        .events
        .iter()
        .filter(|event| matches!(event, Event::Fault(_)));
    assert_eq!(faults.count(), 1);
    bench.acknowledge();
    let status = bench.status();
    assert_eq!((status.state, status.fault), (State::Cleared, None));
    assert!(bench.service.foreground.output().is_on());
}

/// From where a fault left it, to a pose at rest, by the motors' own cubic.
#[test]
fn a_recovery_leads_from_anywhere_to_idle() {
    let mut bench = running();
    bench
        .service
        .foreground
        .raise(FaultCode::Drive(DriveFault::Reported), Some(0), 0.0, 0.0);
    bench.ticks(5);
    bench.acknowledge();
    let target = pose(0.25, 0.25, 0.1);
    let from = bench.service.foreground.output().motors;
    bench.done(recover(target, 150));
    assert_eq!(
        bench.refused(Command::Move(rest(1, target, home(), 100))),
        Refusal::State(State::Recovering)
    );
    bench.tick();
    for (motor, from) in bench.service.foreground.output().motors.iter().zip(&from) {
        assert_eq!(motor.angle, from.angle);
    }
    let mut last = *bench.service.foreground.output();
    let mut ticks = 1;
    while bench.service.foreground.state() != State::Idle {
        let output = bench.tick();
        for (motor, before) in output.motors.iter().zip(&last.motors) {
            // No torque while it moves, and no jump: at most half a turn in 1.5 s makes 3.2 rad/s.
            assert!(motor.torque == 0.0 || bench.service.foreground.state() == State::Idle);
            assert!((motor.angle - before.angle).abs() < 3.2 * PERIOD_S);
        }
        last = output;
        ticks += 1;
    }
    assert_eq!(ticks, 152);
    let status = bench.status();
    assert_eq!(status.end.unwrap().pose, target);
    // In idle the motors are where the pose has them, in the bits.
    bench.offer(rest(status.next, target, home(), 100));
    bench.done(Command::Start);
    bench.until(State::Idle);
}

/// The machine stands at a singular pose, where no setpoint has a motion: serial (a leg stretched)
/// or parallel (det A = 0). Its motors move away from there one by one.
#[test]
fn singular_poses_are_left_in_joint_space() {
    // Parallel: the known one of the thesis machine. Serial: leg 3 stretched straight up.
    let parallel = pose(0.245, 0.25, -0.753_418_931_929_448_5);
    let serial = pose(0.25, 0.42 - 1e-13, 0.0);
    for singular in [parallel, serial] {
        let geometry = trirrr_core::machine::Geometry::<f64>::build(&example()).unwrap();
        let angles = geometry.motor_angles(&geometry.position(&singular).unwrap());
        let mut bench = Bench::<Thesis<f64>>::new();
        // The motors are there; nobody knows how they came there.
        assert!(bench.service.foreground.set_position(angles));
        assert_taken(taken::MEASURED_IN_IDLE);
        bench.ticks(1);
        assert_eq!(bench.state(), State::Cleared);
        for (motor, angle) in bench.service.foreground.output().motors.iter().zip(angles) {
            assert_eq!(motor.angle, angle);
        }
        // Not to another singular pose, and not to none at all.
        let refused = |refusal| match refusal {
            Refusal::Recovery(violation) => violation.what,
            other => panic!("{other:?}"),
        };
        let what = refused(bench.refused(recover(parallel, 300)));
        assert_eq!(what, Bounded::ParallelDistance);
        let what = refused(bench.refused(recover(serial, 300)));
        assert_eq!(what, Bounded::SerialDistance);
        let what = refused(bench.refused(recover(pose(3.0, 0.0, 0.0), 300)));
        assert_eq!(what, Bounded::Reach);
        bench.done(recover(home(), 300));
        bench.until(State::Idle);
        assert_eq!(bench.status().end.unwrap().pose, home());
    }
}

#[test]
fn a_recovery_keeps_the_joint_limits_or_is_refused() {
    let limits = LimitParameters {
        rate_rad_s: Some([0.5; 3]),
        acceleration_rad_s2: Some([8.0; 3]),
        ..LimitParameters::default()
    };
    let mut bench = Bench::<Thesis<f64>>::with(example(), limits);
    let target = pose(0.25, 0.28, 0.3);
    let mut longest_refused = 0;
    let mut passed = 0;
    for ticks in (10..400).step_by(10) {
        match bench.ask(recover(target, ticks)) {
            Reply::Refused(Refusal::Recovery(violation)) => {
                assert!(violation.value > violation.limit);
                assert!(matches!(
                    violation.what,
                    Bounded::Rate | Bounded::Acceleration
                ));
                longest_refused = ticks;
            }
            Reply::Done => {
                passed = ticks;
                break;
            }
            other => panic!("{other:?}"),
        }
    }
    assert!(longest_refused > 0 && passed > longest_refused);
    let mut fastest = 0.0f64;
    bench.ticks(passed / 2);
    bench.done(Command::Stop);
    let mut before = bench.service.output().motors;
    while !bench.service.foreground.state().is_at_rest() {
        let motors = bench.tick().motors;
        for (motor, before) in motors.iter().zip(&before) {
            assert!(motor.rate.abs() <= 0.5 && motor.acceleration.abs() <= 8.0);
            fastest = fastest.max(motor.rate.abs());
            // The acceleration is that of the tick, the ramp's own with it.
            let slope = (motor.rate - before.rate) / PERIOD_S;
            let slows = bench.service.foreground.state() == State::Stopping;
            assert!(
                !slows || (motor.acceleration - slope).abs() < 0.5,
                "{motor:?} {slope}"
            );
        }
        before = motors;
    }
    assert!(fastest > 0.3);
    // Stopped on the way, it does not know its pose, and can go on.
    assert_eq!(bench.state(), State::Cleared);
    assert_eq!(bench.status().end, None);
    bench.done(recover(target, passed));
    bench.until(State::Idle);
    assert_eq!(bench.status().fault, None);
}

#[test]
fn a_recovery_with_nonsense_is_refused() {
    let mut bench = Bench::<Thesis<f64>>::new();
    assert_eq!(
        bench.refused(recover(pose(f64::NAN, 0.0, 0.0), 10)),
        Refusal::NotFinite
    );
    assert_eq!(
        bench.refused(recover(home(), 0)),
        Refusal::Duration { longest: u32::MAX }
    );
    // With moves queued they go first, or are dropped first.
    bench.done(Command::Move(rest(0, home(), pose(0.28, 0.28, 0.2), 100)));
    assert_eq!(
        bench.refused(recover(home(), 100)),
        Refusal::State(State::Idle)
    );
    bench.judge();
    assert_eq!(
        bench.refused(recover(home(), 100)),
        Refusal::State(State::Idle)
    );
}

/// Each status that leaves a setpoint without a motion is a fault of its own name.
#[test]
fn a_setpoint_without_a_motion_is_a_fault() {
    let (a, far) = (home::<f64>(), pose(0.9, 0.9, 0.0));
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(rest(0, a, pose(0.28, 0.28, 0.2), 100));
    // The platform is taken out of reach behind the admission's back.
    bench.service.foreground.pose = far;
    bench.ticks(1);
    let status = bench.status();
    let fault = status.fault.unwrap();
    assert_eq!(fault.code, FaultCode::Unreachable);
    assert!(fault.index.is_some());
    assert_eq!(status.acting, Acting::Limit(Bounded::Reach));
    assert!(!bench.service.foreground.output().is_on());
}

#[test]
fn the_longest_tick_is_remembered() {
    let mut bench = Bench::<Thesis<f64>>::new();
    for duration in [100, 700, 300] {
        assert!(bench.service.foreground.report_timing(duration, 700));
        bench.tick();
    }
    assert_eq!(bench.status().longest_tick, 700);
    let durations: Vec<u32> = bench
        .telemetry
        .iter()
        .map(|sample| sample.duration)
        .collect();
    assert_eq!(durations, [100, 700, 300]);
}

#[test]
fn a_tick_that_is_not_done_when_the_next_is_due_is_a_fault() {
    let mut bench = running();
    assert!(bench.service.foreground.report_timing(1000, 1000));
    assert!(bench.service.foreground.output().is_on());
    assert!(!bench.service.foreground.report_timing(1250, 1000));
    // At once, not with the next tick only.
    assert!(!bench.service.foreground.output().is_on());
    bench.tick();
    let status = bench.status();
    let fault = status.fault.unwrap();
    assert_eq!((fault.code, fault.index), (FaultCode::Overrun, None));
    assert_eq!((fault.value, fault.limit, fault.tick), (1.25, 1.0, 31));
    assert_eq!((status.state, status.longest_tick), (State::Fault, 1250));
    // Latched: ticks that are in time do not lift it.
    assert!(bench.service.foreground.report_timing(10, 1000));
    assert!(!bench.tick().is_on());
    bench.acknowledge();
    assert_eq!(bench.status().state, State::Cleared);
}

/// However late a tick is, its fault has a value in every number type: two periods are the most that is told.
#[test]
fn the_value_of_an_overrun_fits_the_number_type() {
    for (duration, period, expected) in [
        (3001, 1000, 2.0),
        (1001, 1000, 1.001),
        (u32::MAX, 1, 2.0),
        (u32::MAX, u32::MAX - 1, 1.0),
    ] {
        let mut bench = Bench::<Thesis<Fixed>>::new();
        bench.service.foreground.report_timing(duration, period);
        bench.ticks(1);
        let value = bench.status().fault.unwrap().value.to_f64();
        // In units of the last place of fixed point, 2^-29.
        let units = (value - expected) * 2f64.powi(29);
        assert!(units.abs() <= 2.0, "{duration} of {period}: {value}");
    }
}
