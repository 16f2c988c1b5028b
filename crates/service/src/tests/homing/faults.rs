//! Homing that fails or is given up, in each of its parts.

use super::*;
use trirrr_protocol::message::{Acting, DriveFault, FaultCode};

/// The ramp from the search rate to rest, v^2 / (2 a).
const RAMP_DOWN: f64 = 0.5 * 0.5 / 3.0;

/// The way off a switch that is closed at the start: the way back, that ramp, and four ticks.
const LEAVE: f64 = 0.08 + RAMP_DOWN + 4.0 * 0.5 * PERIOD_S;

/// Out of a fault: cleared it is not homed, and homing works once the defect is gone.
#[track_caller]
fn homes_after_all(machine: &mut Machine<f64>, turned_back: [f64; 3]) {
    machine.truth = turned_back;
    machine.defects = [Defect::None; 3];
    machine.bench.done(Command::ClearFault);
    machine.tick();
    machine.bench.done(Command::Enable);
    machine.tick();
    let status = machine.bench.status();
    assert_eq!((status.state, status.fault), (State::Unhomed, None));
    assert_eq!(status.end, None);
    machine.home();
    machine.is_homed();
}

#[test]
fn each_fault_names_its_motor() {
    let offset = [0.1, 0.1, -0.1];
    let on_switch = [0.35, -0.35, 0.35];
    for motor in 0..3usize {
        for (contact, defect, offset, code, limit) in [
            (
                Contact::Switch,
                Defect::Open,
                offset,
                FaultCode::HomingNotFound,
                1.5,
            ),
            (
                Contact::Stall,
                Defect::Open,
                offset,
                FaultCode::HomingNotFound,
                1.5,
            ),
            (
                Contact::Switch,
                Defect::Once,
                offset,
                FaultCode::HomingNotFound,
                0.16,
            ),
            (
                Contact::Switch,
                Defect::Sticks,
                offset,
                FaultCode::HomingNotReleased,
                0.08,
            ),
            (
                Contact::Stall,
                Defect::Sticks,
                offset,
                FaultCode::HomingNotReleased,
                0.08,
            ),
            (
                Contact::Switch,
                Defect::Closed,
                offset,
                FaultCode::HomingClosedAtStart,
                LEAVE,
            ),
            (
                Contact::Switch,
                Defect::Sticks,
                on_switch,
                FaultCode::HomingClosedAtStart,
                LEAVE,
            ),
        ] {
            let mut machine = Machine::<f64>::new(parameters(contact), offset);
            machine.defects[motor] = defect;
            let start = machine.truth;
            for _ in 0..5 {
                machine.tick();
            }
            machine.bench.done(Command::Home);
            machine.until(State::Fault);
            let output = *machine.bench.service.foreground.output();
            assert!(!output.is_on());
            let status = machine.bench.status();
            let fault = status.fault.expect("it is latched");
            assert_eq!(
                (fault.code, fault.index),
                (code, Some(motor as u8)),
                "{defect:?}"
            );
            assert!((fault.limit - limit).abs() < 1e-12, "{fault:?}");
            assert_eq!(status.acting, Acting::Nothing);
            assert_eq!(
                machine.bench.refused(Command::Home),
                Refusal::State(State::Fault)
            );
            // Who went on past a dead switch is turned back by hand.
            homes_after_all(&mut machine, start);
        }
    }
}

/// No further than the scene allows.
#[test]
fn the_search_ends_after_the_largest_travel() {
    let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.0; 3]);
    machine.defects[1] = Defect::Open;
    let start = machine.truth;
    machine.bench.done(Command::Home);
    machine.until(State::Fault);
    let travel = start[1] - machine.truth[1];
    // To within the debounce time, a few ticks at the search rate.
    assert!(
        (1.5..1.5 + 8.0 * 0.5 * PERIOD_S).contains(&travel),
        "{travel}"
    );
    // The others have stopped behind their switches, once they were debounced.
    for i in [0, 2] {
        let beyond = machine.beyond(i);
        assert!(
            beyond > RAMP_DOWN && beyond < RAMP_DOWN + 5.0 * 0.5 * PERIOD_S,
            "{beyond}"
        );
    }
}

/// Ticks of an undisturbed homing, to recovering and to idle.
fn lengths(contact: Contact) -> (u32, u32) {
    let mut machine = Machine::<f64>::new(parameters(contact), [0.1, 0.2, -0.4]);
    machine.bench.done(Command::Home);
    let mut ticks = 0;
    let mut found = None;
    loop {
        machine.tick();
        machine.bench.ask(Command::Status);
        ticks += 1;
        match machine.bench.service.foreground.state() {
            State::Recovering if found.is_none() => found = Some(ticks),
            State::Idle => return (found.expect("on the way"), ticks),
            _ => {}
        }
    }
}

