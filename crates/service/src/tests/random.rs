//! Random commands at random ticks: what holds always.

use super::*;
use proptest::prelude::*;
use std::vec;
use trirrr_protocol::message::{DriveFault, FaultCode, Goal, Recovery};

const RATE: f64 = 1.5;
const TORQUE: f64 = 0.2;

#[derive(Clone, Copy, Debug)]
enum Action {
    /// To the nth of some poses, ending at rest or not, in so many ticks; sometimes from the wrong
    /// place.
    Move {
        to: usize,
        ticks: u32,
        moving: bool,
        wrong: bool,
    },
    /// To the nth of some poses, at rest or not.
    Retarget {
        to: usize,
        moving: bool,
        cut: bool,
    },
    Start,
    Hold,
    Resume,
    Stop,
    ClearFault,
    Enable,
    Disable,
    Recover {
        to: usize,
        ticks: u32,
    },
    Fault,
    Repeat,
    Judge {
        steps: u32,
    },
    Tick {
        ticks: u32,
    },
}

fn action() -> impl Strategy<Value = Action> {
    prop_oneof![
        6 => (0usize..5, 1u32..120, any::<bool>(), 0u8..10)
            .prop_map(|(to, ticks, moving, odd)| Action::Move { to, ticks, moving, wrong: odd == 0 }),
        2 => (0usize..5, any::<bool>(), any::<bool>())
            .prop_map(|(to, moving, cut)| Action::Retarget { to, moving, cut }),
        4 => Just(Action::Start),
        2 => Just(Action::Hold),
        3 => Just(Action::Resume),
        1 => Just(Action::Stop),
        1 => Just(Action::ClearFault),
        3 => Just(Action::Enable),
        1 => (0u8..4).prop_map(|odd| if odd == 0 { Action::Disable } else { Action::Enable }),
        1 => (0usize..5, 50u32..300).prop_map(|(to, ticks)| Action::Recover { to, ticks }),
        1 => (0u8..8).prop_map(|odd| if odd == 0 { Action::Fault } else { Action::Start }),
        2 => Just(Action::Repeat),
        6 => (1u32..2000).prop_map(|steps| Action::Judge { steps }),
        8 => (1u32..60).prop_map(|ticks| Action::Tick { ticks }),
    ]
}

