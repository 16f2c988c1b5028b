//! The table of states and commands.

use super::*;
use trirrr_protocol::message::{Acting, DriveFault, FaultCode, Recovery};

/// Times of drives and of a brake.
const TIMES: PowerTimes = PowerTimes {
    drives_ticks: 5,
    brake_release_ticks: 3,
    brake_engage_ticks: 4,
};

/// Service of drives that take their time, and its brake.
fn slow_bench() -> Bench<Thesis<f64>> {
    let settings = Settings {
        power: TIMES,
        reactions: Reactions::default(),
        ..settings()
    };
    Bench::set(
        Adjustable::new(example(), LimitParameters::default()),
        home(),
        settings,
    )
}

/// Service in `state`.
fn rig_in(state: State) -> Bench<Thesis<f64>> {
    let mut bench = slow_bench();
    let job = rest(0, home(), pose(0.28, 0.28, 0.2), 100);
    if !matches!(
        state,
        State::Idle
            | State::Fault
            | State::Cleared
            | State::Recovering
            | State::Disabled
            | State::Enabling
            | State::Disabling
    ) {
        bench.offer(job);
        bench.done(Command::Start);
        bench.ticks(20);
    }
    match state {
        State::Idle | State::Running => bench.ticks(1),
        State::Slowing => {
            bench.done(Command::Hold);
            bench.ticks(2);
        }
        State::Holding => {
            bench.done(Command::Hold);
            bench.ticks(30);
        }
        State::Stopping => {
            bench.done(Command::Stop);
            bench.ticks(2);
        }
        State::Fault => {
            bench.service.foreground.raise(
                FaultCode::Drive(DriveFault::Reported),
                Some(1),
                3.0,
                0.0,
            );
            bench.ticks(1);
        }
        State::Cleared => {
            bench = rig_in(State::Fault);
            bench.acknowledge();
        }
        State::Recovering => {
            bench = rig_in(State::Cleared);
            bench.done(Command::Recover(Recovery {
                to: pose(0.25, 0.25, 0.0),
                ticks: 100,
            }));
            bench.ticks(5);
        }
        State::Disabled => {
            bench.done(Command::Disable);
            bench.ticks(1 + u32::from(TIMES.brake_engage_ticks));
        }
        State::Enabling => {
            bench = rig_in(State::Disabled);
            bench.done(Command::Enable);
            bench.ticks(2);
        }
        State::Disabling => {
            bench.done(Command::Disable);
            bench.ticks(2);
        }
        State::Reacting => {
            assert!(!bench.service.report_timing(1200, 1000));
            bench.ticks(2);
        }
        State::Unhomed | State::Homing => unreachable!("the tests of homing have these"),
    }
    assert_eq!(bench.state(), state);
    assert_eq!(bench.service.foreground.state(), state);
    bench
}

