//! Moves in batches.

use super::*;
use trirrr_core::setpoint::Cubics;
use trirrr_protocol::message::{AnyMove, MoveBatch, MoveStep, QuinticMove};
use trirrr_protocol::wire::checksum;

/// Four moves over the plane: a cubic, two quintics, and a cubic to rest; with the tool in the middle.
fn chain(first: u32) -> [AnyMove<f64>; 4] {
    let poses = [
        home(),
        pose(0.215, 0.222, 0.157),
        pose(0.22, 0.226, 0.16),
        pose(0.225, 0.228, 0.162),
        pose(0.23, 0.23, 0.162),
    ];
    let velocity = [0.05, 0.03, 0.01];
    core::array::from_fn(|i| {
        let mut common = rest(first + i as u32, poses[i], poses[i + 1], 100);
        if i > 0 {
            common.start_velocity = velocity;
        }
        if i < 3 {
            common.end_velocity = velocity;
        }
        if i == 1 || i == 2 {
            (common.tool_power, common.tool_speed) = (0.5, 0.1);
            let (start, end) = match i {
                1 => ([0.0; 3], [0.1, 0.0, 0.0]),
                _ => ([0.1, 0.0, 0.0], [0.0; 3]),
            };
            return AnyMove::new(common, Some([start, end]));
        }
        AnyMove::Cubic(common)
    })
}

fn standing() -> trirrr_core::setpoint::Setpoint<f64> {
    AnyMove::Cubic(rest(0, home(), home(), 1)).end()
}

/// What a machine plays of these offers, and its status behind them.
fn played(offers: impl IntoIterator<Item = Command<f64>>) -> (Vec<Output<f64>>, Status<f64>) {
    let mut bench = Bench::<Thesis<f64>>::new();
    for offer in offers {
        bench.done(offer);
    }
    bench.judge();
    let status = bench.status();
    bench.done(Command::Start);
    ((0..420).map(|_| bench.tick()).collect(), status)
}

#[test]
fn a_batch_is_played_as_its_moves_one_by_one() {
    let moves = chain(0);
    let batch = MoveBatch::new(0, &standing(), &moves);
    assert_eq!(batch.steps().count(), 4);
    assert!(batch.moves(&standing()).eq(moves));
    let (once, status) = played([Command::Moves(batch)]);
    let (singly, one_by_one) = played(moves.map(|each| each.command()));
    assert_eq!((status.next, status.admitted), (4, 4));
    assert_eq!(status.end, one_by_one.end);
    assert!(once == singly);
    assert!(once.iter().any(|output| output.tool > 0.0));

    // In pieces, each behind the last.
    let (first, second) = moves.split_at(1);
    let halves = [
        MoveBatch::new(0, &standing(), first),
        MoveBatch::new(1, &first[0].end(), second),
    ];
    assert!(played(halves.map(Command::Moves)).0 == singly);
}

/// A batch ends where the moves do not follow on each other.
#[test]
fn a_batch_has_no_gap() {
    let mut moves = chain(0);
    let AnyMove::Quintic(QuinticMove { common, .. }) = &mut moves[2] else {
        unreachable!("it is one");
    };
    common.from = home();
    assert_eq!(MoveBatch::new(0, &standing(), &moves).steps().count(), 2);
    assert_eq!(
        MoveBatch::new(1, &standing(), &moves[1..]).steps().count(),
        0
    );
}

#[test]
fn a_refused_batch_leaves_nothing_behind() {
    let moves = chain(0);
    let batch = MoveBatch::new(0, &standing(), &moves);
    let expected = checksum(&standing()).unwrap();
    let with = |change: &dyn Fn(&mut MoveStep<f64>)| {
        let mut changed = batch;
        change(changed.steps[3].as_mut().unwrap());
        changed
    };
    let cases = [
        (
            MoveBatch { number: 1, ..batch },
            Refusal::MoveNumber { expected: 0 },
        ),
        (
            MoveBatch {
                check: !expected,
                ..batch
            },
            Refusal::Check { expected },
        ),
        (
            with(&|step| step.to.position.x = f64::NAN),
            Refusal::NotFinite,
        ),
        (
            with(&|step| step.acceleration = Some([f64::INFINITY; 3])),
            Refusal::NotFinite,
        ),
        (
            with(&|step| step.ticks = 0),
            Refusal::Duration {
                longest: longest_move(7),
            },
        ),
        (
            with(&|step| {
                step.tool = Some(trirrr_protocol::message::ToolSetting {
                    power: 2.0,
                    speed: 0.0,
                });
            }),
            Refusal::Tool,
        ),
    ];
    let mut bench = Bench::<Thesis<f64>>::new();
    let before = bench.status();
    for (refused, refusal) in cases {
        assert_eq!(bench.refused(Command::Moves(refused)), refusal);
        let after = bench.status();
        assert_eq!((after.next, after.room), (before.next, before.room));
        assert_eq!(after.end, before.end);
    }
    // The bench has room for seven: the second batch does not fit in.
    bench.done(Command::Moves(batch));
    let end = bench.status().end.unwrap();
    let more = chain(4).map(|each| {
        let mut common = *each.common();
        (common.from, common.to) = (end.pose, end.pose);
        (common.start_velocity, common.end_velocity) = ([0.0; 3], [0.0; 3]);
        AnyMove::Cubic(common)
    });
    let second = MoveBatch::new(4, &end, &more);
    assert_eq!(second.steps().count(), 4);
    assert_eq!(bench.refused(Command::Moves(second)), Refusal::QueueFull);
    assert_eq!((bench.status().next, bench.status().room), (4, 3));
    bench.done(Command::Moves(MoveBatch::new(4, &end, &more[..3])));
    assert_eq!((bench.status().next, bench.status().room), (7, 0));
    // None at all is no harm.
    let none = MoveBatch::new(7, &end, &[]);
    bench.done(Command::Moves(none));
}

/// A machine that plays cubics takes batches of cubics.
#[test]
fn a_machine_of_cubics_refuses_a_batch_with_a_quintic() {
    type Plain = Adjustable<Dynamic<f64>, Cubics>;
    let channels: Channels<Plain, 8, 8> = Channels::new();
    let scene = Plain::new(example(), LimitParameters::default());
    let service: Result<Service<'_, Plain>, _> =
        Box::leak(Box::new(channels)).service(scene, home(), settings());
    let mut service = service.unwrap();
    assert_eq!(service.submit(&Command::Enable), Reply::Done);
    service.tick();
    let moves = chain(0);
    let batch = MoveBatch::new(0, &standing(), &moves);
    let refusal = Reply::Refused(Refusal::NoQuintics);
    assert_eq!(service.submit(&Command::Moves(batch)), refusal);
    assert_eq!(service.status().next, 0);
    let cubic = MoveBatch::new(0, &standing(), &moves[..1]);
    assert_eq!(service.submit(&Command::Moves(cubic)), Reply::Done);
    assert_eq!(service.status().next, 1);
}
