//! Motors on a job, against figures that are computed by hand.

use std::path::Path;
use trirrr_core::units::Units;
use trirrr_design::motors::{CatalogueMotor, GEAR_RATIOS, JobLoad, SHIPPED, read_catalogue};
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
    assert_eq!(motors.len(), 26);
    for motor in &motors {
        assert!(motor.source.starts_with("https://"), "{}", motor.name);
        assert_eq!(motor.date.len(), 10);
        assert!(motor.torque_at(0.0) > 0.0);
        let left = motor.torque_at(1.01 * motor.no_load_rad_s());
        assert!(left < 0.01 * motor.torque_peak_nm, "{}", motor.name);
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
        .replace("torque_continuous_nm = 0.5", "torque_continuous_nm = 5.0")
        .replace("1e-4", "2.0"));
    let [candidate] = &JobLoad::of(&scene).expect("a job").candidates(&[motor])[..] else {
        panic!("not one");
    };
    // The core itself with these rotors.
    for leg in &mut scene.parameters.legs {
        leg.rotor_inertia_kgm2 = 2.0;
    }
    let machine = pipeline::of_scene::<f64>(&scene, Units::SI).expect("a machine");
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let (mut least, mut squares, mut count) = (f64::INFINITY, [0.0; 3], 0.0);
    let mut back_j = 0.0;
    for setpoint in player.setpoints() {
        let record = machine.evaluate(0.0, &setpoint).expect("a pose");
        for (leg, square) in record.legs.iter().zip(&mut squares) {
            back_j += (-leg.torque * leg.dth1).max(0.0) * scene.period_s();
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
    let told_j = candidate.regenerated_j.expect("a known rotor");
    assert!((told_j / back_j - 1.0).abs() < 1e-9, "{told_j} {back_j}");
    assert!(
        (5.0..20.0).contains(&told_j),
        "without a rotor 4.128: {told_j}"
    );
}

/// A rotor of unknown inertia weighs nothing in the margins: they say too much, and the more so the higher the gear.
#[test]
fn what_depends_on_an_unknown_inertia_is_unknown() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vertical.toml");
    let scene = Scene::read(file).expect("a scene");
    let load = JobLoad::of(&scene).expect("a job");
    let unknown = MOTOR
        .replace("rotor_inertia_kgm2 = 1e-4\n", "")
        .replace("'a'", "'b'");
    let motors = read_catalogue(&format!("{unknown}\n{MOTOR}")).expect("two");
    let [known, other] = &load.candidates(&motors)[..] else {
        panic!("not two");
    };
    assert_eq!((known.motor, other.motor), (1, 0));
    assert!(other.margin() >= 1.0 && known.regenerated_j.is_some());
    assert_eq!((other.inertia_ratio, other.regenerated_j), (None, None));
    assert_eq!(load.least_time_s(&motors[0], other.gear_ratio), None);
    // A lower gear does not do the job.
    let lower = GEAR_RATIOS.iter().filter(|gear| **gear < other.gear_ratio);
    for gear in lower {
        let points = load.rotor_points(&motors[0], *gear);
        let does = |[speed, torque]: &[f64; 2]| motors[0].torque_at(*speed) >= torque.abs();
        let square = |motor: usize| {
            points
                .iter()
                .skip(motor)
                .step_by(3)
                .map(|[_, torque]| torque * torque)
        };
        let ticks = points.len() as f64 / 3.0;
        let rms = [0, 1, 2].map(|motor| (square(motor).sum::<f64>() / ticks).sqrt());
        let is_hot = rms.iter().any(|rms| *rms > 0.5);
        assert!(is_hot || !points.iter().all(does), "{gear}");
    }
}

#[test]
fn the_gear_that_leaves_the_most_is_taken_and_the_best_motor_comes_first() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vertical.toml");
    let scene = Scene::read(file).expect("a scene");
    let weak = MOTOR
        .replace("'a'", "'b'")
        .replace("peak_nm = 2.0", "peak_nm = 0.6");
    let motors = read_catalogue(&format!("{weak}\n{MOTOR}")).expect("two");
    let load = JobLoad::of(&scene).expect("a job");
    let found = load.candidates(&motors);
    assert_eq!(
        found.iter().map(|each| each.motor).collect::<Vec<_>>(),
        [1, 0]
    );
    assert!(found[0].margin() > found[1].margin());
    assert!(GEAR_RATIOS.contains(&found[0].gear_ratio) && found[0].gear_ratio > 1.0);
    // Such a gear on a motor that is slow leaves nothing.
    let slow = one(&MOTOR.replace("= 100.0", "= 0.5"));
    let found = load.candidates(&[slow]);
    assert_eq!(
        (found[0].peak_margin, found[0].limited_by()),
        (0.0, "speed")
    );
}