/// Every command in every state: the state that it leads to at once, or the refusal.
#[test]
fn each_command_in_each_state() {
    use State::*;
    let recover = Command::Recover(Recovery {
        to: pose(0.25, 0.25, 0.1),
        ticks: 200,
    });
    let commands = [
        Command::Start,
        Command::Hold,
        Command::Resume,
        Command::Stop,
        Command::ClearFault,
        recover,
        Command::Enable,
        Command::Disable,
    ];
    type Row = (State, [Option<State>; 8]);
    // None: refused. Where nothing moves, a stop has nothing to do; where drives are off, nor has a disable.
    let table: [Row; 12] = [
        (
            Idle,
            [
                None,
                None,
                None,
                Some(Idle),
                None,
                Some(Recovering),
                None,
                Some(Disabling),
            ],
        ),
        (
            Running,
            [
                None,
                Some(Slowing),
                None,
                Some(Stopping),
                None,
                None,
                None,
                Some(Stopping),
            ],
        ),
        (
            Slowing,
            [
                None,
                Some(Slowing),
                Some(Slowing),
                Some(Stopping),
                None,
                None,
                None,
                Some(Stopping),
            ],
        ),
        (
            Stopping,
            [
                None,
                None,
                None,
                Some(Stopping),
                None,
                None,
                None,
                Some(Stopping),
            ],
        ),
        (
            Holding,
            [
                None,
                Some(Holding),
                Some(Running),
                Some(Idle),
                None,
                None,
                None,
                Some(Disabling),
            ],
        ),
        (
            Fault,
            [
                None,
                None,
                None,
                Some(Fault),
                Some(Disabled),
                None,
                None,
                Some(Fault),
            ],
        ),
        (
            Cleared,
            [
                None,
                None,
                None,
                Some(Cleared),
                None,
                Some(Recovering),
                None,
                Some(Disabling),
            ],
        ),
        (
            Recovering,
            [
                None,
                None,
                None,
                Some(Stopping),
                None,
                None,
                None,
                Some(Stopping),
            ],
        ),
        (
            Disabled,
            [
                None,
                None,
                None,
                Some(Disabled),
                Some(Disabled),
                None,
                Some(Enabling),
                Some(Disabled),
            ],
        ),
        (
            Enabling,
            [
                None,
                None,
                None,
                Some(Enabling),
                None,
                None,
                None,
                Some(Disabling),
            ],
        ),
        (
            Disabling,
            [
                None,
                None,
                None,
                Some(Disabling),
                None,
                None,
                None,
                Some(Disabling),
            ],
        ),
        (
            Reacting,
            [
                None,
                None,
                None,
                Some(Reacting),
                None,
                None,
                None,
                Some(Reacting),
            ],
        ),
    ];
    for (state, expected) in table {
        assert_eq!(rig_in(state).refused(Command::Home), Refusal::NoHoming);
        for (command, expected) in commands.into_iter().zip(expected) {
            let mut bench = rig_in(state);
            let reply = bench.ask(command);
            match expected {
                Some(next) => {
                    assert_eq!(reply, Reply::Done, "{command:?} in {state:?}");
                    bench.ticks(1);
                    assert_eq!(bench.state(), next, "{command:?} in {state:?}");
                }
                None => {
                    let reason = match (state, command) {
                        (Idle, Command::Start) => Refusal::NothingQueued,
                        _ => Refusal::State(state),
                    };
                    assert_eq!(reply, Reply::Refused(reason), "{command:?} in {state:?}");
                    bench.ticks(1);
                    assert_eq!(bench.state(), state);
                }
            }
        }
    }
}

/// No state without an exit: from each, the machine comes to idle and plays a job.
#[test]
fn no_state_is_without_an_exit() {
    use State::*;
    for state in [
        Idle, Running, Slowing, Stopping, Holding, Fault, Cleared, Recovering, Disabled, Enabling,
        Disabling, Reacting,
    ] {
        let mut bench = rig_in(state);
        bench.done(Command::Stop);
        bench.ticks(200);
        if bench.state() == Fault {
            bench.done(Command::ClearFault);
            bench.ticks(1);
        }
        if bench.state() == Disabled {
            bench.done(Command::Enable);
            bench.ticks(1 + u32::from(TIMES.enable_ticks()));
        }
        if bench.state() == Cleared {
            bench.done(Command::Recover(Recovery {
                to: pose(0.25, 0.25, 0.1),
                ticks: 200,
            }));
            bench.until(Idle);
        }
        assert_eq!(bench.state(), Idle, "from {state:?}");
        let status = bench.status();
        let from = status.end.unwrap().pose;
        bench.offer(rest(status.next, from, pose(0.24, 0.26, 0.1), 100));
        bench.done(Command::Start);
        bench.until(Idle);
        let end = bench.status();
        assert_eq!(end.done, status.next + 1);
        assert_eq!(end.end.unwrap().pose, pose(0.24, 0.26, 0.1));
    }
}

