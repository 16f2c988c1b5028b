//! A calibration that is sent to a board.

use crate::common::{Asker, Device, scene, stream, text, ticks, trirrr};
use serde_json::Value;
use std::process::Output;
use tempfile::TempDir;
use trirrr_client::local;
use trirrr_core::forward::Forward;
use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_protocol::message::scene::{Leg, Limits, Section, SectionName};
use trirrr_protocol::message::{Command, Reply};
use trirrr_scene::{Scene, pipeline};

const TABLE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../scenes/measurements/thesis.csv"
);

fn calibrate(folder: &TempDir, port: &str, more: &[&str]) -> Output {
    let mut command = trirrr();
    command.args(["calibrate", "scene.toml", TABLE, "--port", port, "--json"]);
    command.args(more).current_dir(folder).output().unwrap()
}

/// Motor angles of each row of a table.
fn angles(table: &str) -> Vec<[f64; 3]> {
    let mut lines = table.lines();
    let names: Vec<&str> = lines.next().unwrap().split(',').collect();
    let places = ["th1_1", "th1_2", "th1_3"]
        .map(|name| names.iter().position(|other| *other == name).unwrap());
    let row = |line: &str| {
        let cells: Vec<&str> = line.split(',').collect();
        places.map(|place| cells[place].parse().unwrap())
    };
    lines.map(row).collect()
}

#[test]
fn a_board_with_the_calibrated_legs_moves_as_an_image_of_the_calibrated_scene() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);

    // Another scene than the board's: nothing is sent and nothing written.
    let other = ["--joints-placed", "--set", "platform.mass_kg=0.6"];
    let other = calibrate(&folder, &device.address, &other);
    let why = text(&other.stderr);
    assert_eq!(other.status.code(), Some(2), "{why}");
    assert!(why.contains("built for another scene"), "{why}");
    assert!(!folder.path().join("out").exists());

    // A machine that is off knows no pose.
    let off = calibrate(&folder, &device.address, &["--joints-placed"]);
    let why = text(&off.stderr);
    assert_eq!(off.status.code(), Some(2), "{why}");
    assert!(why.contains("disabled (`trirrr enable`"), "{why}");
    enable(&folder, &device);

    let sent = calibrate(&folder, &device.address, &["--joints-placed"]);
    assert!(sent.status.success(), "{}", text(&sent.stderr));
    let found: Value = serde_json::from_slice(&sent.stdout).unwrap();
    let board = &found["board"];
    assert_eq!(board["offsets_rad"], serde_json::json!([0.0, 0.0, 0.0]));
    // Motors that stand still hold the platform elsewhere than the nominal legs say: by about what the parts are off.
    let at = |name: &str, axis: usize| board[name][axis].as_f64().unwrap();
    let way = (at("stands", 0) - at("stood", 0)).hypot(at("stands", 1) - at("stood", 1));
    assert!((1e-4..5e-3).contains(&way), "{board}");

    plays_as_calibrated(&folder, &device);
}

/// The job of the nominal scene is in poses: the board finds the angles, those of an image of the calibrated scene.
fn plays_as_calibrated(folder: &TempDir, device: &Device) {
    let streamed = stream(folder, &device.address, &[]);
    assert!(streamed.status.success(), "{}", text(&streamed.stderr));
    let copy = "out/thesis-calibration/scene.toml";
    let run = trirrr()
        .args(["run", copy, "--fast", "--out", "wanted"])
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", text(&run.stderr));
    let nominal = angles(&crate::common::run(folder));
    let (found, wanted) = (
        angles(&ticks(&folder.path().join("out"))),
        angles(&ticks(&folder.path().join("wanted"))),
    );
    assert_eq!(found.len(), wanted.len());
    for ((found, wanted), nominal) in found.iter().zip(&wanted).zip(&nominal) {
        for motor in 0..3 {
            // The copy of the scene has 12 digits.
            assert!((found[motor] - wanted[motor]).abs() < 1e-9);
        }
        let most = (0..3).map(|motor| (found[motor] - nominal[motor]).abs());
        assert!(most.fold(0.0, f64::max) > 1e-4);
    }
}

/// The machine of the measurements has encoders that are off: the board counts on from other angles, and goes to the job's start by them.
#[test]
fn a_board_takes_the_encoder_offsets_too() {
    let folder = scene("thesis", &[]);
    let device = Device::start(&folder, &[]);
    enable(&folder, &device);
    let sent = calibrate(&folder, &device.address, &[]);
    assert!(sent.status.success(), "{}", text(&sent.stderr));
    let found: Value = serde_json::from_slice(&sent.stdout).unwrap();
    let three = |value: &Value| [0, 1, 2].map(|index| value[index].as_f64().unwrap());
    let board = &found["board"];
    let offsets = three(&board["offsets_rad"]);
    assert_eq!(offsets, three(&found["calibration"]["offsets_rad"]));
    assert!(offsets.iter().all(|offset| offset.abs() > 1e-4));

    // No motor has moved, and each stands at another angle.
    let own = Scene::read(folder.path().join("scene.toml")).unwrap();
    let copy = Scene::read(folder.path().join("out/thesis-calibration/scene.toml")).unwrap();
    let angles_at = |machine: &Parameters, [x, y, alpha]: [f64; 3]| {
        let geometry = Geometry::<f64>::build(machine).unwrap();
        geometry.motor_angles(&geometry.position(&Pose::from_f64(x, y, alpha)).unwrap())
    };
    let before = angles_at(&own.parameters, three(&board["stood"]));
    let after = angles_at(&copy.parameters, three(&board["stands"]));
    for motor in 0..3 {
        let turned = after[motor] - before[motor];
        assert!((turned - offsets[motor]).abs() < 1e-9, "{motor}: {turned}");
    }
    plays_as_calibrated(&folder, &device);
}

