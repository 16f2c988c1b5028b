//! Motors on a job, against figures that are computed by hand.

use std::path::Path;
use trirrr_core::units::Units;
use trirrr_design::motors::{CatalogueMotor, GEAR_RATIOS, SHIPPED, candidates, read_catalogue};
use trirrr_scene::{JobPlayer, Scene, pipeline};

const MOTOR: &str = "[[motor]]
name = 'a'
supply_v = 24.0
torque_peak_nm = 2.0
torque_continuous_nm = 0.5
speed_no_load_rad_s = 100.0
rotor_inertia_kgm2 = 1e-4
source = 'here'
date = '2026-01-01'
";

fn one(text: &str) -> CatalogueMotor {
    read_catalogue(text).expect("a catalogue").remove(0)
}

#[test]
fn the_shipped_catalogue_has_sources() {
    let motors = read_catalogue(SHIPPED).expect("a catalogue");
    assert_eq!(motors.len(), 20);
    for motor in &motors {
        assert!(motor.source.starts_with("https://"), "{}", motor.name);
        assert_eq!(motor.date.len(), 10);
        assert!(motor.torque_at(0.0) > 0.0);
        assert_eq!(motor.torque_at(1.01 * motor.speed_no_load_rad_s), 0.0);
    }
}

#[test]
fn torque_falls_along_the_line_or_the_curve() {
    let line = one(MOTOR);
    assert_eq!(
        [0.0, 50.0, -50.0, 200.0].map(|speed| line.torque_at(speed)),
        [2.0, 1.0, 1.0, 0.0]
    );
    let curve = one(&format!(
        "{MOTOR}curve = [[0.0, 1.5], [20.0, 1.5], [60.0, 0.5]]"
    ));
    let found = [0.0, 20.0, 40.0, 60.0, 61.0].map(|speed| curve.torque_at(speed));
    assert_eq!(found, [1.5, 1.5, 1.0, 0.5, 0.0]);
}

/// The margins of one gear, worked out from the joints alone.
#[test]
fn margins_are_those_of_the_joints() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vertical.toml");
    let mut scene = Scene::read(file).expect("a scene");
    let motor = one(&MOTOR
        .replace(
            "torque_peak_nm = 2.0",
            "geared = true\ntorque_peak_nm = 20.0",
        )
        .replace("torque_continuous_nm = 0.5", "torque_continuous_nm = 5.0"));
    let [candidate] = &candidates(&scene, &[motor]).expect("a job")[..] else {
        panic!("not one");
    };
    // The core itself with these rotors.
    for leg in &mut scene.parameters.legs {
        leg.rotor_inertia_kgm2 = 1e-4;
    }
    let machine = pipeline::of_scene::<f64>(&scene, Units::SI).expect("a machine");
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let (mut least, mut squares, mut count) = (f64::INFINITY, [0.0; 3], 0.0);
    for setpoint in player.setpoints() {
        let record = machine.evaluate(0.0, &setpoint).expect("a pose");
        for (leg, square) in record.legs.iter().zip(&mut squares) {
            least = least.min(20.0 * (1.0 - leg.dth1.abs() / 100.0) / leg.torque.abs());
            *square += leg.torque * leg.torque;
        }
        count += 1.0;
    }
    let rms = squares
        .iter()
        .map(|sum: &f64| (sum / count).sqrt())
        .fold(0.0, f64::max);
    assert!(
        (candidate.peak_margin / least - 1.0).abs() < 1e-9,
        "{candidate:?} {least}"
    );
    assert!((candidate.heat_margin.expect("one") * rms / 5.0 - 1.0).abs() < 1e-9);
    assert_eq!(candidate.gear_ratio, 1.0);
}

#[test]
fn the_gear_that_leaves_the_most_is_taken_and_the_best_motor_comes_first() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vertical.toml");
    let scene = Scene::read(file).expect("a scene");
    let weak = MOTOR
        .replace("'a'", "'b'")
        .replace("peak_nm = 2.0", "peak_nm = 0.6");
    let motors = read_catalogue(&format!("{weak}\n{MOTOR}")).expect("two");
    let found = candidates(&scene, &motors).expect("a job");
    assert_eq!(
        found.iter().map(|each| each.motor).collect::<Vec<_>>(),
        [1, 0]
    );
    assert!(found[0].margin() > found[1].margin());
    assert!(GEAR_RATIOS.contains(&found[0].gear_ratio) && found[0].gear_ratio > 1.0);
    // Such a gear on a motor that is slow leaves nothing.
    let slow = one(&MOTOR.replace("= 100.0", "= 0.5"));
    let found = candidates(&scene, &[slow]).expect("a job");
    assert_eq!(
        (found[0].peak_margin, found[0].limited_by()),
        (0.0, "speed")
    );
}

#[test]
fn wrong_entries_are_refused_with_number_and_key() {
    for (from, to, parts) in [
        (
            "torque_peak_nm = 2.0",
            "torque_peak_nm = -2.0",
            ["motor[1] (a)", "torque_peak_nm = -2"],
        ),
        (
            "torque_peak_nm = 2.0",
            "torque_peak_nm = nan",
            ["motor[1]", "torque_peak_nm"],
        ),
        ("torque_peak_nm = 2.0\n", "", ["torque_peak_nm", "missing"]),
        ("torque_peak_nm", "torque_peak", ["torque_peak", "unknown"]),
        (
            "torque_continuous_nm = 0.5",
            "torque_continuous_nm = 5",
            ["motor[1]", "greater than torque_peak_nm"],
        ),
        (
            "rotor_inertia_kgm2 = 1e-4",
            "rotor_inertia_kgm2 = -1",
            ["motor[1]", "negative"],
        ),
        ("source = 'here'", "source = ' '", ["motor[1]", "source"]),
        (
            "date = '2026-01-01'",
            "date = '2026-01-01'\ncurve = [[2.0, 1.0], [1.0, 2.0]]",
            ["motor[1]", "rising"],
        ),
        ("name = 'a'", "name = 5", ["line 2", "string"]),
        ("[[motor]]", "[motor]", ["motor", "sequence"]),
    ] {
        let error = read_catalogue(&MOTOR.replace(from, to)).expect_err(to);
        for part in parts {
            assert!(error.contains(part), "{part:?} of {to} in {error}");
        }
    }
    assert!(
        read_catalogue("")
            .expect_err("none")
            .contains("no [[motor]]")
    );
    assert!(
        read_catalogue(&format!("{MOTOR}{MOTOR}"))
            .expect_err("two")
            .contains("another a")
    );
}