/// By the figures of a motor whose impedance is easy: R = 3 ohm, and p w L = 4 ohm at 8 rad/s.
#[test]
fn a_stepper_gives_what_its_voltage_drives_into_the_winding() {
    let text = MOTOR.replace(
        "speed_no_load_rad_s = 100.0",
        "stepper = { resistance_ohm = 3.0, inductance_h = 0.01, current_a = 2.0, steps_per_rev = 200 }",
    );
    let motor = one(&text);
    assert_eq!(motor.torque_at(0.0), 2.0);
    // k = 2 N m / (sqrt(2) 2 A); Z = 5 ohm; T = k V / Z - k^2 w R / Z^2.
    let k = 1.0 / 2.0_f64.sqrt();
    let expected = k * 24.0 / 5.0 - k * k * 8.0 * 3.0 / 25.0;
    assert_eq!(motor.torque_at(8.0), expected.min(2.0));
    let slow = motor.at_supply(10.0);
    let expected = k * 10.0 / 5.0 - k * k * 8.0 * 3.0 / 25.0;
    assert!((slow.torque_at(8.0) - expected).abs() < 1e-12);
    assert_eq!(slow.curve_source(), "estimated");
    assert!(slow.no_load_rad_s() < motor.no_load_rad_s());
    // An independent way: the phasor of the current at each load angle, and the torque of both phases.
    let mut most = f64::NEG_INFINITY;
    for step in 0..100_000 {
        let angle = f64::from(step) / 100_000.0 * std::f64::consts::TAU;
        let (real, imaginary) = (10.0 * angle.cos() - k * 8.0, 10.0 * angle.sin());
        // In phase with the voltage of the rotor: the real part of (V - E) / (R + i X).
        most = most.max(k * (real * 3.0 + imaginary * 4.0) / 25.0);
    }
    assert!((slow.torque_at(8.0) / most - 1.0).abs() < 1e-6, "{most}");
}

#[test]
fn a_brushless_motor_has_the_line_of_its_winding_at_any_supply() {
    let text = MOTOR.replace(
        "speed_no_load_rad_s = 100.0",
        "brushless = { resistance_ohm = 0.5, torque_constant_nm_a = 0.1, pole_pairs = 7 }",
    );
    let motor = one(&text);
    // 240 rad/s without load; 0.1 (24 - 0.1 w) / 0.5, at most 2 N m.
    assert!((motor.no_load_rad_s() / 240.0 - 1.0).abs() < 0.01);
    let found = [0.0, 140.0, 190.0, 241.0].map(|speed| motor.torque_at(speed));
    for (found, expected) in found.iter().zip([2.0, 2.0, 1.0, 0.0]) {
        assert!((found - expected).abs() < 1e-12, "{found} {expected}");
    }
    assert!((motor.at_supply(48.0).torque_at(430.0) - 1.0).abs() < 1e-12);
    // A motor without a winding stays as its maker describes it.
    assert_eq!(one(MOTOR).at_supply(48.0), one(MOTOR));
}

/// The supply that is said to be needed is the one at which the job just goes.
#[test]
fn the_supply_that_is_needed_is_the_least_that_does_the_job() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vertical.toml");
    let scene = Scene::read(file).expect("a scene");
    let load = JobLoad::of(&scene).expect("a job");
    for winding in [
        "brushless = { resistance_ohm = 0.5, torque_constant_nm_a = 0.1, pole_pairs = 7 }",
        "stepper = { resistance_ohm = 0.3, inductance_h = 1e-3, current_a = 4.0, steps_per_rev = 200 }",
    ] {
        let motor = one(&MOTOR.replace("speed_no_load_rad_s = 100.0", winding));
        let [found] = &load.candidates(std::slice::from_ref(&motor))[..] else {
            panic!("not one");
        };
        let needed = found.supply_needed_v.expect("a supply");
        let gear = found.gear_ratio;
        let goes = |supply: f64| {
            let motor = motor.at_supply(supply);
            let points = load.rotor_points(&motor, gear);
            points
                .iter()
                .all(|[speed, torque]| motor.torque_at(*speed) >= torque.abs())
        };
        assert!(goes(1.001 * needed) && !goes(0.999 * needed), "{found:?}");
    }
}

