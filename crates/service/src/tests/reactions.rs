//! Stops at faults, by category.

use super::transitions::{assert_taken, taken};
use super::*;
use crate::settings::StopCategory;
use trirrr_protocol::message::{Acting, Bounded, DriveFault, FaultCode, Recovery};

const BRAKE: u16 = 4;

fn bench(reactions: Reactions, limits: LimitParameters) -> Bench<Thesis<f64>> {
    let settings = Settings {
        reactions,
        power: PowerTimes {
            brake_engage_ticks: BRAKE,
            ..PowerTimes::default()
        },
        ..settings()
    };
    let mut bench = Bench::set(Adjustable::new(example(), limits), home(), settings);
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 100));
    bench.done(Command::Start);
    bench.ticks(40);
    bench
}

fn all(category: StopCategory) -> Reactions {
    Reactions {
        limit: category,
        overrun: category,
        following: category,
        drive: category,
        limit_switch: category,
    }
}

fn overrun(bench: &mut Bench<Thesis<f64>>) {
    assert!(!bench.service.report_timing(1200, 1000));
}

/// The platform is let go only when it stands and its brake holds; on the way it is on the path of the job.
#[test]
fn category_1_stops_on_the_path_then_switches_off() {
    let mut plain = bench(all(StopCategory::StopThenOff), LimitParameters::default());
    plain.done(Command::Stop);
    plain.until(State::Idle);
    let rests_at = plain.service.output().motors;

    let mut bench = bench(all(StopCategory::StopThenOff), LimitParameters::default());
    overrun(&mut bench);
    let mut ticks = 0;
    while bench.service.state() != State::Fault {
        let output = bench.tick();
        ticks += 1;
        assert_eq!(output.tool, 0.0);
        let rests = output.motors.iter().all(|motor| motor.rate == 0.0);
        assert!(rests || output.is_on());
        assert!(
            output.brake_released != rests || ticks == u32::from(RAMP),
            "{ticks}"
        );
    }
    assert_eq!(ticks, u32::from(RAMP) + u32::from(BRAKE) + 1);
    assert!(!bench.service.output().is_on());
    // It is where a stop would have come to rest.
    for (motor, rest) in bench.service.output().motors.iter().zip(&rests_at) {
        assert_eq!(motor.angle, rest.angle);
    }
    let fault = bench.status().fault.unwrap();
    assert_eq!((fault.code, fault.tick), (FaultCode::Overrun, 41));
    let told = |state| {
        let is = |event: &&Event<f64>| matches!(event, Event::State { state: told, .. } if *told == state);
        bench.events.iter().filter(is).count()
    };
    // Once more where the move is over.
    assert_eq!((told(State::Reacting), told(State::Fault)), (2, 1));
    bench.acknowledge();
    assert_eq!(bench.state(), State::Cleared);
}

#[test]
fn category_0_switches_off_at_once() {
    let mut bench = bench(Reactions::OFF, LimitParameters::default());
    overrun(&mut bench);
    assert!(!bench.service.output().is_on());
    assert!(!bench.service.output().brake_released);
    bench.tick();
    assert_eq!(bench.state(), State::Fault);
}

/// The drives hold until somebody lets them go, and the machine goes on where it stands.
#[test]
fn category_2_stops_and_holds() {
    let mut bench = bench(all(StopCategory::StopAndHold), LimitParameters::default());
    bench
        .service
        .raise(FaultCode::Drive(DriveFault::Reported), Some(1), 5.0, 0.0);
    for _ in 0..100 {
        assert!(bench.service.tick().is_on());
    }
    assert_eq!(bench.state(), State::Fault);
    assert!(bench.service.output().brake_released);
    assert!(matches!(
        bench.refused(Command::Start),
        Refusal::State(State::Fault)
    ));
    bench.done(Command::ClearFault);
    bench.service.tick();
    assert_eq!(bench.state(), State::Idle);
    let end = bench.status().end.unwrap().pose;
    bench.offer(rest(1, end, home(), 100));
    bench.done(Command::Start);
    bench.until(State::Idle);

    // And again: let go by a disable, with the fault still there.
    bench
        .service
        .raise(FaultCode::Drive(DriveFault::Reported), Some(1), 5.0, 0.0);
    for _ in 0..5 {
        bench.service.tick();
    }
    bench.done(Command::Disable);
    for _ in 0..=BRAKE {
        bench.service.tick();
    }
    assert!(!bench.service.output().is_on());
    assert_eq!(bench.state(), State::Fault);
    assert!(bench.status().fault.is_some());
    assert_taken(taken::DRIVES_THAT_HOLD);
}

