//! A service that gets geometry: it plans, proves and plays a path by itself.

use crate::problems::{from_outline, machine, outline};
use nalgebra::Vector2;
use trirrr_core::limits::LimitParameters;
use trirrr_core::model::Dynamic;
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, Quintics, Setpoint};
use trirrr_core::torque::links::{Horizontal, Massive};
use trirrr_core::torque::payload::Centred;
use trirrr_plan::piece::{Piece, PlaneCurve};
use trirrr_plan::window::{ServicePlanner, WindowSettings};
use trirrr_protocol::message::{
    Bounded, Command, Message, Move, PathCurve, PathPiece, Refusal, Reply, State, Verdict,
};
use trirrr_service::{Adjustable, Channels, Service, Settings};

const FEED: f64 = 0.25;
const TORQUE: f64 = 0.3;
const TOLERANCE: f64 = 1e-5;

type Machine = Dynamic<f32, Centred<f32>, Massive<f32, Horizontal>>;
type PlanningScene = Adjustable<Machine, Quintics, ServicePlanner<f32, 8, 64>>;
type Queues = Channels<PlanningScene, 64, 64>;

fn start() -> Pose<f32> {
    Pose::from_f64(0.25, 0.245, 0.4)
}

fn service(queues: &mut Queues) -> Service<'_, PlanningScene> {
    let limits = LimitParameters {
        torque_nm: Some([TORQUE; 3]),
        rate_rad_s: Some([5.0; 3]),
        ..LimitParameters::default()
    };
    let scene = Adjustable::new(machine(true), limits);
    let settings = Settings {
        planning: Some(
            WindowSettings {
                period_s: 1e-3,
                ticks: 3,
                tolerance_m: TOLERANCE,
                tolerance_rad: 1e-4,
                lever_m: 0.1,
                hold_rate: 0.0,
            }
            .planning(),
        ),
        telemetry_every: 1,
        ..Settings::at(1000.0)
    };
    let mut service = queues.service(scene, start(), settings).expect("a machine");
    assert_eq!(service.submit(&Command::Enable), Reply::Done);
    service.tick();
    while service.outgoing().is_some() {}
    service
}

/// The pieces as they go over the line.
fn sent(pieces: &[Piece<f64>]) -> Vec<PathPiece<f32>> {
    let curve = |piece: &Piece<f64>| match piece.curve {
        PlaneCurve::Line { .. } => PathCurve::Line {
            to: piece.over::<f32>().at(1.0).pose,
        },
        PlaneCurve::Arc { centre, turn, .. } => PathCurve::Arc {
            centre: [centre.x as f32, centre.y as f32],
            turn: turn as f32,
            to_angle: piece.end().angle as f32,
        },
        PlaneCurve::Cubic { .. } => panic!("the outline has none"),
    };
    let piece = |(number, each)| PathPiece {
        number: number as u32,
        curve: curve(each),
        feed: FEED as f32,
        tool_power: 0.5,
        tool_speed: FEED as f32,
        last: number + 1 == pieces.len(),
    };
    pieces.iter().enumerate().map(piece).collect()
}

/// Setpoint of a tick, with the tool's power.
type Played = (Setpoint<f32>, f32);