/// Played in the least time, the job takes all that the motor has: by the core, on the scene itself with other durations.
#[test]
fn moves_in_the_least_time_are_at_a_limit_of_the_motor() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/vertical.toml");
    let scene = Scene::read(file).expect("a scene");
    let load = JobLoad::of(&scene).expect("a job");
    let motor = one(MOTOR);
    let [found] = &load.candidates(std::slice::from_ref(&motor))[..] else {
        panic!("not one");
    };
    let gear = found.gear_ratio;
    let least = load.least_time_s(&motor, gear).expect("a time");
    let own = f64::from(scene.ticks()) * scene.period_s();
    let factor = least / own;
    let mut bare = scene.parameters;
    for leg in &mut bare.legs {
        leg.rotor_inertia_kgm2 = 1e-4 * gear * gear;
    }
    let machine = pipeline::build_in::<f64>(&bare, Units::SI).expect("a machine");
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let (mut margin, mut squares, mut count) = (f64::INFINITY, [0.0; 3], 0.0);
    for mut setpoint in player.setpoints() {
        setpoint.velocity /= factor;
        setpoint.acceleration /= factor * factor;
        let record = machine.evaluate(0.0, &setpoint).expect("a pose");
        for (leg, square) in record.legs.iter().zip(&mut squares) {
            let own = leg.torque / gear;
            margin = margin.min(motor.torque_at(gear * leg.dth1) / own.abs());
            *square += own * own;
        }
        count += 1.0;
    }
    let rms = squares
        .map(|sum: f64| (sum / count).sqrt())
        .into_iter()
        .fold(0.0, f64::max);
    let margin = margin.min(0.5 / rms);
    assert!((margin - 1.0).abs() < 1e-3, "{margin} {factor}");
    // A motor that cannot hold the machine has no time.
    let weak = one(&MOTOR
        .replace("peak_nm = 2.0", "peak_nm = 0.01")
        .replace("continuous_nm = 0.5", "continuous_nm = 0.01"));
    assert_eq!(load.least_time_s(&weak, 1.0), None);
}

/// A path is planned with the motor in place of the scene's limits: with the limits of the scene as those of a motor, about as long.
#[test]
fn a_path_is_planned_with_the_rates_and_torques_of_the_motor() {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes/paths/pick.toml");
    let scene = Scene::read(file).expect("a scene");
    let load = JobLoad::of(&scene).expect("a job");
    let motor = |torque: f64, speed: f64| {
        let curve = format!("curve = [[0.0, {torque}], [{speed}, {torque}]]");
        let text = MOTOR
            .replace("speed_no_load_rad_s = 100.0", &curve)
            .replace("rotor_inertia_kgm2 = 1e-4", "rotor_inertia_kgm2 = 0.0")
            .replace(
                "torque_peak_nm = 2.0",
                &format!("torque_peak_nm = {torque}"),
            )
            .replace("torque_continuous_nm = 0.5\n", "");
        one(&text)
    };
    let time = |torque, speed| load.least_time_s(&motor(torque, speed), 1.0);
    let (strong, weak) = (time(2.0, 20.0), time(0.02, 20.0));
    let (strong, weak) = (strong.expect("a time"), weak.expect("a time"));
    let slow = time(2.0, 2.0).expect("a time");
    assert!(strong < weak && strong < slow, "{strong} {weak} {slow}");
    // A dwell of 0.1 s stays.
    assert!(strong > 0.1);
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
        (
            "speed_no_load_rad_s = 100.0",
            "",
            ["motor[1] (a)", "speed_no_load_rad_s: missing"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "brushless = { resistance_ohm = 0.0, torque_constant_nm_a = 0.1, pole_pairs = 7 }",
            ["motor[1] (a)", "brushless.resistance_ohm = 0"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "brushless = { resistance_ohm = 0.1, torque_constant_nm_a = nan, pole_pairs = 7 }",
            ["motor[1] (a)", "brushless.torque_constant_nm_a"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "brushless = { resistance_ohm = 0.1, torque_constant_nm_a = 0.1, pole_pairs = 0 }",
            ["motor[1] (a)", "brushless.pole_pairs = 0"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "brushless = { resistance_ohm = 0.1, torque_constant_nm_a = 0.1, pole_pairs = 7.5 }",
            ["pole_pairs", "7.5"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "stepper = { resistance_ohm = 1, inductance_h = -1, current_a = 1, steps_per_rev = 200 }",
            ["motor[1] (a)", "stepper.inductance_h = -1"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "stepper = { resistance_ohm = 1, inductance_mh = 1, current_a = 1, steps_per_rev = 200 }",
            ["inductance_mh", "unknown"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "stepper = { resistance_ohm = 1, inductance_h = 1, current_a = 0, steps_per_rev = 200 }",
            ["motor[1] (a)", "stepper.current_a = 0"],
        ),
        (
            "rotor_inertia_kgm2",
            "stepper = { resistance_ohm = 1, inductance_h = 1, current_a = 1, steps_per_rev = 200 }\nrotor_inertia_kgm2",
            ["motor[1] (a)", "speed_no_load_rad_s: follows from stepper"],
        ),
        (
            "speed_no_load_rad_s = 100.0",
            "curve = [[0.0, 1.0], [9.0, 0.0]]\nstepper = { resistance_ohm = 1, inductance_h = 1, current_a = 1, steps_per_rev = 200 }",
            [
                "motor[1] (a)",
                "stepper: the torque over the speed is given by curve",
            ],
        ),
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