#[test]
fn a_stop_at_any_time_leads_to_rest_and_back() {
    for contact in [Contact::Switch, Contact::Stall, Contact::Unfelt] {
        let (found, idle) = lengths(contact);
        // In the last ticks the way to rest ends at the start pose.
        for after in (0..idle - u32::from(RAMP)).step_by(7) {
            let mut machine = Machine::<f64>::new(parameters(contact), [0.1, 0.2, -0.4]);
            machine.bench.done(Command::Home);
            for _ in 0..after {
                machine.tick();
                machine.bench.ask(Command::Status);
            }
            machine.bench.done(Command::Stop);
            let at_rest = match after {
                0 => State::Unhomed,
                _ if after < found => State::Unhomed,
                // Every motor is known: as in any recovery that is stopped.
                _ => State::Cleared,
            };
            let mut rates = machine
                .bench
                .service
                .foreground
                .output()
                .motors
                .map(|motor| motor.rate);
            for tick in 0.. {
                let output = machine.tick();
                for (rate, motor) in rates.iter_mut().zip(&output.motors) {
                    assert!(
                        (motor.rate - *rate).abs() < 0.1,
                        "{after}: a jump of the rate"
                    );
                    *rate = motor.rate;
                }
                if machine.bench.service.foreground.state() == at_rest {
                    break;
                }
                assert!(
                    tick < 40,
                    "{after}: {:?}",
                    machine.bench.service.foreground.state()
                );
            }
            let status = machine.bench.status();
            assert_eq!((status.acting, status.end), (Acting::Stop, None));
            machine.home();
            machine.is_homed();
        }
    }
}

#[test]
fn a_fault_at_any_time_makes_it_home_anew() {
    let (_, idle) = lengths(Contact::Switch);
    for after in (0..idle + 20).step_by(11) {
        let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.1, 0.2, -0.4]);
        machine.bench.done(Command::Home);
        for _ in 0..after {
            machine.tick();
            machine.bench.ask(Command::Status);
        }
        machine
            .bench
            .service
            .foreground
            .raise(FaultCode::Board, Some(1), 7.0, 0.0);
        machine.tick();
        assert_eq!(machine.bench.state(), State::Fault);
        // Without current the motors were pushed about.
        let [a, b, c] = machine.truth;
        homes_after_all(&mut machine, [a + 0.05, b, c - 0.07]);
    }
}

#[test]
fn a_silent_host_ends_it() {
    let slow = |motor: HomingMotor| HomingMotor {
        search_rate_rad_s: 0.06,
        ..motor
    };
    let parameters = parameters(Contact::Switch);
    let parameters = timed(HomingParameters {
        motors: parameters.motors.map(slow),
        ..parameters
    });
    let mut machine = Machine::<f64>::new(parameters, [-0.5, 0.5, -0.5]);
    machine.bench.done(Command::Home);
    for tick in 1..=SILENCE + 10 {
        machine.tick();
        let expected = match tick {
            _ if tick < SILENCE + 1 => State::Homing,
            _ if machine.bench.service.foreground.state() == State::Stopping => State::Stopping,
            _ => State::Unhomed,
        };
        assert_eq!(machine.bench.service.foreground.state(), expected, "{tick}");
    }
    let status = machine.bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Unhomed, Acting::Silence)
    );
    machine.home();
    machine.is_homed();
}

/// A drive that signals a stall while its motor moves: a fault where the scene asks for it, and nothing else.
#[test]
fn a_stall_on_the_way_is_a_fault_where_the_scene_says_so() {
    for (contact, watched, faults) in [
        (Contact::Stall, true, true),
        (Contact::Stall, false, false),
        (Contact::Switch, false, false),
    ] {
        let parameters = HomingParameters {
            stall_is_fault: watched,
            ..parameters(contact)
        };
        let mut machine = Machine::<f64>::new(parameters, [0.0; 3]);
        machine.home();
        let debounce = u32::from(parameters.debounce_ticks);
        // Standing, it says nothing.
        machine.defects[1] = Defect::Closed;
        machine.ticks(10);
        assert_eq!(machine.bench.state(), State::Idle);
        machine.defects[1] = Defect::None;
        machine.ticks(10);
        let next = machine.bench.status().next;
        let there = pose(0.25, 0.25, 0.157);
        machine.bench.offer(rest(next, home(), there, 200));
        machine.bench.done(Command::Start);
        machine.ticks(60);
        machine.defects[1] = Defect::Closed;
        machine.ticks(debounce - 1);
        assert_eq!(machine.bench.state(), State::Running);
        machine.ticks(2);
        let fault = machine.bench.status().fault;
        let expected = (FaultCode::Drive(DriveFault::Stalled), Some(1));
        assert_eq!(
            fault.map(|fault| (fault.code, fault.index)),
            faults.then_some(expected),
            "{contact:?}"
        );
    }
}
