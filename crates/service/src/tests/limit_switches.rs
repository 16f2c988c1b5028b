//! Limit switches of the motors.

use super::homing::{home_angles, parameters};
use super::interlocks::{Guarded, LIMIT_TICKS, touching};
use super::*;
use crate::settings::StopCategory;
use trirrr_protocol::message::{FaultCode, Recovery};

/// A machine in the middle of a move, with this reaction to limit switches.
fn running(category: StopCategory) -> Guarded {
    let settings = Settings {
        reactions: Reactions {
            limit_switch: category,
            ..Reactions::OFF
        },
        ..settings()
    };
    let mut machine = Guarded {
        bench: Bench::set(touching(), home(), settings),
        readings: InterlockReadings::default(),
    };
    machine
        .bench
        .offer(rest(0, home(), pose(0.28, 0.28, 0.2), 100));
    machine.bench.done(Command::Start);
    machine.ticks(40);
    machine
}

fn recover() -> Command<f64> {
    Command::Recover(Recovery {
        to: home(),
        ticks: 50,
    })
}

#[test]
fn a_limit_switch_is_a_fault_of_its_motor_in_the_last_tick_of_the_debounce_time() {
    let mut machine = running(StopCategory::Off);
    machine.readings.limits[1] = true;
    machine.ticks(LIMIT_TICKS - 1);
    assert_eq!(machine.bench.service.state(), State::Running);
    assert!(!machine.tick().is_on());
    let fault = machine.bench.status().fault.expect("a fault");
    assert_eq!((fault.code, fault.index), (FaultCode::LimitSwitch, Some(1)));
}

/// The motor stands on its switch all the time: no second fault, no job, and a recovery leads off it.
#[test]
fn a_machine_on_its_limit_switch_is_led_off_by_a_recovery() {
    let mut machine = running(StopCategory::Off);
    machine.readings.limits[1] = true;
    machine.until(State::Fault);
    machine.bench.acknowledge();
    assert_eq!(machine.bench.state(), State::Cleared);
    machine.ticks(20);
    assert_eq!(machine.bench.state(), State::Cleared, "a fault again");
    machine.bench.done(recover());
    machine.ticks(20);
    assert_eq!(machine.bench.state(), State::Recovering);
    machine.readings.limits[1] = false;
    machine.until(State::Idle);
    // Another time is another fault.
    machine.readings.limits[1] = true;
    machine.until(State::Fault);
}

/// A switch of another motor is a fault on the way out.
#[test]
fn a_recovery_off_one_switch_onto_another_is_a_fault() {
    let mut machine = running(StopCategory::Off);
    machine.readings.limits[1] = true;
    machine.until(State::Fault);
    machine.bench.acknowledge();
    machine.bench.done(recover());
    machine.ticks(20);
    machine.readings.limits[0] = true;
    machine.until(State::Fault);
    let fault = machine.bench.status().fault.expect("a fault");
    assert_eq!((fault.code, fault.index), (FaultCode::LimitSwitch, Some(0)));
}

/// Drives that hold keep the pose: the machine is idle after the acknowledgement, and starts nothing.
#[test]
fn no_job_starts_on_a_limit_switch() {
    let mut machine = running(StopCategory::StopAndHold);
    machine.readings.limits[2] = true;
    let tick = |machine: &mut Guarded| {
        machine.bench.service.sense(machine.readings);
        machine.bench.service.tick().is_on()
    };
    while machine.bench.state() != State::Fault {
        assert!(tick(&mut machine));
    }
    machine.bench.done(Command::ClearFault);
    tick(&mut machine);
    assert_eq!(machine.bench.state(), State::Idle);
    let end = machine.bench.status().end.expect("it stands").pose;
    machine.bench.offer(rest(1, end, home(), 100));
    let refusal = Refusal::LimitSwitch { motor: 2 };
    assert_eq!(machine.bench.refused(Command::Start), refusal);
    let probe = Command::Probe { away: false };
    assert_eq!(machine.bench.refused(probe), refusal);
}

/// The state may be older than the switch.
#[test]
fn an_order_to_start_that_meets_a_limit_switch_is_not_taken() {
    let mut machine = running(StopCategory::Off);
    machine.until(State::Idle);
    let end = machine.bench.status().end.expect("it stands").pose;
    machine.bench.offer(rest(1, end, home(), 100));
    machine.readings.limits[2] = true;
    machine.ticks(LIMIT_TICKS - 1);
    machine.bench.done(Command::Start);
    assert!(!machine.tick().is_on());
    assert_eq!(machine.bench.state(), State::Fault);
}

/// Drives that are off move nothing: a switch that is closed by hand is no fault, and none once they are on.
#[test]
fn a_machine_that_is_switched_on_upon_a_limit_switch_is_no_fault() {
    let mut machine = Guarded {
        bench: Bench::off(touching(), home(), settings()),
        readings: InterlockReadings::default(),
    };
    machine.readings.limits[0] = true;
    machine.ticks(10);
    machine.bench.done(Command::Enable);
    machine.until(State::Idle);
    machine.ticks(10);
    assert_eq!(machine.bench.state(), State::Idle);
    machine
        .bench
        .offer(rest(0, home(), pose(0.28, 0.28, 0.2), 100));
    let refusal = Refusal::LimitSwitch { motor: 0 };
    assert_eq!(machine.bench.refused(Command::Start), refusal);
    machine.bench.done(Command::Stop);
    machine.ticks(2);
    machine.bench.done(recover());
}

/// Homing may use the very switches: they count for nothing until it is over.
#[test]
fn homing_moves_onto_limit_switches_and_off_them() {
    let parameters = parameters(Contact::Switch);
    let coefficients = HomingCoefficients::build(&parameters, PERIOD_S);
    let scene = SceneParts {
        homing: Some(&*Box::leak(Box::new(coefficients))),
        ..touching()
    };
    let mut machine = Guarded {
        bench: Bench::set(scene, home(), settings()),
        readings: InterlockReadings::default(),
    };
    machine.bench.done(Command::Home);
    machine.until(State::Homing);
    for _ in 0..100_000 {
        // Switches at the references, for both.
        let angles = machine
            .bench
            .service
            .output()
            .motors
            .map(|motor| motor.angle);
        let closed = [0, 1, 2].map(|i| {
            let motor = &parameters.motors[i];
            motor.sign() * super::homing::wrapped(angles[i] - motor.angle_rad) >= 0.0
        });
        machine.bench.inputs = closed;
        machine.readings.limits = closed;
        machine.tick();
        machine.bench.ask(Command::Status);
        if machine.bench.service.state() == State::Idle {
            break;
        }
    }
    assert_eq!(
        machine.bench.state(),
        State::Idle,
        "{:?}",
        machine.bench.status()
    );
    assert!(home_angles().iter().all(|angle| angle.is_finite()));
    machine.readings.limits[1] = true;
    machine.until(State::Fault);
}
