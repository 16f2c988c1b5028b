//! Tools that are exchanged on a device: pose, torque of the hold, jobs.

use crate::common::{Asker, Device, stream, text, ticks, trirrr};
use std::fs;
use std::path::Path;
use std::process::Output;
use tempfile::TempDir;
use trirrr_client::local;
use trirrr_core::forward::Forward;
use trirrr_core::machine::{Geometry, Parameters};
use trirrr_core::setpoint::Pose;
use trirrr_protocol::message::{Command, Reply, TelemetryFields};
use trirrr_scene::Scene;

/// m/s^2
const GRAVITY: f64 = 9.81;

/// Of a tool: mass, kg, centre of mass and tool point in the frame of the bare platform, m.
type Body = (f64, [f64; 2], [f64; 2]);

const PEN: Body = (0.06, [0.0, 0.02], [0.0, 0.03]);
const GRIPPER: Body = (0.35, [0.02, 0.03], [0.03, 0.05]);

/// The shipped scene in f64, beside its machine.
fn folder() -> TempDir {
    let folder = TempDir::new().unwrap();
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let read = |name: &str| fs::read_to_string(scenes.join(name)).unwrap();
    let scene = read("tools.toml")
        .replace("number = \"f32\"", "number = \"f64\"")
        .replace(
            "adjustable = true",
            "adjustable = true\nsilence_timeout_s = 600",
        );
    fs::write(folder.path().join("scene.toml"), scene).unwrap();
    fs::write(folder.path().join("thesis.toml"), read("thesis.toml")).unwrap();
    folder
}

fn tool(folder: &TempDir, device: &Device, more: &[&str]) -> Output {
    let mut command = trirrr();
    command.args(["tool", "scene.toml", "--port", &device.address]);
    command.args(more).current_dir(folder).output().unwrap()
}

/// Where a device stands at rest, and the torques that hold it there.
struct Hold {
    pose: [f64; 3],
    angles: [f64; 3],
    torques: [f64; 3],
}

fn hold(folder: &TempDir, device: &Device) -> Hold {
    let scene = Scene::read(folder.path().join("scene.toml")).unwrap();
    let mut asker = Asker::new(&device.address);
    let greeting = Command::Hello(local::hello::<f64>(&scene));
    let Some(Reply::Hello(identity)) = asker.ask(1, greeting) else {
        panic!("no hello");
    };
    let every = Command::Telemetry {
        every: 1,
        fields: TelemetryFields::ALL,
    };
    assert_eq!(asker.ask(identity.next_sequence, every), Some(Reply::Done));
    let sample = asker.sample();
    let Some(Reply::Status(status)) = asker.ask(identity.next_sequence + 1, Command::Status) else {
        panic!("no status");
    };
    let end = status.end.unwrap().pose;
    Hold {
        pose: [end.position.x, end.position.y, end.angle],
        angles: sample.angles,
        torques: sample.torques,
    }
}

/// Pose of the bare platform at motor angles, near `near`.
fn placed(bare: &Parameters, angles: [f64; 3], near: &Pose<f64>) -> Pose<f64> {
    let geometry = Geometry::<f64>::build(bare).unwrap();
    let forward = Forward::build(bare, &geometry);
    forward.solve(&angles, *near, 64).unwrap().pose
}

/// Place of a point of the platform in the fixed frame.
fn place(pose: &Pose<f64>, [u, v]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = pose.angle.sin_cos();
    [
        pose.position.x + cos * u - sin * v,
        pose.position.y + sin * u + cos * v,
    ]
}

/// Torques that hold platform and tool: the derivatives of their potential energy by the motor angles, as differences. Links are massless.
fn held(bare: &Parameters, angles: [f64; 3], near: &Pose<f64>, (mass, com, _): Body) -> [f64; 3] {
    let energy = |angles: [f64; 3]| {
        let pose = placed(bare, angles, near);
        GRAVITY * (bare.platform.mass_kg * pose.position.y + mass * place(&pose, com)[1])
    };
    [0, 1, 2].map(|motor| {
        let at = |by: f64| {
            let mut moved = angles;
            moved[motor] += by;
            energy(moved)
        };
        (at(1e-5) - at(-1e-5)) / 2e-5
    })
}

