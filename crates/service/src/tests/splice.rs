//! Retargets that cut the motion under way.

use super::*;
use trirrr_core::number::WideArithmetic;
use trirrr_core::setpoint::{Segment, Setpoint};
use trirrr_protocol::message::{Acting, AnyMove, Cut, Goal, QuinticMove};

fn limits() -> LimitParameters {
    LimitParameters {
        rate_rad_s: Some([1.5; 3]),
        acceleration_rad_s2: Some([6.0; 3]),
        torque_nm: Some([0.4; 3]),
        ..LimitParameters::default()
    }
}

fn there<N: Enclose>() -> Pose<N> {
    pose(0.28, 0.28, 0.209)
}

fn back<N: Enclose>() -> Pose<N> {
    pose(0.22, 0.25, 0.1)
}

fn goal<N: Enclose>(to: Pose<N>, velocity: [f64; 3]) -> Command<N> {
    Command::Retarget(Goal {
        to,
        velocity: velocity.map(N::from_f64),
        cut: true,
        least_ticks: 0,
    })
}

/// A machine that has played `ticks` of a move of 300 ticks.
fn under_way<N: ServiceNumber>(ticks: u32) -> Bench<Thesis<N>> {
    let mut bench = Bench::<Thesis<N>>::with(example(), limits());
    bench.offer(rest(0, home(), there(), 300));
    bench.done(Command::Start);
    bench.ticks(ticks);
    bench
}

/// Ticks until the machine is in `state`, with all the background work that there is, and its setpoints.
fn played<N: ServiceNumber>(bench: &mut Bench<Thesis<N>>, state: State) -> Vec<Setpoint<N>> {
    let mut setpoints = Vec::new();
    for _ in 0..10_000 {
        while bench.service.step() {}
        bench.tick();
        setpoints.extend(bench.service.motion().map(|(setpoint, _)| *setpoint));
        if bench.state() == state {
            return setpoints;
        }
        bench.ask(Command::Status);
    }
    panic!("never {state:?}: {:?}", bench.status());
}

/// Asserts that the velocity changes by the acceleration, and the acceleration by less than itself in a tick.
#[track_caller]
fn assert_smooth(setpoints: &[Setpoint<f64>]) {
    let largest = setpoints
        .iter()
        .map(|each| each.acceleration.amax())
        .fold(0.0, f64::max);
    for pair in setpoints.windows(2) {
        let [before, after] = pair else {
            unreachable!("windows of two");
        };
        let mean = (before.acceleration + after.acceleration) / 2.0;
        let off = after.velocity - before.velocity - mean * PERIOD_S;
        assert!(off.amax() < 0.05 * largest * PERIOD_S, "{pair:?}");
    }
}

fn goes_there<N: ServiceNumber>() {
    let mut bench = under_way::<N>(100);
    bench.done(goal(back(), [0.0; 3]));
    let setpoints = played(&mut bench, State::Idle);
    let status = bench.status();
    assert_eq!(setpoints.last().map(|last| last.pose), Some(back()));
    assert_eq!(status.end.map(|end| end.pose), Some(back()));
    let cut = status.cut.expect("a cut");
    assert_eq!((cut.number, cut.next), (0, 1));
    assert!((100..140).contains(&cut.at), "{cut:?}");
    assert!(status.done > 1 && status.done == status.admitted && status.done == status.next);
    // Up to the cut it is the move that was under way, from there the first of the new ones.
    let old = Segment::new(
        &crate::offered::Offered::<N, trirrr_core::setpoint::Quintics>::cubic(&rest(
            0,
            home(),
            there(),
            300,
        ))
        .ends(),
        300,
        N::factor_from_f64(PERIOD_S),
    );
    let played = &bench.telemetry[bench.telemetry.len() - setpoints.len()..];
    for sample in played.iter().take_while(|sample| sample.number == 0) {
        assert!(sample.at < cut.at);
        assert_eq!(sample.setpoint, old.at(sample.at));
    }
    let first = played
        .iter()
        .find(|sample| sample.number == 1)
        .expect("a new move");
    assert_eq!((first.at, first.part), (0, 0));
    let place = old.at(cut.at);
    assert_eq!(first.setpoint.pose, place.pose);
    let near = |a: N, b: N| (a - b).abs() <= N::from_f64(1e-5) * (N::ONE + b.abs());
    for axis in 0..3 {
        assert!(near(first.setpoint.velocity[axis], place.velocity[axis]));
        assert!(near(
            first.setpoint.acceleration[axis],
            place.acceleration[axis]
        ));
    }
}

