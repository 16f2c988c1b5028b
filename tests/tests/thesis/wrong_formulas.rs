//! Errata 6 to 10: wrong formulas.

use crate::{assert_figures, job, motion, program, state};
use core::f64::consts::PI;
use nalgebra::Vector2;
use trirrr_core::number::Arithmetic;
use trirrr_tests::bound::angle_difference;
use trirrr_tests::machines;
use trirrr_tests::results;
use trirrr_tests::thesis_formula::{self, inertial_load, inertial_load_printed};

/// (3.9): theta_i2 is C -> B, off by pi; its rate then has the wrong sign.
#[test]
fn erratum_6_the_distal_link_points_backwards() {
    let parameters = machines::thesis();
    for row in program().rows() {
        let setpoint = state(row);
        let motion = motion(&setpoint);
        let conditions = results::conditions(&parameters, &setpoint);
        for (index, leg) in motion.legs.iter().enumerate() {
            let bound = |stem: &str| {
                let mut names = results::names().into_iter().zip(&conditions);
                let (_, cond) = names
                    .find(|(name, _)| name.stem == stem && name.leg == Some(index))
                    .expect("a result");
                6.0 * f64::UNIT_ROUNDOFF * cond
            };
            let column = |stem: &str| row.number(&format!("{stem}{}2", index + 1));
            let off = angle_difference(column("theta"), leg.position.distal_angle());
            assert!((off.abs() - PI).abs() <= bound("th2"), "{off}");
            let sum = column("dtheta") + leg.rates.distal;
            assert!(sum.abs() <= bound("dth2"), "{sum}");
        }
    }
}

/// (3.18) to (3.21) with that angle: the centripetal term of link 2 has the wrong sign.
#[test]
fn erratum_6_the_accelerations_are_wrong() {
    let mut worst = [0.0f64; 3];
    for tick in 0..=100 {
        let setpoint = job().at(tick);
        for (index, motor) in motion(&setpoint).motors.iter().enumerate() {
            let theirs = thesis_formula::leg(&machines::thesis().legs[index], &setpoint);
            worst[index] = worst[index].max((theirs.accelerations[0] - motor.acceleration).abs());
        }
    }
    let most = worst.into_iter().fold(0.0, f64::max);
    assert!((most - 0.65).abs() < 0.005, "{worst:?}");
}

/// (3.14) has -1/det J where it is +1/det J. With theta_i2 off by pi as well, the two errors cancel
/// in thetadot_i2 and leave thetadot_i1 wrong.
#[test]
fn erratum_7_sign_of_the_inverse() {
    for tick in 1..100 {
        let setpoint = job().at(tick);
        for (index, leg) in motion(&setpoint).legs.iter().enumerate() {
            let [proximal, distal] =
                thesis_formula::leg(&machines::thesis().legs[index], &setpoint).rates_printed;
            assert!((proximal + leg.rates.proximal).abs() < 1e-14);
            assert!((distal - leg.rates.distal).abs() < 1e-14);
        }
    }
}

/// (3.18) to (3.21) print Z_i1 cos theta_i2 for Z_i2 cos theta_i2: nothing as long as the two links
/// are equally long, as in the thesis.
#[test]
fn erratum_7_length_in_the_centripetal_term() {
    let difference = |distal_m: f64| {
        let mut leg = machines::thesis().legs[0];
        leg.distal_m = distal_m;
        let found = thesis_formula::leg(&leg, &job().at(50));
        (found.accelerations[0] - found.accelerations_printed[0]).abs()
    };
    assert_eq!(difference(0.2), 0.0);
    assert!(difference(0.25) > 1e-3, "{}", difference(0.25));
}

/// (4.6) against the second derivative of a link's motion, by central differences of a path whose
/// fourth derivatives are about 10: truncation at a step of 1e-4 is 1e-8.
#[test]
fn erratum_8_inertial_load_of_a_link() {
    let link @ [m, inertia, s] = [0.05, 0.05 * 0.04 / 12.0, 0.1];
    let angle = |t: f64| 0.4 + 0.7 * t + 0.55 * t * t;
    let joint = |t: f64| Vector2::new(0.1 + 0.2 * t * t, 0.3 - 0.4 * t * t);
    let centre = |t: f64| joint(t) + Vector2::new(angle(t).cos(), angle(t).sin()) * s;
    let h = 1e-4;
    let acceleration = (centre(h) - centre(0.0) * 2.0 + centre(-h)) / (h * h);
    let arm = centre(0.0) - joint(0.0);
    let truth = [
        m * acceleration.x,
        m * acceleration.y,
        m * arm.perp(&acceleration) + inertia * 1.1,
    ];
    let (of_joint, of_angle) = ([0.4, -0.8], [0.4, 0.7, 1.1]);
    assert_figures(inertial_load(link, of_joint, of_angle), truth, 1e-8);
    let printed = inertial_load_printed(link, of_joint, of_angle);
    assert!(
        (printed[0] - truth[0]).abs() < 1e-8,
        "F_x is right as printed"
    );
    assert!(
        (printed[1] - truth[1]).abs() > 0.1 * truth[1].abs(),
        "F_y is not"
    );
    assert!(
        (printed[2] - truth[2]).abs() > 0.1 * truth[2].abs(),
        "M is not"
    );
}

/// (3.4): the arctangent of a quotient cannot tell C - A from A - C.
#[test]
fn erratum_9_arctangent_of_a_quotient() {
    let mut off = [0; 3];
    for row in program().rows() {
        for (index, off) in off.iter_mut().enumerate() {
            let leg = thesis_formula::leg(&machines::thesis().legs[index], &state(row));
            let difference = (leg.theta_ac_printed - leg.theta_ac).abs();
            assert!(difference < 1e-15 || (difference - PI).abs() < 1e-15);
            *off += u32::from(difference > 1.0);
        }
    }
    assert_eq!(off, [0, 101, 52]);
}

/// "(cm, rad)" in the listing: h = 0.02 is metres, as its own platform joints show.
#[test]
fn erratum_10_the_platform_radius_is_in_metres() {
    for row in program().rows() {
        for leg in 1..=3 {
            let x = row.number(&format!("xc{leg}")) - row.number("xd");
            let y = row.number(&format!("yc{leg}")) - row.number("yd");
            assert!((x.hypot(y) - 0.02).abs() < 1e-15);
        }
    }
}
