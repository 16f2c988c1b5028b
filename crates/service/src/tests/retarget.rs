//! Retargets by command.

use super::*;
use trirrr_core::number::Fixed;
use trirrr_core::setpoint::Setpoint;
use trirrr_protocol::message::{Bounded, Goal};

fn goal<N: Enclose>(x: f64, y: f64, alpha: f64) -> Command<N> {
    Command::Retarget(Goal {
        to: pose(x, y, alpha),
        velocity: [N::ZERO; 3],
        cut: false,
        least_ticks: 0,
    })
}

fn limits() -> LimitParameters {
    LimitParameters {
        rate_rad_s: Some([1.5; 3]),
        acceleration_rad_s2: Some([3.0; 3]),
        torque_nm: Some([0.2; 3]),
        ..LimitParameters::default()
    }
}

fn bench<N: ServiceNumber>() -> Bench<Thesis<N>> {
    Bench::with(example(), limits())
}

/// Setpoints until the machine stands in idle.
fn played<N: ServiceNumber>(bench: &mut Bench<Thesis<N>>) -> Vec<Setpoint<N>> {
    let mut setpoints = Vec::new();
    for _ in 0..10_000 {
        bench.service.tick();
        if bench.state() == State::Idle {
            return setpoints;
        }
        let Some((setpoint, _)) = bench.service.motion() else {
            panic!("{:?}", bench.status());
        };
        setpoints.push(*setpoint);
    }
    panic!("never over");
}

/// `scale`: lengths of one metre.
fn goes_there<N: ServiceNumber>(mut bench: Bench<Thesis<N>>, scale: f64) {
    let there = || goal(0.28 * scale, 0.28 * scale, 0.3);
    let at = pose(0.28 * scale, 0.28 * scale, 0.3);
    bench.done(there());
    bench.judge();
    let status = bench.status();
    assert_eq!(status.refused, None);
    assert!(status.admitted > 0 && status.admitted == status.next);
    let end = status.end.expect("an end");
    assert_eq!(end.pose, at);
    assert_eq!(<[N; 3]>::from(end.velocity), [N::ZERO; 3]);
    bench.done(Command::Start);
    let setpoints = played(&mut bench);
    let last = setpoints.last().expect("a motion");
    assert_eq!(last.pose, at);
    assert_eq!(bench.status().done, status.admitted);
    // There already: no move.
    bench.done(there());
    bench.judge();
    assert_eq!(bench.status().next, status.next);
}

#[test]
fn a_goal_is_reached_in_every_number_type() {
    goes_there(bench::<f64>(), 1.0);
    goes_there(bench::<f32>(), 1.0);
    // A quarter of a metre, a quarter of a second, half a kilogram.
    let units = Units {
        length: -2,
        time: -2,
        mass: -1,
    };
    let scene = Adjustable::new(units.parameters(&example()), units.limits(&limits()));
    let stands = pose::<Fixed>(4.0 * 0.21, 4.0 * 0.22, 0.157);
    goes_there(Bench::in_units(scene, stands, units), 4.0);
}

/// Each goal but the last is passed in motion. The next one is planned while the machine is on its way.
#[test]
fn goals_in_motion_are_passed_without_a_stop() {
    let mut bench = bench::<f64>();
    let speed = [0.05, 0.04, 0.1];
    let at = |step: u32| {
        let t = f64::from(step);
        pose(0.21 + 0.015 * t, 0.22 + 0.012 * t, 0.16 + 0.03 * t)
    };
    for step in 1..5 {
        let velocity = if step < 4 { speed } else { [0.0; 3] };
        for _ in 0..1000 {
            if bench.status().room < 5 {
                bench.tick();
            }
        }
        bench.done(Command::Retarget(Goal {
            to: at(step),
            velocity,
            cut: false,
            least_ticks: 0,
        }));
        bench.judge();
        assert_eq!(bench.status().refused, None, "{step}");
        if step == 1 {
            bench.done(Command::Start);
        }
    }
    let setpoints = played(&mut bench);
    let accelerations = setpoints
        .windows(2)
        .map(|pair| pair[1].acceleration - pair[0].acceleration);
    // A jump of the acceleration at a joint would be of the size of the acceleration itself.
    let largest = accelerations
        .map(|step| step.xy().amax())
        .fold(0.0, f64::max);
    let size = setpoints.iter().map(|at| at.acceleration.xy().amax());
    assert!(largest < 0.7 * size.fold(0.0, f64::max), "{largest}");
    let last = setpoints.len() - 1;
    assert_eq!(setpoints[last].pose, at(4));
    let standing = |at: &Setpoint<f64>| at.velocity.xy().amax() == 0.0;
    assert!(!setpoints[1..last].iter().any(standing));
}

#[test]
fn a_goal_without_a_motion_is_refused_and_changes_nothing() {
    let mut bench = bench::<f64>();
    let before = bench.status();
    bench.done(goal(1.0, 0.28, 0.3));
    bench.judge();
    let status = bench.status();
    let refused = status.refused.expect("a refusal");
    assert_eq!(refused.number, before.next);
    assert_eq!(refused.violation.expect("a reason").what, Bounded::Reach);
    assert_eq!((status.next, status.end), (before.next, before.end));
    assert_eq!(bench.refused(goal(f64::NAN, 0.28, 0.3)), Refusal::NotFinite);
    bench.offer(rest(0, home(), pose(0.22, 0.23, 0.16), 100));
}

#[test]
fn nothing_is_queued_behind_a_retarget_that_is_being_planned() {
    let mut bench = bench::<f64>();
    bench.done(goal(0.28, 0.28, 0.3));
    bench.service.step();
    let away = rest(0, home(), pose(0.22, 0.23, 0.16), 100);
    assert_eq!(bench.refused(Command::Move(away)), Refusal::Retargeting);
    assert_eq!(bench.refused(goal(0.25, 0.25, 0.1)), Refusal::Retargeting);
    assert_eq!(bench.refused(Command::Start), Refusal::Undecided);
    // A stop drops it, as it drops moves.
    bench.done(Command::Stop);
    bench.ticks(2);
    bench.judge();
    let status = bench.status();
    assert_eq!((status.next, status.admitted), (0, 0));
    bench.offer(away);
    // Behind moves that are not judged it would not know where it starts.
    bench.done(Command::Move(rest(1, pose(0.22, 0.23, 0.16), home(), 100)));
    assert_eq!(bench.refused(goal(0.25, 0.25, 0.1)), Refusal::Undecided);
}