/// Behind a stop that kept the drives on, a machine whose pose is not known waits to be moved to one, or to be homed.
#[test]
fn drives_that_hold_a_lost_machine_are_let_on() {
    let settings = || Settings {
        reactions: all(StopCategory::StopAndHold),
        ..settings()
    };
    let mut bench = Bench::<Thesis<f64>>::set(
        Adjustable::new(example(), LimitParameters::default()),
        home(),
        settings(),
    );
    bench.done(Command::Recover(Recovery {
        to: pose(0.25, 0.25, 0.1),
        ticks: 100,
    }));
    bench.until(State::Recovering);
    bench.ticks(5);
    fail_and_let_on(&mut bench);
    bench.until(State::Cleared);
    assert_taken(taken::DRIVES_THAT_HOLD_LOST);

    let coefficients =
        HomingCoefficients::build(&super::homing::parameters(Contact::Switch), PERIOD_S);
    let scene = SceneParts {
        homing: Some(&*Box::leak(Box::new(coefficients))),
        ..Adjustable::new(example(), LimitParameters::default()).into()
    };
    let mut bench = Bench::<Homed<f64>>::set(scene, home(), settings());
    assert_eq!(bench.state(), State::Unhomed);
    fail_and_let_on(&mut bench);
    bench.until(State::Unhomed);
    assert_taken(taken::DRIVES_THAT_HOLD_UNHOMED);
}

/// A fault of a machine whose drives hold, and its acknowledgement.
fn fail_and_let_on<S: Scene<N = f64>>(bench: &mut Bench<S>) {
    let code = FaultCode::Drive(DriveFault::Reported);
    bench.service.raise(code, Some(1), 5.0, 0.0);
    for _ in 0..100 {
        assert!(bench.service.tick().is_on());
    }
    assert_eq!(bench.state(), State::Fault);
    bench.done(Command::ClearFault);
    bench.service.tick();
}

/// A limit that a tick's result breaks stops the machine on its path, over the limit for as long as it takes.
#[test]
fn a_limit_does_not_let_go() {
    let limits = LimitParameters {
        torque_nm: Some([5.0; 3]),
        ..LimitParameters::default()
    };
    let mut bench = bench(Reactions::default(), limits);
    // As if the tick computed with other numbers than the proof.
    bench.service.foreground.guard = crate::guard::Guard::holding(
        trirrr_core::limits::Limits::build(&LimitParameters {
            rate_rad_s: Some([1e-3; 3]),
            ..limits
        })
        .unwrap(),
    );
    bench.service.tick();
    assert_eq!(bench.service.state(), State::Reacting);
    assert!(bench.service.output().is_on());
    for _ in 0..RAMP + BRAKE + 1 {
        bench.service.tick();
    }
    let status = bench.status();
    assert_eq!(status.state, State::Fault);
    assert_eq!(status.acting, Acting::Limit(Bounded::Rate));
    assert_eq!(status.fault.unwrap().code, FaultCode::Limit(Bounded::Rate));
}

/// A second fault on the way ends it.
#[test]
fn a_second_fault_switches_off() {
    let mut bench = bench(all(StopCategory::StopThenOff), LimitParameters::default());
    overrun(&mut bench);
    bench.ticks(2);
    assert_eq!(bench.service.state(), State::Reacting);
    overrun(&mut bench);
    assert!(!bench.service.output().is_on());
    bench.ticks(1);
    assert_eq!(bench.state(), State::Fault);
    // The first one is what is told.
    assert_eq!(bench.status().fault.unwrap().tick, 41);
}

/// A machine on its way to a pose, motor by motor, stops there.
#[test]
fn a_recovery_stops_too() {
    let mut bench = bench(all(StopCategory::StopThenOff), LimitParameters::default());
    bench.done(Command::Stop);
    bench.until(State::Idle);
    bench.done(Command::Recover(Recovery {
        to: home(),
        ticks: 100,
    }));
    bench.ticks(40);
    overrun(&mut bench);
    bench.ticks(u32::from(RAMP + BRAKE) + 1);
    assert_eq!(bench.state(), State::Fault);
    bench.acknowledge();
    assert_eq!(bench.state(), State::Cleared);
    bench.done(Command::Recover(Recovery {
        to: home(),
        ticks: 200,
    }));
    bench.until(State::Idle);
}