#[test]
fn a_goal_cuts_the_move_under_way_in_every_number_type() {
    goes_there::<f64>();
    goes_there::<f32>();
}

#[test]
fn the_motion_stays_smooth_across_cuts() {
    let mut bench = under_way::<f64>(100);
    let mut all = Vec::new();
    for (to, velocity) in [
        (back(), [0.0; 3]),
        (there(), [0.02, 0.01, 0.0]),
        (pose(0.25, 0.24, 0.2), [0.0; 3]),
    ] {
        bench.done(goal(to, velocity));
        for _ in 0..25 {
            while bench.service.step() {}
            bench.tick();
            all.extend(bench.service.motion().map(|(setpoint, _)| *setpoint));
        }
    }
    let cut = bench.status().cut.expect("a cut");
    assert!(cut.number > 1, "{cut:?}");
    all.extend(played(&mut bench, State::Idle));
    assert_smooth(&all);
    assert_eq!(
        all.last().map(|last| last.pose),
        Some(pose(0.25, 0.24, 0.2))
    );
}

/// The background does nothing for some ticks: the order comes too late, and the next one in time.
#[test]
fn a_late_order_is_repeated_from_farther_ahead() {
    let mut bench = under_way::<f64>(50);
    bench.done(goal(back(), [0.0; 3]));
    // It knows its place and plans, but slowly.
    for _ in 0..100 {
        for _ in 0..2 {
            bench.service.step();
        }
        bench.tick();
    }
    let setpoints = played(&mut bench, State::Idle);
    assert_smooth(&setpoints);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(back()));
    let cut = bench.status().cut.expect("a cut");
    assert!(cut.at > 100, "{cut:?}");
}

/// The goal follows behind the move if that is over before.
#[test]
fn a_goal_that_is_planned_too_late_follows_behind() {
    let mut bench = under_way::<f64>(290);
    bench.done(goal(back(), [0.0; 3]));
    bench.ticks(30);
    assert_eq!(bench.state(), State::Idle);
    bench.judge();
    bench.ticks(2);
    bench.judge();
    let status = bench.status();
    assert_eq!(status.cut, None);
    assert_eq!(status.end.map(|end| end.pose), Some(back()));
    bench.done(Command::Start);
    let setpoints = played(&mut bench, State::Idle);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(back()));
}

#[test]
fn a_held_machine_goes_to_the_goal_once_it_is_resumed() {
    let mut bench = under_way::<f64>(100);
    bench.done(Command::Hold);
    played(&mut bench, State::Holding);
    let place = bench.telemetry[bench.telemetry.len() - 1].at;
    bench.done(goal(back(), [0.0; 3]));
    for _ in 0..20 {
        while bench.service.step() {}
        bench.tick();
    }
    assert_eq!(bench.state(), State::Holding);
    assert_eq!(bench.status().cut, None);
    bench.done(Command::Resume);
    let setpoints = played(&mut bench, State::Idle);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(back()));
    let cut = bench.status().cut.expect("a cut");
    assert_eq!(
        cut,
        Cut {
            number: 0,
            at: place + 1,
            next: 1
        }
    );
}

/// Ticks with all the background work that there is.
fn work(bench: &mut Bench<Thesis<f64>>, ticks: u32) {
    for _ in 0..ticks {
        while bench.service.step() {}
        bench.tick();
        bench.ask(Command::Status);
    }
}

/// A held machine takes one goal in place of the other, as often as it is given one: it goes to the last of them from where it stands. One
/// without a motion is refused, and the one before it counts.
#[test]
fn a_held_machine_goes_to_the_last_of_its_goals() {
    let mut bench = under_way::<f64>(100);
    bench.done(Command::Hold);
    played(&mut bench, State::Holding);
    let place = bench.telemetry[bench.telemetry.len() - 1].at;
    let last = pose(0.24, 0.22, 0.12);
    for to in [back(), there(), pose(0.26, 0.24, 0.1), last] {
        bench.done(goal(to, [0.0; 3]));
        // While it is planned there is no other in its place.
        bench.service.step();
        assert_eq!(bench.refused(goal(back(), [0.0; 3])), Refusal::Retargeting);
        work(&mut bench, 40);
        assert_eq!(bench.status().end.map(|end| end.pose), Some(to));
    }
    bench.done(goal(pose(1.0, 0.2, 0.1), [0.0; 3]));
    work(&mut bench, 40);
    let status = bench.status();
    assert!(status.refused.is_some() && status.planning);
    assert_eq!((status.state, status.cut), (State::Holding, None));
    assert_eq!(status.end.map(|end| end.pose), Some(last));
    bench.done(Command::Resume);
    let setpoints = played(&mut bench, State::Idle);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(last));
    let status = bench.status();
    let cut = status.cut.expect("a cut");
    assert_eq!((cut.number, cut.at), (0, place + 1));
    assert_eq!(status.done, status.next);
}