/// Ticks until the machine rests with nothing to do, giving pieces as there is room for them. `act` is called before each
/// tick.
fn play(
    service: &mut Service<'_, PlanningScene>,
    pieces: &[PathPiece<f32>],
    mut act: impl FnMut(&mut Service<'_, PlanningScene>, usize),
) -> (Vec<Played>, Vec<Verdict<f32>>) {
    let (mut played, mut refused) = (Vec::new(), Vec::new());
    let mut given = 0;
    for tick in 0..20_000 {
        act(service, tick);
        let mut is_full = false;
        while !is_full && given < pieces.len() && refused.is_empty() {
            match service.submit(&Command::Path(pieces[given])) {
                Reply::Done => given += 1,
                Reply::Refused(Refusal::QueueFull) => is_full = true,
                Reply::Refused(Refusal::State(_)) => break,
                other => panic!("{other:?}"),
            }
        }
        while service.step() {}
        if service.state() == State::Idle {
            match service.submit(&Command::Start) {
                Reply::Done | Reply::Refused(Refusal::Undecided | Refusal::State(_)) => {}
                Reply::Refused(Refusal::NothingQueued) => {
                    let planning = service.status().planning;
                    if (given == pieces.len() || !refused.is_empty()) && !planning {
                        return (played, refused);
                    }
                }
                other => panic!("{other:?} {tick} {given} {:?}", service.status()),
            }
        }
        service.tick();
        while let Some(message) = service.outgoing() {
            match message {
                Message::Telemetry(sample) => played.push((sample.setpoint, sample.tool)),
                Message::Event(trirrr_protocol::message::Event::Verdict(verdict))
                    if verdict.violation.is_some() =>
                {
                    refused.push(verdict);
                }
                _ => {}
            }
        }
    }
    panic!("no end: {:?}", service.status());
}

/// Checks that every tick lies on the outline, and keeps the feed.
fn on_outline(played: &[Played]) {
    // Positions are rounded in binary32.
    let most = TOLERANCE + 1e-7;
    for (setpoint, _) in played {
        let away = from_outline(setpoint.pose.position.map(f64::from));
        assert!(away <= most, "{away} at {:?}", setpoint.pose);
        let speed = setpoint.velocity.x.hypot(setpoint.velocity.y);
        assert!(f64::from(speed) <= FEED * (1.0 + 1e-5), "{speed}");
    }
}

fn is_at(pose: &Pose<f32>, at: &Pose<f32>) -> bool {
    let off = pose.displacement(at);
    off.x.hypot(off.y) < 1e-6 && off.z.abs() < 1e-6
}

#[test]
fn a_path_is_planned_and_played() {
    let mut queues = Box::new(Queues::new());
    let mut service = service(&mut queues);
    let (played, refused) = play(&mut service, &sent(&outline()), |_, _| {});
    assert_eq!(refused, []);
    on_outline(&played);
    let (last, _) = played.last().expect("ticks");
    assert!(is_at(&last.pose, &start()), "{:?}", last.pose);
    assert_eq!(service.status().piece, 8 + 1);
    // 1.76872 s are the least, by `min_time.csv`.
    let moving = played
        .iter()
        .filter(|(setpoint, _)| setpoint.velocity.x != 0.0 || setpoint.velocity.y != 0.0);
    let seconds = 1e-3 * moving.count() as f64;
    println!("{seconds} s");
    assert!(seconds < 1.02 * 1.76872 + 0.01, "{seconds}");
    // The tool has half of its power at the feed, and none at rest.
    for (setpoint, power) in &played {
        let speed = setpoint.velocity.x.hypot(setpoint.velocity.y);
        let expected = 0.5 * speed / FEED as f32;
        assert!((power - expected).abs() < 1e-3, "{power} at {speed} m/s");
    }
}

#[test]
fn a_path_is_held_and_stopped() {
    let mut queues = Box::new(Queues::new());
    let mut service = service(&mut queues);
    let pieces = sent(&outline());
    let (played, refused) = play(&mut service, &pieces, |service, tick| match tick {
        400 => assert_eq!(service.submit(&Command::Hold), Reply::Done),
        700 => assert_eq!(service.submit(&Command::Resume), Reply::Done),
        _ => {}
    });
    assert_eq!(refused, []);
    on_outline(&played);
    let (last, _) = played.last().expect("ticks");
    assert!(is_at(&last.pose, &start()), "{:?}", last.pose);

    // A stop drops the path; another one begins where the machine stands.
    let renumbered = |pieces: &[PathPiece<f32>], first: u32| -> Vec<PathPiece<f32>> {
        let piece = |each: &PathPiece<f32>| PathPiece {
            number: first + each.number,
            ..*each
        };
        pieces.iter().map(piece).collect()
    };
    let first = service.status().piece;
    for piece in &renumbered(&pieces, first)[..4] {
        assert_eq!(service.submit(&Command::Path(*piece)), Reply::Done);
    }
    while service.step() {}
    let mut moves = 0;
    while service.state() != State::Idle || moves == 0 {
        if service.submit(&Command::Start) == Reply::Done {
            moves += 1;
        }
        service.tick();
        while service.step() {}
        if service.status().done > 40 && service.state() == State::Running {
            assert_eq!(service.submit(&Command::Stop), Reply::Done);
        }
    }
    let status = service.status();
    assert!(!status.planning, "{status:?}");
    let here = status.end.expect("it stands").pose;
    assert!(!is_at(&here, &start()));
    let home = PathPiece {
        number: status.piece,
        curve: PathCurve::Line { to: start() },
        last: true,
        ..pieces[0]
    };
    let (played, refused) = play(&mut service, &[home], |_, _| {});
    assert_eq!(refused, []);
    let (last, _) = played.last().expect("ticks");
    assert!(is_at(&last.pose, &start()), "{:?}", last.pose);
}

#[test]
fn pieces_are_refused_with_the_reason() {
    let mut queues = Box::new(Queues::new());
    let mut service = service(&mut queues);
    let good = sent(&outline());
    let refused = |service: &mut Service<'_, PlanningScene>, piece| match service
        .submit(&Command::Path(piece))
    {
        Reply::Refused(refusal) => refusal,
        other => panic!("{other:?}"),
    };
    let other = |number| PathPiece { number, ..good[0] };
    assert_eq!(
        refused(&mut service, other(1)),
        Refusal::MoveNumber { expected: 0 }
    );
    let infinite = PathPiece {
        feed: f32::INFINITY,
        ..good[0]
    };
    assert_eq!(refused(&mut service, infinite), Refusal::NotFinite);
    let backwards = PathPiece {
        feed: -1.0,
        ..good[0]
    };
    assert_eq!(refused(&mut service, backwards), Refusal::Feed);
    let tool = PathPiece {
        tool_power: 2.0,
        ..good[0]
    };
    assert_eq!(refused(&mut service, tool), Refusal::Tool);
    assert!(!service.status().planning);

    // A path is under way: no move comes between.
    assert_eq!(service.submit(&Command::Path(good[0])), Reply::Done);
    let wait = Move::rest_to_rest(0, start(), start(), 10);
    assert_eq!(
        service.submit(&Command::Move(wait)),
        Reply::Refused(Refusal::PathUnderWay)
    );
    // The second piece leaves the workspace: the machine comes to rest at the end of the first.
    let far = PathPiece {
        number: 1,
        curve: PathCurve::Line {
            to: Pose::from_f64(0.9, 0.245, 0.4),
        },
        last: true,
        ..good[0]
    };
    let (played, verdicts) = play(&mut service, &[far], |_, _| {});
    let [
        Verdict {
            violation: Some(violation),
            ..
        },
    ] = &verdicts[..]
    else {
        panic!("{verdicts:?}");
    };
    assert!(
        matches!(
            violation.what,
            Bounded::Reach | Bounded::SerialDistance | Bounded::Torque
        ),
        "{violation:?}"
    );
    assert_eq!(service.status().piece, 1);
    let (last, _) = played.last().expect("ticks");
    let first = Vector2::new(last.pose.position.x, last.pose.position.y);
    assert_eq!(last.velocity.x, 0.0);
    assert!(first.x.to_f64() >= 0.25, "{first}");
}
