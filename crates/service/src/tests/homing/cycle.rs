//! The way from switched on to idle.

use super::*;
use crate::number::ServiceNumber;
use crate::tests::transitions::{assert_taken, taken};
use trirrr_core::machine::Quantity;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_protocol::message::{Acting, Bounded, Recovery, scene};

const ALL: [Contact; 4] = [
    Contact::Switch,
    Contact::Stall,
    Contact::Torque,
    Contact::Unfelt,
];

#[test]
fn before_it_is_homed_a_machine_plays_nothing() {
    let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.1, -0.2, 0.05]);
    let status = machine.bench.status();
    assert_eq!((status.state, status.end), (State::Unhomed, None));
    let limits = scene::Limits::from(&LimitParameters::default());
    for command in [
        Command::Move(rest(0, home(), home(), 10)),
        Command::Start,
        Command::Hold,
        Command::Resume,
        Command::ClearFault,
        Command::Recover(Recovery {
            to: home(),
            ticks: 500,
        }),
        Command::Replace(scene::Section::Limits(limits)),
    ] {
        let refusal = machine.bench.refused(command);
        assert_eq!(refusal, Refusal::State(State::Unhomed), "{command:?}");
    }
    machine.bench.done(Command::Stop);
    machine.bench.done(Command::telemetry(2));
    for _ in 0..5 {
        let output = machine.tick();
        assert!(output.is_on());
    }
    assert_eq!(machine.bench.state(), State::Unhomed);
}

/// Every command while it is being homed, and on its way to rest after that was given up.
#[test]
fn each_command_while_it_is_homed() {
    let machine = |stopped: bool| {
        let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.0; 3]);
        machine.bench.done(Command::Home);
        machine.ticks(20);
        if stopped {
            machine.bench.done(Command::Stop);
            machine.ticks(2);
        }
        machine
    };
    for (stopped, state) in [(false, State::Homing), (true, State::Stopping)] {
        for command in [
            Command::Home,
            Command::Start,
            Command::Hold,
            Command::Resume,
            Command::ClearFault,
            Command::Move(rest(0, home(), home(), 10)),
            Command::Recover(Recovery {
                to: home(),
                ticks: 500,
            }),
        ] {
            let mut machine = machine(stopped);
            let refusal = machine.bench.refused(command);
            assert_eq!(refusal, Refusal::State(state), "{command:?}");
            machine.ticks(1);
            assert_eq!(machine.bench.state(), state);
        }
        let mut machine = machine(stopped);
        machine.bench.done(Command::Stop);
        machine.ticks(1);
        assert_eq!(machine.bench.state(), State::Stopping);
        machine.until(State::Unhomed);
    }
}

#[test]
fn a_machine_whose_motors_are_known_has_no_homing() {
    let mut bench = Bench::<Thesis<f64>>::new();
    assert_eq!(bench.refused(Command::Home), Refusal::NoHoming);
    bench.ticks(1);
    assert_eq!(bench.state(), State::Idle);
    // One that may have it, and has not, is the same.
    let scene = Adjustable::new(example(), LimitParameters::default());
    let mut bench = Bench::<Homed<f64>>::of(scene, home());
    assert_eq!(bench.refused(Command::Home), Refusal::NoHoming);
    bench.inputs = [true; 3];
    bench.offer(rest(0, home(), pose(0.25, 0.25, 0.1), 100));
    bench.done(Command::Start);
    bench.until(State::Idle);
    assert_eq!(bench.service.foreground.shift(), None);
}

fn homes<N: ServiceNumber>(contact: Contact) {
    let mut machine = Machine::<N>::new(parameters(contact), [0.2, -0.1, -0.5]);
    assert!(machine.errors().iter().any(|error| error.abs() > 0.4));
    machine.bench.done(Command::Home);
    assert_eq!(machine.bench.state(), State::Homing);
    machine.until(State::Recovering);
    machine.until(State::Idle);
    machine.is_homed();
    // A job from there, and homing again from its end.
    let next = machine.bench.status().next;
    let to = pose(0.25, 0.25, 0.1);
    machine.bench.offer(rest(next, home(), to, 400));
    machine.bench.done(Command::Start);
    machine.until(State::Running);
    assert_eq!(
        machine.bench.refused(Command::Home),
        Refusal::State(State::Running)
    );
    machine.until(State::Idle);
    machine.home();
    machine.is_homed();
}

#[test]
fn every_number_type_homes_to_every_contact() {
    for contact in ALL {
        homes::<f64>(contact);
        homes::<f32>(contact);
        homes::<Fixed>(contact);
        homes::<Coarse>(contact);
    }
}