/// A goal in motion, nearer than the machine could stop from normal pace: five ticks ahead, where the motion itself leads to. The machine
/// gets there slowly, and waits on the chain for the next.
#[test]
fn a_near_goal_in_motion_does_not_freeze_a_held_machine() {
    let mut bench = under_way::<f64>(140);
    bench.done(Command::Hold);
    played(&mut bench, State::Holding);
    let place = bench.telemetry[bench.telemetry.len() - 1].at;
    let offered = rest(0, home(), there(), 300);
    let offered = crate::offered::Offered::<f64, trirrr_core::setpoint::Quintics>::cubic(&offered);
    let ahead = Segment::new(&offered.ends(), 300, f64::factor_from_f64(PERIOD_S)).at(place + 6);
    bench.done(goal(ahead.pose, ahead.velocity.into()));
    work(&mut bench, 20);
    bench.done(Command::Resume);
    work(&mut bench, 200);
    let status = bench.status();
    assert_eq!(
        (status.state, status.acting),
        (State::Holding, Acting::QueueDry)
    );
    assert!(!status.planning && status.cut.is_some(), "{status:?}");
    bench.done(goal(back(), [0.0; 3]));
    let setpoints = played(&mut bench, State::Idle);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(back()));
}

/// A goal that comes while the machine moves towards a cut is planned from behind it.
#[test]
fn a_goal_takes_the_place_of_one_whose_cut_is_ahead() {
    for hold in [false, true] {
        for wait in 0..12 {
            let mut bench = under_way::<f64>(100);
            bench.done(goal(there(), [0.02, 0.01, 0.0]));
            for _ in 0..wait {
                while bench.service.step() {}
                bench.tick();
            }
            if hold {
                bench.done(Command::Hold);
            }
            while bench.ask(goal(back(), [0.0; 3])) != Reply::Done {
                work(&mut bench, 1);
            }
            work(&mut bench, 60);
            if hold {
                bench.done(Command::Resume);
            }
            let mut setpoints = played(&mut bench, State::Idle);
            setpoints.dedup_by(|a, b| a == b);
            assert_eq!(
                setpoints.last().map(|last| last.pose),
                Some(back()),
                "{wait} {hold}"
            );
        }
    }
}

/// A hold that begins just before the cut leads over it.
#[test]
fn a_hold_leads_over_the_cut() {
    for wait in 0..14 {
        let mut bench = under_way::<f64>(100);
        bench.done(goal(back(), [0.0; 3]));
        for _ in 0..wait {
            while bench.service.step() {}
            bench.tick();
        }
        bench.done(Command::Hold);
        let mut setpoints = played(&mut bench, State::Holding);
        bench.done(Command::Resume);
        setpoints.extend(played(&mut bench, State::Idle));
        assert_eq!(
            setpoints.last().map(|last| last.pose),
            Some(back()),
            "{wait}"
        );
    }
}

#[test]
fn a_stop_before_the_cut_drops_the_goal() {
    for wait in 0..12 {
        let mut bench = under_way::<f64>(100);
        bench.done(goal(back(), [0.0; 3]));
        for _ in 0..wait {
            while bench.service.step() {}
            bench.tick();
        }
        bench.done(Command::Stop);
        played(&mut bench, State::Idle);
        bench.ticks(30);
        let status = bench.status();
        assert_eq!((status.state, status.acting), (State::Idle, Acting::Stop));
        assert_eq!(
            (status.next, status.done),
            (status.admitted, status.next),
            "{wait}"
        );
        // It goes on from there, with another retarget.
        let end = status.end.expect("it stands");
        bench.offer(rest(status.next, end.pose, there(), 300));
        bench.done(Command::Start);
        bench.ticks(20);
        bench.done(goal(back(), [0.0; 3]));
        let setpoints = played(&mut bench, State::Idle);
        assert_eq!(
            setpoints.last().map(|last| last.pose),
            Some(back()),
            "{wait}"
        );
        assert_eq!(bench.status().cut.map(|cut| cut.number), Some(status.next));
    }
}

