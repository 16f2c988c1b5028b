//! Scenes whose machine stands in another file, and values that arguments set.

use crate::common::THESIS;
use std::fs;
use std::path::Path;
use tempfile::TempDir;
use trirrr_scene::read::Setting;
use trirrr_scene::{NumberType, Scene};

/// A scene with a job alone.
const JOB: &str = r#"name = "other"
machine = "machines/thesis.toml"
tick_rate_hz = 200

[job]
start = { x_m = 0.22, y_m = 0.23, alpha_rad = 0.1 }

[[job.move]]
to = { x_m = 0.28, y_m = 0.28, alpha_rad = 0.2 }
duration_s = 1.0
"#;

fn folder(machine: &str, scene: &str) -> TempDir {
    let folder = TempDir::new().unwrap();
    fs::create_dir(folder.path().join("machines")).unwrap();
    fs::write(folder.path().join("machines/thesis.toml"), machine).unwrap();
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    folder
}

fn read(folder: &Path, settings: &[&str]) -> Result<Scene, String> {
    let settings: Vec<Setting> = settings.iter().map(|text| text.parse().unwrap()).collect();
    let scene = Scene::read_set(folder.join("scene.toml"), &settings);
    scene.map_err(|error| {
        error
            .to_string()
            .replace(&folder.display().to_string(), ".")
    })
}

#[test]
fn a_scene_takes_its_machine_from_another_file() {
    let folder = folder(THESIS, JOB);
    let scene = read(folder.path(), &[]).unwrap();
    let thesis = Scene::parse(THESIS, "thesis.toml").unwrap();
    assert_eq!(scene.parameters, thesis.parameters);
    assert_eq!(scene.limits, thesis.limits);
    // Its own values go before, name and job are never taken.
    assert_eq!(scene.tick_rate_hz, 200.0);
    assert_eq!(scene.name, "other");
    assert_eq!(scene.description, "");
    assert_eq!(scene.job.moves.len(), 1);
    assert_eq!(scene.job.start.position.x, 0.22);
    let file = scene.machine_file.clone().unwrap();
    assert!(file.ends_with("machines/thesis.toml"), "{file:?}");
    // A table of its own goes in place of the whole table of the machine.
    let limited = format!("{JOB}\n[limits]\nrate_rad_s = 7.0\n");
    fs::write(folder.path().join("scene.toml"), limited).unwrap();
    let own = read(folder.path(), &[]).unwrap();
    assert_eq!(own.limits.rate_rad_s, Some([7.0; 3]));
    assert_eq!(own.limits.torque_nm, None);
    assert_ne!(own.key, scene.key);
    // The key is that of both texts.
    let machine = folder.path().join("machines/thesis.toml");
    fs::write(
        machine,
        THESIS.replace("proximal_m = 0.2", "proximal_m = 0.21"),
    )
    .unwrap();
    fs::write(folder.path().join("scene.toml"), JOB).unwrap();
    let longer = read(folder.path(), &[]).unwrap();
    assert_eq!(longer.parameters.legs[0].proximal_m, 0.21);
    assert_ne!(longer.key, scene.key);
}

#[test]
fn a_problem_names_the_file_in_which_it_is() {
    let wrong = THESIS.replacen("distal_m = 0.2", "distal_m = -0.2", 1);
    let line = |text: &str, of: &str| text.lines().position(|line| line.contains(of)).unwrap() + 1;
    let at = line(&wrong, "-0.2");
    let scene = JOB.replace("duration_s = 1.0", "duration_s = -1.0");
    let error = read(folder(&wrong, &scene).path(), &["tick_rate_hz=0"]).unwrap_err();
    let said: Vec<&str> = error.lines().collect();
    assert_eq!(said.len(), 3, "{error}");
    let job = line(&scene, "-1.0");
    assert!(said[0].starts_with(&format!(
        "./scene.toml:{job}: job.move[1].duration_s = -1.0: "
    )));
    let of_machine = format!("./machines/thesis.toml:{at}: machine.leg[1].distal_m = -0.2: ");
    assert!(said[1].starts_with(&of_machine), "{error}");
    assert!(said[2].starts_with("--set: tick_rate_hz = 0: "), "{error}");
}

#[test]
fn files_that_are_no_machine_are_refused() {
    let refused = |machine: &str, scene: &str, reason: &str| {
        let error = read(folder(machine, scene).path(), &[]).unwrap_err();
        assert!(error.contains(reason), "{error}");
    };
    let place = "./scene.toml:2: machine = \"machines/thesis.toml\": ";
    refused("a = ", JOB, "./machines/thesis.toml:1: not TOML: ");
    refused(
        "number = \"f32\"\n",
        JOB,
        &format!("{place}the file has no [[machine.leg]]"),
    );
    let nested = format!("machine = \"other.toml\"\n{}", "number = \"f32\"");
    let reason =
        "./machines/thesis.toml:1: machine = \"other.toml\": the file of a machine takes no";
    refused(&nested, JOB, reason);
    let missing = JOB.replace("thesis.toml", "none.toml");
    refused(THESIS, &missing, "./machines/none.toml: cannot be read: ");
    refused(
        THESIS,
        &missing,
        "./scene.toml:2: machine = \"machines/none.toml\": ",
    );
    // A key that no scene has is one in the file of the machine, too.
    let unknown = format!("{THESIS}\n[colour]\nred = 1\n");
    refused(&unknown, JOB, "colour = [colour]: unknown key");
}

#[test]
fn arguments_go_before_the_file() {
    let folder = folder(THESIS, JOB);
    let settings = [
        "number=fixed",
        "machine.leg[2].proximal_m=0.205",
        "limits.rate_rad_s=6",
        "service.hold_ramp_s=0.05",
        "limits.torque_nm=0.5",
        "gravity_m_s2=[0.0, -1.5]",
    ];
    let scene = read(folder.path(), &settings).unwrap();
    assert_eq!(scene.number, NumberType::Fixed);
    assert_eq!(scene.parameters.legs[1].proximal_m, 0.205);
    assert_eq!(scene.limits.rate_rad_s, Some([6.0; 3]));
    assert_eq!(scene.service.hold_ramp_s, 0.05);
    assert_eq!(scene.parameters.gravity_m_s2.y, -1.5);
    assert_ne!(scene.key, read(folder.path(), &[]).unwrap().key);
    // The later one goes before the earlier.
    let twice = read(folder.path(), &["number=fixed", "number=f32"]).unwrap();
    assert_eq!(twice.number, NumberType::F32);
    for (setting, reason) in [
        (
            "platform.mas_kg=1",
            "--set: platform.mas_kg = 1: unknown key; did you mean `mass_kg`?",
        ),
        (
            "machine.leg[4].elbow=1",
            "--set: machine.leg[4].elbow = 1: the list `leg` has 3 elements",
        ),
        (
            "machine.arm[1].elbow=1",
            "--set: machine.arm[1].elbow = 1: there is no list `arm`",
        ),
        ("name.x=1", "--set: name.x = 1: `name` is no table"),
        ("name[1]=1", "--set: name[1] = 1: `name` is no list"),
        ("machine=1", "--set: machine = 1: expected a table"),
    ] {
        let error = read(folder.path(), &[setting]).unwrap_err();
        assert!(error.contains(reason), "{setting}: {error}");
    }
}
