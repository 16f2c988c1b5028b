//! The machine under torques from outside.

use trirrr_plant::moved::MovedMachine;
use trirrr_scene::Scene;

fn scene() -> Scene {
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../scenes/plant-odrive.toml"
    );
    Scene::read(file).unwrap()
}

/// Angles after `seconds` in so many stretches of a torque at joint 1.
fn turned(torque: f64, seconds: f64, stretches: u32) -> [f64; 3] {
    let mut machine = MovedMachine::build(&scene()).unwrap();
    let start = machine.angles();
    for _ in 0..stretches {
        let part = seconds / f64::from(stretches);
        machine.advance([torque, 0.0, 0.0], part).unwrap();
    }
    let end = machine.angles();
    [0, 1, 2].map(|leg| end[leg] - start[leg])
}

#[test]
fn friction_holds_a_machine_that_nothing_drives() {
    // The Coulomb friction of a motor is 0.02 N m. A joint that sticks creeps.
    for (torque, most) in [(0.0, 1e-9), (0.01, 1e-4)] {
        for turned in turned(torque, 0.1, 10) {
            assert!(turned.abs() < most, "{torque}: {turned}");
        }
    }
}

#[test]
fn a_torque_turns_its_joint_however_the_time_is_cut() {
    let once = turned(0.5, 0.05, 1);
    let often = turned(0.5, 0.05, 400);
    assert!(once[0] > 0.01, "{once:?}");
    for (once, often) in once.into_iter().zip(often) {
        assert!((once - often).abs() < 1e-6, "{once} {often}");
    }
    assert!(turned(-0.5, 0.05, 1)[0] < -0.01);
}