/// A motor whose encoder is off by a known angle counts from there, and homing finds it there again.
#[test]
fn homing_keeps_encoder_offsets() {
    for contact in ALL {
        let mut machine = Machine::<f64>::new(parameters(contact), [0.2, -0.1, 0.1]);
        machine.home();
        machine.is_homed();
        let homed = machine.errors();
        let read = machine.bench.ask(Command::Read(scene::SectionName::Leg(1)));
        let Reply::Section(scene::Section::Leg { index, mut leg }) = read else {
            panic!("a leg");
        };
        assert_eq!(leg.encoder_offset_rad, 0.0);
        leg.encoder_offset_rad = 0.02;
        let section = scene::Section::Leg { index, leg };
        machine.bench.done(Command::Replace(section));
        machine.ticks(2);
        let replaced = machine.bench.ask(Command::Read(scene::SectionName::Leg(1)));
        assert_eq!(replaced, Reply::Section(section));
        let is_off = |machine: &Machine<f64>, tolerance: f64| {
            let errors = machine.errors();
            for (motor, offset) in [0.0, 0.02, 0.0].into_iter().enumerate() {
                let off = homed[motor] - errors[motor];
                assert!(
                    (off - offset).abs() < tolerance,
                    "{contact:?} {motor}: {off}"
                );
            }
        };
        is_off(&machine, 1e-9);
        machine.home();
        // Twice what the latch rate resolves.
        is_off(&machine, 2.1 * PERIOD_S * 0.05 + 2e-6);

        leg.encoder_offset_rad = 4.0;
        let section = scene::Section::Leg { index, leg };
        assert_eq!(
            machine.bench.refused(Command::Replace(section)),
            Refusal::Parameter {
                quantity: Quantity::EncoderOffset,
                leg: Some(1)
            }
        );
    }
}

/// In stages, one motor moves while the others stand.
#[test]
fn stages_follow_one_another() {
    let mut parameters = parameters(Contact::Switch);
    for (motor, stage) in parameters.motors.iter_mut().zip([2, 0, 1]) {
        motor.stage = stage;
    }
    let mut machine = Machine::<f64>::new(timed(parameters), [0.1; 3]);
    machine.bench.done(Command::Home);
    let mut order = Vec::new();
    while machine.bench.service.foreground.state() != State::Recovering {
        let output = machine.tick();
        machine.bench.ask(Command::Status);
        let moving = |i: &usize| output.motors[*i].rate != 0.0;
        let moving: Vec<usize> = (0..3).filter(moving).collect();
        if machine.bench.service.foreground.state() != State::Homing {
            continue;
        }
        assert!(moving.len() <= 1, "{moving:?}");
        if let Some(one) = moving.first()
            && order.last() != Some(one)
        {
            order.push(*one);
        }
    }
    assert_eq!(order, [1, 2, 0]);
    machine.until(State::Idle);
    machine.is_homed();
}

/// A switch that the machine stands on is left first; the others wait meanwhile.
#[test]
fn a_switch_that_is_closed_at_the_start_is_left() {
    let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.35, 0.0, 0.0]);
    machine.ticks(1);
    assert!(machine.beyond(0) > 0.0);
    machine.bench.done(Command::Home);
    let mut most = [0.0f64; 3];
    for _ in 0..40 {
        let output = machine.tick();
        for (most, motor) in most.iter_mut().zip(&output.motors) {
            *most = most.max(motor.rate.abs());
        }
    }
    assert!(most[0] > 0.0 && machine.beyond(0) < 0.04, "{most:?}");
    assert_eq!(most[1..], [0.0, 0.0]);
    machine.until(State::Idle);
    machine.is_homed();
}

/// The reference is where the switch first closed, however long it takes to believe it.
#[test]
fn bounces_do_not_move_the_reference() {
    for debounce_ticks in [3, 20] {
        let parameters = timed(HomingParameters {
            debounce_ticks,
            ..parameters(Contact::Switch)
        });
        let mut machine = Machine::<f64>::new(parameters, [0.1, 0.2, -0.3]);
        machine.defects = [Defect::Bounces; 3];
        machine.home();
        // Two ticks of bounces: three ticks of the latch rate.
        for error in machine.errors() {
            assert!(error.abs() < 3.1 * 0.05 * PERIOD_S, "{error}");
        }
        let mut clean = Machine::<f64>::new(parameters, [0.1, 0.2, -0.3]);
        clean.home();
        clean.is_homed();
    }
}

/// Its limits may have become narrower since the scene was read.
#[test]
fn homing_keeps_the_limits() {
    let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.0; 3]);
    machine.home();
    for (rate, acceleration, what) in [
        (0.4, 1.9, Bounded::Rate),
        (1.0, 1.4, Bounded::Acceleration),
        (1.0, 1.501, Bounded::Acceleration),
    ] {
        let limits = scene::Limits {
            rate_rad_s: Some([rate; 3]),
            acceleration_rad_s2: Some([acceleration; 3]),
            ..scene::Limits::from(&LimitParameters::default())
        };
        machine
            .bench
            .done(Command::Replace(scene::Section::Limits(limits)));
        machine.tick();
        let refusal = machine.bench.ask(Command::Home);
        match refusal {
            Reply::Refused(Refusal::Recovery(violation)) => assert_eq!(violation.what, what),
            // The way to the start pose is reckoned with its ramp.
            other => assert_eq!((other, acceleration), (Reply::Done, 1.501)),
        }
    }
}

/// A board that knows better may say so.
#[test]
fn angles_from_elsewhere_take_the_place_of_homing() {
    let mut machine = Machine::<f64>::new(parameters(Contact::Switch), [0.0; 3]);
    let angles = home_angles().map(|angle| angle + 0.1);
    assert!(machine.bench.service.foreground.set_position(angles));
    machine.bench.ticks(1);
    assert_eq!(machine.bench.state(), State::Cleared);
    assert_taken(taken::MEASURED_UNHOMED);
    machine.bench.done(Command::Recover(Recovery {
        to: home(),
        ticks: 200,
    }));
    machine.bench.until(State::Idle);
    let status = machine.bench.status();
    assert_eq!(
        (status.acting, status.end.map(|end| end.pose)),
        (Acting::Nothing, Some(home()))
    );
}