/// An order of each tick, which is on its way in each status, keeps no state back: not that of a job that goes on, nor of its end.
#[test]
fn a_host_that_orders_in_each_tick_sees_what_the_machine_does() {
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 300));
    bench.done(Command::Start);
    bench.ticks(50);
    bench.done(Command::Hold);
    bench.until(State::Holding);
    let mut seen = std::vec![bench.state()];
    // One more than the tick takes.
    bench.done(Command::FeedOverride { percent: 100 });
    let angles = |output: Output<f64>| output.motors.map(|motor| motor.angle);
    let mut stands = [0.0; 3];
    for _ in 0..600 {
        let order = match bench.state() {
            State::Holding => Command::Resume,
            _ => Command::FeedOverride { percent: 100 },
        };
        bench.done(order);
        let state = bench.state();
        if seen.last() != Some(&state) {
            seen.push(state);
        }
        stands = angles(bench.tick());
    }
    assert_eq!(seen, [State::Holding, State::Running, State::Idle]);
    assert_eq!(bench.status().done, 1);
    // Nor where the motors stand.
    bench.done(Command::Recover(Recovery {
        to: home(),
        ticks: 1000,
    }));
    bench.ticks(2);
    let goes = angles(bench.tick());
    for (from, to) in stands.into_iter().zip(goes) {
        assert!((to - from).abs() < 1e-3, "{from} to {to}");
    }
    bench.until(State::Idle);
}

/// A client that resumes what waits for its host does not undo the hold that it has asked for: the status knows of it at once.
#[test]
fn a_status_knows_of_a_hold_that_is_on_its_way() {
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 5000));
    bench.done(Command::Start);
    bench.ticks(SILENCE + 3);
    assert!(bench.status().waits_for_host());
    bench.done(Command::Hold);
    let status = bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Slowing, Acting::Hold)
    );
    assert!(!status.waits_for_host());
    bench.until(State::Holding);
    bench.done(Command::Resume);
    assert_eq!(bench.status().acting, Acting::Resume);
    bench.until(State::Running);
}

#[test]
fn a_silent_host_leaves_a_job_that_waits() {
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 5000));
    bench.done(Command::Start);
    bench.ticks(SILENCE - 1);
    assert_eq!(bench.service.foreground.state(), State::Running);
    // A frame of any kind, even a refused one, is a sign of life.
    bench.ask_as(999, Command::Status);
    bench.ticks(SILENCE - 1);
    assert_eq!(bench.service.foreground.state(), State::Running);
    bench.ticks(2);
    let status = bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Slowing, Acting::Silence)
    );
    bench.ticks(u32::from(RAMP));
    let status = bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Holding, Acting::Silence)
    );
    assert!(status.waits_for_host());
    // Standing, it may be silent for as long as it likes.
    bench.ticks(3 * SILENCE);
    assert_eq!(bench.state(), State::Holding);
    // It goes on with the very setpoints: what it plays is what a machine plays whose host was never silent.
    bench.done(Command::Resume);
    bench.until(State::Idle);
    let played = |bench: &Bench<Thesis<f64>>| -> Vec<_> {
        let normal = |sample: &&Telemetry<f64>| sample.state == State::Running && sample.part == 0;
        let samples = bench.telemetry.iter().filter(normal);
        samples
            .filter(|sample| sample.acting == Acting::Nothing)
            .map(|sample| (sample.at, sample.setpoint))
            .collect()
    };
    let mut never = Bench::<Thesis<f64>>::new();
    never.offer(rest(0, home(), pose(0.28, 0.28, 0.2), 5000));
    never.done(Command::Start);
    never.until(State::Idle);
    let whole = played(&never);
    let mut rows = whole.iter();
    for tick in played(&bench) {
        assert!(rows.any(|other| *other == tick), "{tick:?}");
    }
    assert_eq!(bench.status().done, 1);
    assert_eq!(bench.status().interrupted, None);
}

#[test]
fn the_state_is_told_at_each_change() {
    let mut bench = Bench::<Thesis<f64>>::new();
    bench.offer(rest(0, home(), pose(0.22, 0.23, 0.2), 30));
    bench.done(Command::Start);
    bench.ticks(5);
    bench.done(Command::Hold);
    bench.until(State::Holding);
    bench.done(Command::Resume);
    bench.until(State::Idle);
    let states: Vec<State> = bench
        .events
        .iter()
        .filter_map(|event| match event {
            Event::State { state, .. } => Some(*state),
            _ => None,
        })
        .collect();
    use State::*;
    // Running three times: resuming, at normal speed again, and with the move over.
    assert_eq!(
        states,
        [Running, Slowing, Holding, Running, Running, Running, Idle]
    );
}

