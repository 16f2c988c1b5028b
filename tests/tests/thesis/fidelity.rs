//! What the program gets right.

use crate::{job, motion, program, state};
use trirrr_core::number::Arithmetic;
use trirrr_tests::bound::{Worst, angle_difference};
use trirrr_tests::machines;
use trirrr_tests::results;

/// C, theta_i1 and its rate. Both results are within a few u cond of the truth for the same state:
/// the core's within 2; the program's arccosine costs it some more.
#[test]
fn positions_motor_angles_and_motor_rates_match() {
    let parameters = machines::thesis();
    let mut worst = Worst::default();
    for row in program().rows() {
        let setpoint = state(row);
        let found =
            results::of_core(&parameters, &setpoint, &motion(&setpoint)).expect("finite results");
        let conditions = results::conditions(&parameters, &setpoint);
        for ((name, found), cond) in results::names().into_iter().zip(found).zip(conditions) {
            let leg = name.leg.map_or(0, |leg| leg + 1);
            let difference = match name.stem {
                "xc" | "yc" => found - row.number(&name.column()),
                "th1" => angle_difference(found, row.number(&format!("theta{leg}1"))),
                "dth1" => found - row.number(&format!("dtheta{leg}1")),
                _ => continue,
            };
            let bound = (2.0 + 4.0) * f64::UNIT_ROUNDOFF * cond;
            let place = || format!("{} at t={}", name.column(), row.text("t"));
            worst.compare(place, difference, bound);
        }
    }
    assert_eq!(worst.compared, 101 * 3 * 4);
    worst.assert_within("fidelity", 0.2..=1.0);
}

/// The trajectory. The program sums a0 + a2 t^2 + a3 t^3 at times of a rounded step: pose within a
/// few roundings of itself, velocity and acceleration of their greatest terms, 6 h and 12 h.
#[test]
fn the_trajectory_matches() {
    let mut worst = Worst::default();
    let job = job();
    let (start, end) = (job.at(0).pose, job.at(100).pose);
    let h = [
        end.position.x - start.position.x,
        end.position.y - start.position.y,
        end.angle - start.angle,
    ];
    for (tick, row) in (0..).zip(program().rows()) {
        let (ours, theirs) = (job.at(tick), state(row));
        let pairs = |i: usize| {
            let coordinate = |pose: &trirrr_core::setpoint::Pose<f64>| {
                [pose.position.x, pose.position.y, pose.angle][i]
            };
            [
                (
                    coordinate(&ours.pose),
                    coordinate(&theirs.pose),
                    coordinate(&ours.pose),
                ),
                (ours.velocity[i], theirs.velocity[i], 6.0 * h[i]),
                (ours.acceleration[i], theirs.acceleration[i], 12.0 * h[i]),
            ]
        };
        for i in 0..3 {
            for (ours, theirs, size) in pairs(i) {
                let bound = 4.0 * f64::UNIT_ROUNDOFF * size.abs();
                worst.compare(|| format!("coordinate {i} at {tick}"), ours - theirs, bound);
            }
        }
    }
    worst.assert_within("trajectory", 0.2..=1.0);
}

/// The inertial force and moment of the platform (4.12) to (4.14).
#[test]
fn the_platforms_inertial_forces_match() {
    let platform = machines::thesis().platform;
    for row in program().rows() {
        let a = state(row).acceleration;
        let expected = [
            -platform.mass_kg * a.x,
            -platform.mass_kg * a.y,
            -platform.inertia_kgm2 * a.z,
        ];
        for (column, expected) in ["Fin_x", "Fin_y", "Cin"].into_iter().zip(expected) {
            let error = (row.number(column) - expected).abs();
            assert!(
                error <= 4.0 * f64::UNIT_ROUNDOFF * expected.abs(),
                "{column}: {error}"
            );
        }
    }
}