fn enable(folder: &TempDir, device: &Device) {
    let port = ["enable", "scene.toml", "--port", &device.address];
    let on = trirrr().args(port).current_dir(folder).output().unwrap();
    assert!(on.status.success(), "{}", text(&on.stderr));
}

/// Torques that hold a machine at rest where its motors stand at `angles`.
fn standing_torques(machine: &Parameters, angles: &[f64; 3], guess: Pose<f64>) -> [f64; 3] {
    let geometry = Geometry::<f64>::build(machine).unwrap();
    let forward = Forward::build(machine, &geometry);
    let pose = forward.solve(angles, guess, 32).unwrap().pose;
    let at_rest = Setpoint {
        pose,
        velocity: [0.0; 3].into(),
        acceleration: [0.0; 3].into(),
    };
    let tick = pipeline::build::<f64>(machine).unwrap();
    tick.motors(&at_rest)
        .unwrap()
        .map(|motor| motor.torque.abs())
}

/// The least limits of torque that a machine with its first two calibrated legs keeps where it stands, and with all three does not.
fn limits_between(own: &Parameters, calibrated: &Parameters, start: Pose<f64>) -> Option<[f64; 3]> {
    let geometry = Geometry::<f64>::build(own).unwrap();
    let angles = geometry.motor_angles(&geometry.position(&start).unwrap());
    let mut machine = *own;
    let mut kept = standing_torques(&machine, &angles, start);
    for leg in 0..2 {
        machine.legs[leg] = calibrated.legs[leg];
        let torques = standing_torques(&machine, &angles, start);
        kept = [0, 1, 2].map(|motor| f64::max(kept[motor], torques[motor]));
    }
    let last = standing_torques(calibrated, &angles, start);
    let beyond = (0..3).find(|&motor| last[motor] > kept[motor] * 1.0001)?;
    let mut limits = [1.0; 3];
    limits[beyond] = 0.5 * (kept[beyond] + last[beyond]);
    Some(limits)
}

/// A load stands on the platform, and the motor that it loads most may not do more than the first two calibrated legs ask of it.
#[test]
fn a_board_that_refuses_a_leg_has_its_own_legs_again() {
    let made = scene("thesis", &[]);
    let made_of = ["calibrate", "scene.toml", TABLE];
    let calibration = trirrr().args(made_of).current_dir(&made).output().unwrap();
    assert!(
        calibration.status.success(),
        "{}",
        text(&calibration.stderr)
    );
    let calibrated = Scene::read(made.path().join("out/thesis-calibration/scene.toml")).unwrap();

    let loads = ["[3.0, 0.0]", "[0.0, 3.0]", "[2.0, -2.0]"];
    let tried = loads.into_iter().find_map(|load| {
        let load = format!("[wrench]\nforce_n = {load}\ntorque_nm = 0.1\n\n[limits]");
        let folder = scene(
            "thesis",
            &[
                ("[limits]", &load),
                ("torque_nm = 0.1\n\n[job]", "torque_nm = 2.0\n\n[job]"),
            ],
        );
        let own = Scene::read(folder.path().join("scene.toml")).unwrap();
        let mut legs = own.parameters;
        legs.legs = calibrated.parameters.legs;
        let torque_nm = limits_between(&own.parameters, &legs, own.job.start)?;
        Some((folder, own, torque_nm))
    });
    let (folder, own, torque_nm) = tried.unwrap();
    let device = Device::start(&folder, &[]);
    enable(&folder, &device);

    let mut asker = Asker::new(&device.address);
    let greeting = Command::Hello(local::hello::<f64>(&own));
    let Some(Reply::Hello(identity)) = asker.ask(1, greeting) else {
        panic!("no hello");
    };
    let limits = Section::Limits(Limits {
        torque_nm: Some(torque_nm),
        ..Limits::from(&own.limits)
    });
    let replaced = asker.ask(identity.next_sequence, Command::Replace(limits));
    assert_eq!(replaced, Some(Reply::Done));
    drop(asker);

    let sent = calibrate(&folder, &device.address, &["--joints-placed"]);
    let why = text(&sent.stderr);
    assert_eq!(sent.status.code(), Some(2), "{why}");
    assert!(
        why.contains("the board does not take the geometry"),
        "{why}"
    );
    assert!(why.contains("torque"), "{why}");
    assert!(!folder.path().join("out").exists());

    let mut asker = Asker::new(&device.address);
    let Some(Reply::Hello(identity)) = asker.ask(1, greeting) else {
        panic!("no hello");
    };
    for (index, leg) in (0..).zip(&own.parameters.legs) {
        let read = Command::Read(SectionName::Leg(index));
        let kept = asker.ask(identity.next_sequence + u32::from(index), read);
        let leg = Leg::from(leg);
        assert_eq!(kept, Some(Reply::Section(Section::Leg { index, leg })));
    }
}