/// Nothing is on before the host asks for it, whatever else it asks.
#[test]
fn a_machine_starts_with_its_drives_off() {
    let settings = settings::<f64>();
    let scene = Adjustable::<Dynamic<f64>>::new(example(), LimitParameters::default());
    let channels: Channels<Thesis<f64>, 8, 64> = Channels::new();
    let mut service = Box::leak(Box::new(channels))
        .service(scene, home(), settings)
        .unwrap();
    for command in [
        Command::Status,
        Command::Start,
        Command::Stop,
        Command::Hold,
        Command::Resume,
        Command::ClearFault,
        Command::Disable,
        Command::telemetry(1),
        Command::FeedOverride { percent: 50 },
        Command::Move(rest(0, home(), pose(0.28, 0.28, 0.2), 100)),
        Command::Recover(Recovery {
            to: home(),
            ticks: 100,
        }),
    ] {
        service.submit(&command);
        for _ in 0..20 {
            while service.step() {}
            let output = service.tick();
            // A host may clear the errors of drives that are off.
            let clears = command == Command::ClearFault && output.power == Power::Clear;
            assert!(clears || output.power == Power::Off, "{command:?}");
            assert!(!output.brake_released && output.tool == 0.0);
            assert!(output.motors.iter().all(|motor| motor.torque == 0.0));
        }
        assert_eq!(service.state(), State::Disabled);
    }
    assert_eq!(service.submit(&Command::Enable), Reply::Done);
    let output = *service.tick();
    assert_eq!((output.power, service.state()), (Power::On, State::Idle));
    assert!(output.brake_released);
}

/// The drives hold before the brake lets go, and the brake holds before they go off.
#[test]
fn the_brake_and_the_drives_hold_by_turns() {
    let mut bench = rig_in(State::Disabled);
    bench.done(Command::Enable);
    let ticks = bench.until(State::Idle);
    assert_eq!(ticks, 1 + u32::from(TIMES.enable_ticks()));
    let on: Vec<_> = (0..ticks).collect();
    let mut bench = rig_in(State::Disabled);
    bench.done(Command::Enable);
    let outputs: Vec<_> = on.iter().map(|_| bench.tick()).collect();
    let released = outputs
        .iter()
        .position(|output| output.brake_released)
        .unwrap();
    assert!(outputs.iter().all(Output::is_on));
    assert_eq!(released, usize::from(TIMES.drives_ticks));
    // The machine stands at its pose, with the torque of it, while the brake lets go.
    assert_eq!(outputs[released].motors, outputs[ticks as usize - 1].motors);

    bench.done(Command::Disable);
    for tick in 0..=TIMES.brake_engage_ticks {
        let output = bench.tick();
        assert!(!output.brake_released);
        assert_eq!(output.is_on(), tick < TIMES.brake_engage_ticks, "{tick}");
    }
    assert_eq!(bench.state(), State::Disabled);
}

/// A job that is disabled comes to rest on its path; enabled again the machine stands there.
#[test]
fn disabling_a_running_machine_stops_it_first() {
    let mut bench = rig_in(State::Running);
    bench.done(Command::Disable);
    bench.until(State::Disabling);
    let stood = bench.service.output().motors;
    assert!(stood.iter().all(|motor| motor.rate == 0.0));
    bench.until(State::Disabled);
    bench.done(Command::Enable);
    bench.until(State::Idle);
    for (motor, stood) in bench.service.output().motors.iter().zip(&stood) {
        assert_eq!(motor.angle, stood.angle);
    }
    assert_eq!(bench.status().next, 1);
}

/// The errors of the drives are cleared in one tick, when a host has asked for it.
#[test]
fn errors_are_cleared_once() {
    let mut bench = rig_in(State::Fault);
    assert_eq!(bench.tick().power, Power::Off);
    bench.done(Command::ClearFault);
    assert_eq!(bench.tick().power, Power::Clear);
    for _ in 0..10 {
        assert_eq!(bench.tick().power, Power::Off);
    }
    assert_eq!(bench.state(), State::Disabled);
}
