//! Moves end where they are told to and follow each other without a jump, however long they are
//! and however many: time is a number of ticks.

use nalgebra::{Vector2, Vector3};
use proptest::prelude::*;
use std::cell::RefCell;
use trirrr_core::number::{Arithmetic, Number};
use trirrr_core::setpoint::{Hermite, Pose, Quintic, RestToRest, Setpoint};
use trirrr_tests::bound::Worst;
use trirrr_tests::random::for_all;

const NO_VELOCITY: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

fn pose() -> impl Strategy<Value = Pose<f64>> {
    (-1.0..1.0, -1.0..1.0, -10.0..10.0).prop_map(|(x, y, alpha)| Pose::from_f64(x, y, alpha))
}

fn velocity() -> impl Strategy<Value = Vector3<f64>> {
    [-1.0..1.0, -1.0..1.0, -3.0..3.0].prop_map(Vector3::from)
}

fn ticks() -> impl Strategy<Value = u32> {
    prop_oneof![
        1u32..5,
        1u32..1000,
        any::<u32>().prop_filter("positive", |&ticks| ticks > 0)
    ]
}

fn coordinates<N: Number>(pose: &Pose<N>) -> [f64; 3] {
    [
        pose.position.x.to_f64(),
        pose.position.y.to_f64(),
        N::angle_to_f64(pose.angle),
    ]
}

fn rounded<N: Number>(pose: &Pose<f64>) -> Pose<N> {
    Pose::from_f64(pose.position.x, pose.position.y, pose.angle)
}

/// Both ends of all kinds of move, to the bit, for f32 and f64, up to u32::MAX ticks; and after
/// the end, the end.
fn ends_are_exact<N: Number>() {
    let moves = (pose(), pose(), velocity(), velocity(), ticks());
    for_all(5000, moves, |(from, to, v0, v1, ticks)| {
        let (from, to, period) = (
            rounded::<N>(&from),
            rounded::<N>(&to),
            N::factor_from_f64(0.01),
        );
        let rest = RestToRest::new(from, to, ticks, period);
        let chained = Hermite::new(
            from,
            v0.map(N::from_f64),
            to,
            v1.map(N::from_f64),
            ticks,
            period,
        );
        let quintic = Quintic::new(
            [from, to],
            [v0, v1].map(|v| v.map(N::from_f64)),
            [v1, v0].map(|a| a.map(N::from_f64)),
            ticks,
            period,
        );
        assert_eq!(rest.at(0).pose, from);
        assert_eq!(chained.at(0).pose, from);
        assert_eq!(quintic.at(0).pose, from);
        for tick in [ticks, ticks.saturating_add(1), u32::MAX] {
            assert_eq!(rest.at(tick).pose, to);
            assert_eq!(chained.at(tick).pose, to);
            assert_eq!(quintic.at(tick).pose, to);
        }
        for end in [rest.at(0), rest.at(ticks)] {
            assert!(end.velocity.iter().all(|v| v.to_f64() == 0.0));
        }
    });
}

#[test]
fn ends_are_exact_in_f64() {
    ends_are_exact::<f64>();
}

#[test]
fn ends_are_exact_in_f32() {
    ends_are_exact::<f32>();
}

/// At the joint of two moves both give the same pose to the bit; the velocity they share is
/// multiplied by the duration and divided by it again: four roundings in each.
#[test]
fn moves_join_without_a_jump() {
    let worst = RefCell::new(Worst::default());
    let moves = ([pose(), pose(), pose()], velocity(), ticks(), ticks());
    for_all(5000, moves, |(poses, v, first, second)| {
        let before = Hermite::new(poses[0], NO_VELOCITY, poses[1], v, first, 0.01);
        let after = Hermite::new(poses[1], v, poses[2], NO_VELOCITY, second, 0.01);
        let (end, start) = (before.at(first), after.at(0));
        assert_eq!(end.pose, start.pose);
        for i in 0..3 {
            for velocity in [end.velocity[i], start.velocity[i]] {
                let bound = 4.0 * f64::UNIT_ROUNDOFF * v[i].abs();
                worst.borrow_mut().compare(
                    || format!("{v:?} {first} {second}"),
                    velocity - v[i],
                    bound,
                );
            }
        }
    });
    worst
        .into_inner()
        .assert_within("velocity at joints", 0.2..=1.0);
}

/// At the joint of two quintics velocity and acceleration are the same but for the roundings of a multiplication by
/// the duration, or its square, and of the division. An acceleration has those of m / T^2 besides, which cancels there.
#[test]
fn quintics_join_without_a_jump() {
    let worst = RefCell::new([Worst::default(), Worst::default()]);
    let moves = (
        [pose(), pose(), pose()],
        [velocity(), velocity()],
        ticks(),
        ticks(),
    );
    for_all(5000, moves, |(poses, [v, a], first, second)| {
        let zero = NO_VELOCITY;
        let before = Quintic::new([poses[0], poses[1]], [zero, v], [zero, a], first, 0.01);
        let after = Quintic::new([poses[1], poses[2]], [v, zero], [a, zero], second, 0.01);
        let (end, start, ticks) = (before.at(first), after.at(0), (first, second));
        assert_eq!(end.pose, start.pose);
        let (first, second) = ([poses[0], poses[1]], [poses[1], poses[2]]);
        for (joint, [from, to], ticks) in [(end, first, ticks.0), (start, second, ticks.1)] {
            let duration = 0.01 * f64::from(ticks);
            let m = from.displacement(&to) * 2.0 - v * duration;
            let cancels = m.map(|m| m.abs() / (duration * duration));
            for (index, (found, given)) in [(joint.velocity, v), (joint.acceleration, a)]
                .into_iter()
                .enumerate()
            {
                for i in 0..3 {
                    let roundings = [4.0, 8.0][index];
                    worst.borrow_mut()[index].compare(
                        || format!("{given:?} {ticks}"),
                        found[i] - given[i],
                        roundings
                            * f64::UNIT_ROUNDOFF
                            * (given[i].abs() + index as f64 * cancels[i]),
                    );
                }
            }
        }
    });
    let [velocities, accelerations] = worst.into_inner();
    velocities.assert_within("velocity at joints", 0.2..=1.0);
    accelerations.assert_within("acceleration at joints", 0.2..=1.0);
}