#[test]
fn an_exchanged_tool_has_its_own_tool_point_and_its_own_weight() {
    let folder = folder();
    let device = Device::start(&folder, &[]);
    let bare = Scene::read(folder.path().join("thesis.toml"))
        .unwrap()
        .parameters;

    // A machine that is off tells its tool, and takes none.
    let shown = text(&tool(&folder, &device, &[]).stdout);
    assert!(
        shown.contains("* pen") && shown.contains("  gripper"),
        "{shown}"
    );
    let off = tool(&folder, &device, &["--mount", "gripper"]);
    assert_eq!(off.status.code(), Some(2), "{}", text(&off.stderr));
    let unknown = tool(&folder, &device, &["--mount", "saw"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(text(&unknown.stderr).contains("its tools are pen, gripper"));
    let enabled = trirrr()
        .args(["enable", "scene.toml", "--port", &device.address])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(enabled.status.success(), "{}", text(&enabled.stderr));

    let near = Pose::from_f64(0.21, 0.19, 0.15);
    let check = |found: &Hold, of: Body| {
        let pose = placed(&bare, found.angles, &near);
        let [x, y] = place(&pose, of.2);
        let off = [
            found.pose[0] - x,
            found.pose[1] - y,
            found.pose[2] - pose.angle,
        ];
        assert!(off.iter().all(|off| off.abs() < 1e-12), "{off:?}");
        let wanted = held(&bare, found.angles, &near, of);
        for (found, wanted) in found.torques.iter().zip(wanted) {
            assert!((found - wanted).abs() < 1e-8, "{found} {wanted}");
        }
    };
    let with_pen = hold(&folder, &device);
    check(&with_pen, PEN);
    let mounted = tool(&folder, &device, &["--mount", "gripper"]);
    assert!(mounted.status.success(), "{}", text(&mounted.stderr));
    assert!(text(&mounted.stdout).contains("mounted: gripper"));
    let with_gripper = hold(&folder, &device);
    check(&with_gripper, GRIPPER);
    // The motors have not moved, and the tool point has.
    for motor in 0..3 {
        let turned = with_gripper.angles[motor] - with_pen.angles[motor];
        assert!(turned.abs() < 1e-12, "{turned}");
    }
    assert!((with_gripper.pose[0] - with_pen.pose[0]).abs() > 0.02);
    let more = |motor: usize| (with_gripper.torques[motor] - with_pen.torques[motor]).abs();
    assert!((0..3).map(more).fold(0.0, f64::max) > 0.1);

    // A job for the pen is refused now, and one for the gripper is played.
    let refused = stream(&folder, &device.address, &[]);
    assert_eq!(refused.status.code(), Some(2));
    let why = text(&refused.stderr);
    assert!(why.contains("carries the tool \"gripper\""), "{why}");
    let settings = ["--set", "mounted=gripper", "--recover", "1"];
    let played = stream(&folder, &device.address, &settings);
    assert!(played.status.success(), "{}", text(&played.stderr));
    let run = trirrr()
        .args([
            "run",
            "scene.toml",
            "--fast",
            "--out",
            "run",
            "--set",
            "mounted=gripper",
        ])
        .current_dir(&folder)
        .output()
        .unwrap();
    assert!(run.status.success(), "{}", text(&run.stderr));
    let rows = |out: &str| -> Vec<Vec<f64>> {
        let table = ticks(&folder.path().join(out));
        let cells = |row: &str| {
            row.split(',')
                .filter_map(|cell| cell.parse().ok())
                .collect()
        };
        table.lines().skip(1).map(cells).collect()
    };
    let (found, wanted) = (rows("out"), rows("run"));
    assert_eq!(found.len(), wanted.len());
    for (found, wanted) in found.iter().zip(&wanted) {
        assert_eq!(found.len(), wanted.len());
        let off = found.iter().zip(wanted).map(|(a, b)| (a - b).abs());
        assert!(off.fold(0.0, f64::max) < 1e-9);
    }

    // And back: the pen's weight is what it was.
    let mounted = tool(&folder, &device, &["--mount", "pen"]);
    assert!(mounted.status.success(), "{}", text(&mounted.stderr));
    check(&hold(&folder, &device), PEN);
}