/// Moves that are queued behind the cut are not played, judged or not, and a full queue is no obstacle.
#[test]
fn moves_behind_the_cut_are_dropped() {
    let mut bench = Bench::<Thesis<f64>>::with(example(), limits());
    let poses = [home(), there()];
    for number in 0..7 {
        let turn = number as usize;
        let each = rest(number, poses[turn % 2], poses[(turn + 1) % 2], 300);
        bench.done(Command::Move(each));
    }
    assert_eq!(bench.status().room, 0);
    bench.judge();
    bench.done(Command::Start);
    bench.ticks(320);
    bench.done(goal(back(), [0.0; 3]));
    let number = 7;
    bench.until(State::Running);
    for _ in 0..30 {
        while bench.service.step() {}
        bench.tick();
    }
    let status = bench.status();
    let cut = status.cut.expect("a cut");
    assert_eq!((cut.number, cut.next), (1, number));
    assert_eq!(status.done, number);
    // Behind it the host goes on.
    let end = status.end.expect("an end");
    bench.offer(rest(status.next, end.pose, there(), 300));
    let setpoints = played(&mut bench, State::Idle);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(there()));
    assert_eq!(bench.status().done, status.next + 1);
    assert_eq!(bench.status().room, 7);
}

/// The chain of a retarget is cut by the next, again and again.
#[test]
fn a_target_is_followed() {
    let mut bench = under_way::<f64>(20);
    let mut cuts = 0;
    let mut last = None;
    for step in 0..60 {
        let (sin, cos) = (f64::from(step) * 0.2).sin_cos();
        let to = pose(0.25 + 0.02 * cos, 0.26 + 0.02 * sin, 0.15);
        bench.done(goal(to, [0.0; 3]));
        for _ in 0..12 {
            while bench.service.step() {}
            bench.tick();
        }
        if bench.state() == State::Idle {
            bench.done(Command::Start);
        }
        let cut = bench.status().cut;
        cuts += u32::from(cut != last);
        last = cut;
    }
    assert!(cuts > 30, "{cuts}");
    let setpoints = played(&mut bench, State::Idle);
    assert!(!setpoints.is_empty());
}

/// A quintic under way is cut like a cubic.
#[test]
fn quintics_are_cut() {
    let mut bench = Bench::<Thesis<f64>>::with(example(), limits());
    let quintic = QuinticMove {
        common: rest(0, home(), there(), 300),
        start_acceleration: [0.0; 3],
        end_acceleration: [0.0; 3],
    };
    bench.done(AnyMove::Quintic(quintic).command());
    bench.judge();
    bench.done(Command::Start);
    bench.ticks(150);
    bench.done(goal(back(), [0.0; 3]));
    let setpoints = played(&mut bench, State::Idle);
    assert_eq!(setpoints.last().map(|last| last.pose), Some(back()));
    assert_smooth(&setpoints);
    assert!(bench.status().cut.is_some());
}

/// Goals in motion, each to be passed in its own time: between them the velocity is that of the goals. Without another the
/// machine comes to rest before the last of them.
#[test]
fn goals_in_time_make_a_jog() {
    let mut bench = Bench::<Thesis<f64>>::with(example(), limits());
    let (speed, ahead) = ([0.02, 0.01, 0.0], 40u32);
    let jog = |tick: u32| {
        let t = f64::from(tick) * PERIOD_S;
        Command::Retarget(Goal {
            to: pose(0.21 + speed[0] * t, 0.22 + speed[1] * t, 0.157),
            velocity: speed,
            cut: true,
            least_ticks: ahead,
        })
    };
    bench.done(jog(ahead / 2));
    bench.judge();
    bench.done(Command::Start);
    let mut all = Vec::new();
    for step in 1..12 {
        for _ in 0..20 {
            while bench.service.step() {}
            bench.tick();
            all.extend(bench.service.motion().map(|(setpoint, _)| *setpoint));
        }
        bench.done(jog(ahead / 2 + 20 * step));
    }
    assert_smooth(&all);
    for each in &all[all.len() / 2..] {
        let off = each.velocity - nalgebra::Vector3::from(speed);
        assert!(off.amax() < 1e-3, "{each:?}");
    }
    // The host is gone.
    let last = played(&mut bench, State::Holding).pop().expect("a motion");
    assert_eq!(<[f64; 3]>::from(last.velocity), [0.0; 3]);
    assert_eq!(bench.status().acting, Acting::QueueDry);
}
