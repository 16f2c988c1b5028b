//! The table of states and commands.

use super::*;
use trirrr_protocol::message::{Acting, DriveFault, FaultCode, Recovery};

/// Service in `state`.
fn rig_in(state: State) -> Bench<Thesis<f64>> {
    let mut bench = Bench::new();
    let job = rest(0, home(), pose(0.28, 0.28, 0.2), 100);
    if !matches!(
        state,
        State::Idle | State::Fault | State::Cleared | State::Recovering
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
            bench.done(Command::ClearFault);
            bench.ticks(1);
        }
        State::Recovering => {
            bench = rig_in(State::Cleared);
            bench.done(Command::Recover(Recovery {
                to: pose(0.25, 0.25, 0.0),
                ticks: 100,
            }));
            bench.ticks(5);
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
    ];
    type Row = (State, [Option<State>; 6]);
    // None: refused. In fault and cleared a stop has nothing to do.
    let table: [Row; 8] = [
        (Idle, [None, None, None, Some(Idle), None, Some(Recovering)]),
        (
            Running,
            [None, Some(Slowing), None, Some(Stopping), None, None],
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
            ],
        ),
        (Stopping, [None, None, None, Some(Stopping), None, None]),
        (
            Holding,
            [None, Some(Holding), Some(Running), Some(Idle), None, None],
        ),
        (Fault, [None, None, None, Some(Fault), Some(Cleared), None]),
        (
            Cleared,
            [None, None, None, Some(Cleared), None, Some(Recovering)],
        ),
        (Recovering, [None, None, None, Some(Stopping), None, None]),
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
        Idle, Running, Slowing, Stopping, Holding, Fault, Cleared, Recovering,
    ] {
        let mut bench = rig_in(state);
        bench.done(Command::Stop);
        bench.ticks(200);
        if bench.state() == Fault {
            bench.done(Command::ClearFault);
            bench.ticks(1);
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

#[test]
fn a_silent_host_ends_in_a_controlled_stop() {
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
        (State::Stopping, Acting::Silence)
    );
    bench.ticks(u32::from(RAMP));
    let status = bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Idle, Acting::Silence)
    );
    // It has come to rest on the path, not at its end.
    let pose = status.end.unwrap().pose;
    assert!(pose.position.x > 0.21 && pose.position.x < 0.28);
    // Standing, it may be silent for as long as it likes.
    bench.ticks(3 * SILENCE);
    assert_eq!(bench.state(), State::Idle);
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
