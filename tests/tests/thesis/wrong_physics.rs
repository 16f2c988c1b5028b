//! Errata 1 to 5: wrong physics.

use crate::{assert_figures, job, kinetic_power, motion, peaks, program, state, true_torques};
use core::f64::consts::PI;
use nalgebra::{Vector2, Vector3};
use trirrr_core::machine::{Elbow, Parameters};
use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_tests::bound::Worst;
use trirrr_tests::evaluate::evaluate;
use trirrr_tests::machines;
use trirrr_tests::results;
use trirrr_tests::table::Table;
use trirrr_tests::thesis_formula;

/// C_i in the file is what the formula gives, so that the formula stands for the program below.
/// Its only badly conditioned part is the motor's rate.
#[test]
fn erratum_1_the_formula_is_the_programs() {
    let mut compared = 0;
    for row in program().rows() {
        let formula = thesis_formula::torques(&machines::thesis(), &state(row));
        for (formula, file) in formula.into_iter().zip(row.three("C")) {
            assert_eq!(formula.is_nan(), file.is_nan());
            if !file.is_nan() {
                let size = file.abs().max(1e-3);
                assert!(
                    (formula - file).abs() <= 1e-13 * size,
                    "{formula} for {file}"
                );
                compared += 1;
            }
        }
    }
    assert_eq!(compared, 99 * 3);
}

/// Each C_i thetadot_i1 is the power of the whole platform: three equal curves, whose sum is
/// three times what the platform takes.
#[test]
fn erratum_1_every_motor_gets_the_whole_power() {
    let mut ratios = Vec::new();
    for (tick, row) in (0..).zip(program().rows()) {
        // At both ends the file has NaN, in the middle the power passes through zero.
        if [0, 50, 100].contains(&tick) {
            continue;
        }
        let power = kinetic_power(&state(row));
        let powers = row.three("P");
        for of_motor in powers {
            assert!(
                (of_motor / power - 1.0).abs() < 1e-13,
                "{of_motor} for {power}"
            );
        }
        ratios.push(powers.iter().sum::<f64>() / power);
    }
    assert_eq!(ratios.len(), 98);
    assert!(
        ratios.iter().all(|ratio| (ratio - 3.0).abs() < 1e-13),
        "{ratios:?}"
    );
}

/// The three powers of the true torque sum to the platform's power.
#[test]
fn erratum_1_the_true_powers_sum_to_the_platforms() {
    let parameters = machines::thesis();
    let mut worst = Worst::default();
    for row in program().rows() {
        let setpoint = state(row);
        let sum: f64 = motion(&setpoint)
            .powers()
            .expect("finite powers")
            .iter()
            .sum();
        let conditions = results::names()
            .into_iter()
            .zip(results::conditions(&parameters, &setpoint));
        let of_powers = conditions.filter(|(name, _)| name.stem == "P");
        let bound = 2.0 * f64::UNIT_ROUNDOFF * of_powers.map(|(_, cond)| cond).sum::<f64>();
        let place = || format!("t={}", row.text("t"));
        worst.compare(place, sum - kinetic_power(&setpoint), bound);
    }
    worst.assert_within("power", 0.02..=1.0);
}

#[test]
fn erratum_1_peaks_and_ratios() {
    let c: Vec<[f64; 3]> = program().rows().map(|row| row.three("C")).collect();
    let (inner, truth) = (&c[1..100], true_torques());
    assert_figures(peaks(inner), [0.15080, 0.10163, 0.05362], 5e-6);
    assert_figures(peaks(&truth), [0.019558, 0.015417, 0.039628], 5e-7);
    // Where both vanish, in the middle, there is no ratio.
    let ratios = |leg: usize| {
        let pairs = (1..100).filter(|&tick| tick != 50);
        let mut ratios: Vec<f64> = pairs.map(|tick| c[tick][leg] / truth[tick][leg]).collect();
        ratios.sort_by(f64::total_cmp);
        (ratios[0], ratios[97])
    };
    let [a, b, c] = [0, 1, 2].map(ratios);
    assert_figures([a.0, b.0, c.0], [6.163, 4.360, 1.381], 5e-4);
    assert_figures([a.1, b.1, c.1], [7.868, 6.727, 1.616], 5e-4);
}

/// 0/0 at both ends, where the true torque is finite and, at the end, at its peak.
#[test]
fn erratum_2_no_torque_at_rest() {
    for (tick, row) in (0..).zip(program().rows()) {
        let at_rest = tick == 0 || tick == 100;
        assert!(row.three("C").iter().all(|c| c.is_nan() == at_rest));
    }
    let truth = true_torques();
    assert_figures(truth[0], [0.012528697, 0.014246763, -0.029750897], 5e-10);
    assert_figures(truth[100], [-0.019558387, -0.015416587, 0.039628159], 5e-10);
    assert_eq!(peaks(&truth), truth[100].map(f64::abs));
}

/// With another duration the program's velocity at the end is no zero but rounding noise, and C
/// there a finite number that says nothing.
#[test]
fn erratum_2_noise_at_the_end_of_other_durations() {
    let (start, end) = (job().at(0).pose, job().at(100).pose);
    let mut finite = 0;
    for tenths in 1..=50 {
        let duration = f64::from(tenths) / 10.0;
        let x = thesis_formula::cubic(start.position.x, end.position.x, duration, duration);
        let y = thesis_formula::cubic(start.position.y, end.position.y, duration, duration);
        let alpha = thesis_formula::cubic(start.angle, end.angle, duration, duration);
        let setpoint = Setpoint {
            pose: Pose::from_f64(x[0], y[0], alpha[0]),
            velocity: Vector3::new(x[1], y[1], alpha[1]),
            acceleration: Vector3::new(x[2], y[2], alpha[2]),
        };
        let noise = setpoint.velocity.map(f64::abs);
        assert!(noise.x.max(noise.y).max(noise.z) < 1e-14, "{noise:?}");
        let c = thesis_formula::torques(&machines::thesis(), &setpoint);
        // Torque at the end goes with 1 / T^2.
        let truth = true_torques()[100].map(|torque| torque / (duration * duration));
        if c.iter().all(|c| c.is_finite()) {
            finite += 1;
            assert!(
                (c[0] / truth[0] - 1.0).abs() > 0.5,
                "{c:?} {truth:?} at {duration}"
            );
        }
    }
    assert_eq!(finite, FINITE_ENDS, "of 50 durations");
}