fn place(index: usize) -> Pose<f64> {
    let (x, y, alpha) = [
        (0.21, 0.22, 0.157),
        (0.22, 0.23, 0.16),
        (0.25, 0.25, 0.1),
        (0.23, 0.26, 0.2),
        (0.215, 0.222, 0.15),
    ][index];
    pose(x, y, alpha)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(512))]

    /// The invariants of [`Bench::tick`]; no output beyond a limit; no velocity jump without a fault;
    /// a way out of wherever it ends.
    #[test]
    fn nothing_that_is_asked_breaks_it(actions in proptest::collection::vec(action(), 1..150)) {
        let limits = LimitParameters {
            rate_rad_s: Some([RATE; 3]),
            torque_nm: Some([TORQUE; 3]),
            ..LimitParameters::default()
        };
        let mut bench = Bench::<Thesis<f64>>::with(example(), limits);
        let mut last: Option<(u32, Command<f64>, Reply<f64>)> = None;
        let mut before = bench.tick();
        let mut sequence = 0;
        for action in actions {
            let status = bench.status();
            let command = match action {
                Action::Move { to, ticks, moving, wrong } => {
                    let (from, speed) = match status.end {
                        Some(end) => (end.pose, end.velocity.into()),
                        None => (home(), [0.0; 3]),
                    };
                    let from = if wrong { place(3) } else { from };
                    let end_velocity = if moving { [0.02, -0.01, 0.05] } else { [0.0; 3] };
                    Some(Command::Move(Move {
                        start_velocity: speed,
                        end_velocity,
                        tool_power: 0.7,
                        tool_speed: 0.05,
                        ..rest(status.next, from, place(to), ticks)
                    }))
                }
                Action::Retarget { to, moving, cut } => Some(Command::Retarget(Goal {
                    to: place(to),
                    velocity: if moving { [0.02, -0.01, 0.05] } else { [0.0; 3] },
                    cut,
                    least_ticks: 0,
                })),
                Action::Start => Some(Command::Start),
                Action::Hold => Some(Command::Hold),
                Action::Resume => Some(Command::Resume),
                Action::Stop => Some(Command::Stop),
                Action::ClearFault => Some(Command::ClearFault),
                Action::Enable => Some(Command::Enable),
                Action::Disable => Some(Command::Disable),
                Action::Recover { to, ticks } => {
                    Some(Command::Recover(Recovery { to: place(to), ticks }))
                }
                Action::Fault => {
                    bench.service.foreground.raise(FaultCode::Drive(DriveFault::Reported), None, 0.0, 0.0);
                    None
                }
                Action::Repeat => {
                    if let Some((sequence, command, reply)) = &last {
                        prop_assert_eq!(&bench.ask_as(*sequence, *command), reply);
                    }
                    None
                }
                Action::Judge { steps } => {
                    for _ in 0..steps {
                        bench.service.background.step();
                    }
                    None
                }
                Action::Tick { ticks } => {
                    for _ in 0..ticks {
                        let output = bench.tick();
                        let status = bench.status();
                        for (motor, old) in output.motors.iter().zip(&before.motors) {
                            prop_assert!(motor.rate.abs() <= RATE);
                            prop_assert!(motor.torque.abs() <= TORQUE);
                            // The angle moves as the rates say, to the square of a tick.
                            let mean = (motor.rate + old.rate) / 2.0;
                            let moved = motor.angle - old.angle;
                            let calm = output.is_on() && before.is_on();
                            prop_assert!(!calm || (moved - mean * PERIOD_S).abs() < 5e-3);
                        }
                        prop_assert!(!matches!(status.fault, Some(fault)
                            if fault.code != FaultCode::Drive(DriveFault::Reported)), "{:?}", status.fault);
                        before = output;
                    }
                    None
                }
            };
            if let Some(command) = command {
                let reply = bench.ask_as(sequence, command);
                last = Some((sequence, command, reply));
                sequence += 1;
            }
            let status = bench.status();
            prop_assert!(status.done <= status.admitted && status.admitted <= status.next);
        }

        // The way out. Seven orders may wait for their ticks, and an eighth is refused.
        bench.ticks(8);
        let mut ask = |bench: &mut Bench<Thesis<f64>>, command| {
            let reply = bench.ask_as(sequence, command);
            sequence += 1;
            reply
        };
        prop_assert_eq!(ask(&mut bench, Command::Stop), Reply::Done);
        bench.ticks(50);
        // Where a move leaves no room, a stop takes until its end: the longest has 120 ticks, or is a retarget's.
        for _ in 0..500 {
            if bench.state() == State::Stopping {
                bench.ticks(1);
            }
        }
        if bench.state() == State::Fault {
            prop_assert_eq!(ask(&mut bench, Command::ClearFault), Reply::Done);
            bench.ticks(1);
        }
        if bench.state() == State::Disabled {
            prop_assert_eq!(ask(&mut bench, Command::Enable), Reply::Done);
            bench.ticks(1);
        }
        if bench.state() == State::Cleared {
            let to = Recovery { to: home(), ticks: 500 };
            prop_assert_eq!(ask(&mut bench, Command::Recover(to)), Reply::Done);
            bench.ticks(510);
        }
        let status = bench.status();
        prop_assert_eq!(status.state, State::Idle);
        let end = status.end.unwrap();
        let away = rest(status.next, end.pose, place(2), 300);
        prop_assert_eq!(ask(&mut bench, Command::Move(away)), Reply::Done);
        bench.judge();
        prop_assert_eq!(ask(&mut bench, Command::Start), Reply::Done);
        bench.ticks(310);
        prop_assert_eq!(bench.state(), State::Idle);
        prop_assert_eq!(bench.status().end.unwrap().pose, place(2));
    }
}