/// The Hermite cubic with both velocities zero is the rest-to-rest cubic, summed otherwise: pose
/// within some roundings of the displacement and of the pose, velocity and acceleration of their
/// greatest values 3 h / 2 T and 6 h / T^2.
#[test]
fn hermite_without_velocities_is_rest_to_rest() {
    let worst = RefCell::new(Worst::default());
    let moves = (pose(), pose(), 1u32..100_000, 0.0..=1.0);
    for_all(
        5000,
        moves,
        |(from, to, ticks, fraction): (_, _, _, f64)| {
            let tick = (fraction * f64::from(ticks)).round() as u32;
            let rest = RestToRest::new(from, to, ticks, 0.01).at(tick);
            let hermite = Hermite::new(from, NO_VELOCITY, to, NO_VELOCITY, ticks, 0.01).at(tick);
            let duration = f64::from(ticks) * 0.01;
            let (ends, a, b) = (
                [coordinates(&from), coordinates(&to)],
                coordinates(&rest.pose),
                coordinates(&hermite.pose),
            );
            let u = f64::UNIT_ROUNDOFF;
            for i in 0..3 {
                let h = (ends[1][i] - ends[0][i]).abs();
                let pairs = [
                    (a[i], b[i], h + a[i].abs()),
                    (rest.velocity[i], hermite.velocity[i], 1.5 * h / duration),
                    (
                        rest.acceleration[i],
                        hermite.acceleration[i],
                        6.0 * h / (duration * duration),
                    ),
                ];
                for (rest, hermite, size) in pairs {
                    worst.borrow_mut().compare(
                        || format!("tick {tick} of {ticks}"),
                        hermite - rest,
                        8.0 * u * size,
                    );
                }
            }
        },
    );
    worst
        .into_inner()
        .assert_within("Hermite at rest", 0.2..=1.0);
}

/// A chain of 1000 moves around four corners stands where it stood, to the bit: there
/// is no sum over ticks or moves that could drift.
#[test]
fn a_long_chain_does_not_drift() {
    let corners = [
        Pose::from_f64(0.21, 0.22, 0.1),
        Pose::from_f64(0.28, 0.22, 0.2),
        Pose::from_f64(0.28, 0.28, -0.1),
        Pose::from_f64(0.21, 0.28, 0.0),
    ];
    let v = Vector3::new(0.05, -0.02, 0.3);
    let mut last: Option<Setpoint<f64>> = None;
    for lap in 0..1000usize {
        let (from, to) = (corners[lap % 4], corners[(lap + 1) % 4]);
        let ticks = 1 + (lap as u32 * 37) % 250;
        let job = Hermite::new(from, v, to, v, ticks, 0.01);
        let start = job.at(0);
        assert_eq!(start.pose, from);
        if let Some(last) = last {
            assert_eq!(last.pose, start.pose);
            assert!(
                (last.velocity - start.velocity)
                    .iter()
                    .all(|jump| jump.abs() < 1e-15)
            );
        }
        last = Some(job.at(ticks));
    }
    assert_eq!(last.expect("the last move").pose, corners[0]);
}

/// The longest move, 497 days at 100 Hz: the setpoints go on from tick to tick, forwards, and the
/// two halves meet in the middle.
#[test]
fn the_longest_move_goes_on() {
    let (from, to) = (Pose::from_f64(0.0, 0.0, 0.0), Pose::from_f64(1.0, 2.0, 3.0));
    let job = RestToRest::<f64>::new(from, to, u32::MAX, 0.01);
    let middle = u32::MAX / 2;
    for around in [1000, middle - 500, middle + 500, u32::MAX - 1000] {
        for tick in around - 400..around + 400 {
            let [a, b] = [tick, tick + 1].map(|tick| job.at(tick).pose.position);
            assert!(b.x >= a.x && b.y >= a.y, "backwards at {tick}");
            // At most 3 h / 2 T in a tick, and a rounding.
            assert!(
                (b - a).x <= 1.5 / f64::from(u32::MAX) + f64::EPSILON,
                "jump at {tick}"
            );
        }
    }
    let halves: [Vector2<f64>; 2] = [middle, middle + 1].map(|tick| job.at(tick).pose.position);
    assert!((halves[0] - Vector2::new(0.5, 1.0)).x.abs() < 1e-9);
    assert!((halves[1] - halves[0]).x > 0.0);
}

/// Seen from the other end, a move is the move back: poses and accelerations are equal to the bit,
/// velocities opposite.
#[test]
fn the_move_back_is_the_move_reversed() {
    for_all(
        3000,
        (pose(), pose(), 1u32..100_000, 0.0..=1.0),
        |(from, to, ticks, fraction): (_, _, _, f64)| {
            let tick = (fraction * f64::from(ticks)) as u32;
            let forth = RestToRest::new(from, to, ticks, 0.01).at(tick);
            let back = RestToRest::new(to, from, ticks, 0.01).at(ticks - tick);
            if 2 * tick != ticks {
                // In the very middle both are seen from their start.
                assert_eq!(forth.pose, back.pose);
            }
            assert_eq!(forth.velocity, -back.velocity);
            assert_eq!(forth.acceleration, back.acceleration);
        },
    );
}