/// Durations of 0.1, 0.2 ... 5.0 s for which C(T) is a finite number.
const FINITE_ENDS: usize = 35;

/// "Velocity ratios depend on position only": in one pose, two directions of motion.
#[test]
fn erratum_3_velocity_ratios_depend_on_the_velocity() {
    let ratio = |velocity: Vector3<f64>| {
        let setpoint = Setpoint {
            velocity,
            ..job().at(50)
        };
        velocity.x / thesis_formula::leg(&machines::thesis().legs[0], &setpoint).rates[0]
    };
    let (along_x, across) = (
        ratio(Vector3::new(0.1, 0.0, 0.0)),
        ratio(Vector3::new(0.1, 0.1, 0.0)),
    );
    assert!((across / along_x - 1.0).abs() > 0.2, "{along_x} {across}");
}

/// Near a reversal of motor 1, C_1 grows as one over its rate; the true torque does not notice.
/// State: tick 64 of the move, with the velocity changed along distal link 1 alone.
#[test]
fn erratum_3_c_is_unbounded_at_a_motor_reversal() {
    let at = |rate: f64| {
        let mut setpoint = job().at(64);
        let now = motion(&setpoint);
        let links = now.legs[0].position.links;
        let missing = (rate - now.motors[0].rate) * links.r1_cross_r2 / links.r2.dot(&links.r2);
        setpoint.velocity += Vector3::new(links.r2.x * missing, links.r2.y * missing, 0.0);
        let motor = motion(&setpoint).motors[0];
        assert!((motor.rate - rate).abs() < 1e-15);
        (
            thesis_formula::torques(&machines::thesis(), &setpoint)[0],
            motor.torque,
        )
    };
    for (rate, size) in [(1e-3, 1.0), (1e-6, 1e3), (1e-9, 1e6)] {
        let (c, torque) = at(rate);
        assert!((torque + 0.00502).abs() < 5e-6, "{torque}");
        assert!(c.abs() > size, "{c} at {rate}");
        // The two sides of the reversal have opposite signs.
        assert!(at(-rate).0 * c < 0.0);
    }
}

#[test]
fn erratum_4_link_masses_are_not_negligible() {
    let of = |file: &str| -> Vec<[f64; 3]> {
        Table::read(file)
            .rows()
            .map(|row| row.three("tau"))
            .collect()
    };
    let (without, with) = (of("true_massless.csv"), of("true_links.csv"));
    let changes: Vec<[f64; 3]> = without
        .iter()
        .zip(&with)
        .map(|(a, b)| core::array::from_fn(|leg| b[leg] - a[leg]))
        .collect();
    let (changes, peaks) = (peaks(&changes), peaks(&without));
    let shares = core::array::from_fn(|leg| 100.0 * changes[leg] / peaks[leg]);
    assert_figures(shares, [28.0, 39.0, 23.7], 0.05);

    // The core says the same of its own.
    let rods = machines::with_rods(machines::thesis(), 0.05);
    let own: Vec<[f64; 3]> = (0..=100)
        .map(|tick| {
            let torques = |parameters: &Parameters| {
                evaluate(parameters, &job().at(tick))
                    .expect("in reach")
                    .motors
                    .map(|m| m.torque)
            };
            let (with, without) = (torques(&rods), torques(&machines::thesis()));
            core::array::from_fn(|leg| with[leg] - without[leg])
        })
        .collect();
    assert_figures(crate::peaks(&own), changes, 1e-15);
}

/// A pose has two elbows for each leg: eight working modes, not infinitely many.
#[test]
fn erratum_5_a_pose_has_eight_working_modes() {
    let setpoint = job().at(50);
    let mut found: Vec<[f64; 3]> = Vec::new();
    for mode in 0..8 {
        let mut parameters = machines::thesis();
        for (index, leg) in parameters.legs.iter_mut().enumerate() {
            leg.elbow = if mode >> index & 1 == 0 {
                Elbow::Positive
            } else {
                Elbow::Negative
            };
        }
        let motion = evaluate(&parameters, &setpoint).expect("in reach in every mode");
        found.push(motion.motors.map(|motor| motor.angle));
    }
    for (i, a) in found.iter().enumerate() {
        assert!(found[..i].iter().all(|b| a != b), "mode {i}");
    }
    // All directions of a proximal link tried: the distal link fits at two of them.
    let motion = motion(&setpoint);
    for (leg, parameters) in motion.legs.iter().zip(&machines::thesis().legs) {
        let links = leg.position.links;
        let gap = |step: u32| {
            let (sin, cos) = (f64::from(step) * 2.0 * PI / 3600.0).sin_cos();
            let elbow = Vector2::new(cos, sin) * parameters.proximal_m;
            let distal = links.r1 + links.r2 - elbow;
            distal.dot(&distal) - parameters.distal_m.powi(2)
        };
        let changes = (0..3600)
            .filter(|&step| gap(step) * gap(step + 1) < 0.0)
            .count();
        assert_eq!(changes, 2);
    }
}
