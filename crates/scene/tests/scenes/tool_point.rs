//! Tool point and tools: against the machine described about that point by hand, and against rigid bodies.

use nalgebra::{Vector2, Vector3};
use std::path::{Path, PathBuf};
use trirrr_core::number::Number;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_scene::read::Setting;
use trirrr_scene::record::Record;
use trirrr_scene::{NumberType, Scene, in_number_type, pipeline};

/// Tool point in the frame of the bare platform, m.
const POINT: [f64; 2] = [0.03, -0.02];

fn file(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../../scenes/{name}.toml"))
}

fn draft(name: &str, settings: &[String]) -> Scene {
    let file = file(name);
    let text = std::fs::read_to_string(&file).unwrap();
    let settings: Vec<Setting> = settings.iter().map(|each| each.parse().unwrap()).collect();
    Scene::draft_set(&text, &file.display().to_string(), &settings).unwrap()
}

fn turned(alpha: f64, v: Vector2<f64>) -> Vector2<f64> {
    let (sin, cos) = alpha.sin_cos();
    Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

/// Motion of D, `point` before the tool point, where `record` has that of the tool point.
fn of_reference(record: &Record, point: [f64; 2]) -> Setpoint<f64> {
    let [x, y, alpha] = record.pose;
    let arm = turned(alpha, Vector2::from(point));
    let across = Vector2::new(-arm.y, arm.x);
    let ([vx, vy, rate], [ax, ay, gain]) = (record.velocity, record.acceleration);
    let position = Vector2::new(x, y) - arm;
    let velocity = Vector2::new(vx, vy) - across * rate;
    let acceleration = Vector2::new(ax, ay) - across * gain + arm * (rate * rate);
    Setpoint {
        pose: Pose::from_f64(position.x, position.y, alpha),
        velocity: Vector3::new(velocity.x, velocity.y, rate),
        acceleration: Vector3::new(acceleration.x, acceleration.y, gain),
    }
}

/// Records of the job of `scene` in the number type `N`.
fn records<N: Number>(scene: &Scene) -> Vec<Record> {
    let job = pipeline::scene::<N>(scene).unwrap();
    let setpoints = job.player.setpoints().step_by(7);
    setpoints
        .map(|setpoint| job.machine.evaluate(0.0, &setpoint).unwrap())
        .collect()
}

/// Largest differences of angles (rad), rates (rad/s), accelerations (rad/s^2), torques (N m).
fn differences(found: &Record, expected: &Record) -> [f64; 4] {
    let mut most = [0.0; 4];
    for (own, other) in found.legs.iter().zip(&expected.legs) {
        let off = [
            (own.th1 - other.th1).sin(),
            own.dth1 - other.dth1,
            own.ddth1 - other.ddth1,
            own.torque - other.torque,
        ];
        for (most, off) in most.iter_mut().zip(off) {
            *most = f64::max(*most, off.abs());
        }
    }
    most
}

#[test]
fn a_tool_point_is_the_motion_of_the_reference_point_in_all_number_types() {
    // Without the hose, whose force would act elsewhere.
    let free = ["wrench.force_n=[0, 0]", "wrench.torque_nm=0"].map(String::from);
    let mut with = free.to_vec();
    with.push(format!("platform.tool_point_m={POINT:?}"));
    let (bare, tooled) = (draft("vertical", &free), draft("vertical", &with));
    let reference = pipeline::build::<f64>(&bare.parameters).unwrap();
    for (number, bounds) in [
        (NumberType::F64, [1e-14, 1e-14, 1e-13, 1e-13]),
        (NumberType::F32, [2e-6, 2e-6, 2e-5, 2e-5]),
        (NumberType::Fixed, [1e-7, 1e-7, 1e-6, 1e-6]),
        // Its functions are coarse, with any machine.
        (NumberType::Micromath, [0.05, 0.05, 0.5, 0.3]),
    ] {
        let found = in_number_type!(number, N => records::<N>(&tooled));
        assert!(found.len() > 100);
        let mut most = [0.0; 4];
        for record in found {
            let setpoint = of_reference(&record, POINT);
            let expected = reference.evaluate(0.0, &setpoint).unwrap();
            for (most, off) in most.iter_mut().zip(differences(&record, &expected)) {
                *most = f64::max(*most, off);
            }
        }
        println!("{number}: {most:?}");
        let held = most.iter().zip(bounds).all(|(most, bound)| *most <= bound);
        assert!(held, "{number}: {most:?}, at most {bounds:?}");
    }
}

#[test]
fn a_tool_point_is_the_machine_described_from_there_by_hand() {
    let tooled = draft("vertical", &[format!("platform.tool_point_m={POINT:?}")]);
    // Joints at 60 mm, 150, 30 and 270 degrees from D, and the centre of mass of the file.
    let mut by_hand = vec![format!("platform.com_m={:?}", [0.01 - 0.03, 0.03 + 0.02])];
    for (leg, degrees) in [(1, 150_f64), (2, 30.0), (3, 270.0)] {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let [x, y] = [0.06 * cos - POINT[0], 0.06 * sin - POINT[1]];
        by_hand.push(format!(
            "machine.leg[{leg}].joint_radius_m={:?}",
            x.hypot(y)
        ));
        by_hand.push(format!(
            "machine.leg[{leg}].joint_angle_rad={:?}",
            y.atan2(x)
        ));
    }
    let described = draft("vertical", &by_hand);
    for (found, expected) in records::<f64>(&tooled)
        .iter()
        .zip(records::<f64>(&described))
    {
        let [angle, rate, acceleration, torque] = differences(found, &expected);
        // The hose pulls at the tool point in both.
        assert!(angle < 1e-14 && rate < 1e-13 && acceleration < 1e-11 && torque < 1e-12);
    }
    assert_eq!(
        tooled.parameters.platform.tool_point_m,
        Vector2::from(POINT)
    );
    assert_eq!(described.parameters.platform.tool_point_m, Vector2::zeros());
}

#[test]
fn a_mounted_tool_loads_the_platform_as_a_second_body() {
    let scene = Scene::read(file("tools")).unwrap();
    let rack = scene.tools.clone().unwrap();
    let bare = draft("thesis", &["gravity_m_s2=[0, -9.81]".into()]);
    let [pen, gripper] = ["pen", "gripper"].map(|name| rack.find(name).unwrap());
    assert_eq!((rack.mounted(), rack.find("hammer")), (pen, None));
    let left = rack.without_mounted(&scene.parameters.platform);
    let platform = bare.parameters.platform;
    assert!((left.com_m - platform.com_m).norm() < 1e-15);
    assert!((left.mass_kg - platform.mass_kg).abs() < 1e-15);
    assert!((left.inertia_kgm2 - platform.inertia_kgm2).abs() < 1e-15);
    for (index, mass, inertia, com, point) in [
        (pen, 0.06, 2e-5, [0.0, 0.02], [0.0, 0.03]),
        (gripper, 0.35, 4e-4, [0.02, 0.03], [0.03, 0.05]),
    ] {
        let carried = rack.put_into(&scene.parameters, index);
        let whole = pipeline::build::<f64>(&carried).unwrap();
        // D stands still and the platform turns fast: the torques of both bodies in one place.
        let (rate, gain, alpha) = (3.0, 7.0, 0.1);
        let arm = turned(alpha, Vector2::from(point));
        let across = Vector2::new(-arm.y, arm.x);
        let [position, velocity] = [Vector2::new(0.24, 0.16) + arm, across * rate];
        let acceleration = across * gain - arm * (rate * rate);
        let setpoint = Setpoint {
            pose: Pose::from_f64(position.x, position.y, alpha),
            velocity: Vector3::new(velocity.x, velocity.y, rate),
            acceleration: Vector3::new(acceleration.x, acceleration.y, gain),
        };
        let record = whole.evaluate(0.0, &setpoint).unwrap();
        let of_d = of_reference(&record, point);
        let without = pipeline::build::<f64>(&bare.parameters).unwrap();
        let without = without.evaluate(0.0, &of_d).unwrap();
        // Newton and Euler of the tool: force and moment about D that the platform has to give it.
        let from_d = turned(alpha, Vector2::from(com));
        let of_tool = Vector2::new(-from_d.y, from_d.x) * gain - from_d * (rate * rate);
        let force = (of_tool + Vector2::new(0.0, 9.81)) * mass;
        let moment = from_d.x * force.y - from_d.y * force.x + inertia * gain;
        // Virtual work: that wrench by the motion of D for a unit rate of each motor.
        let columns = jacobian(&*pipeline::build::<f64>(&bare.parameters).unwrap(), &of_d);
        let matrix = nalgebra::Matrix3::from_columns(&columns);
        let added =
            matrix.try_inverse().unwrap().transpose() * Vector3::new(force.x, force.y, moment);
        for leg in 0..3 {
            let found = record.legs[leg].torque - without.legs[leg].torque;
            assert!((found - added[leg]).abs() < 1e-9, "{found} {}", added[leg]);
            assert!((record.legs[leg].dth1 - without.legs[leg].dth1).abs() < 1e-12);
        }
    }
}

/// Joint rates for unit velocities of D, as columns.
fn jacobian(machine: &dyn pipeline::Pipeline<f64>, at: &Setpoint<f64>) -> [Vector3<f64>; 3] {
    [0, 1, 2].map(|axis| {
        let mut velocity = Vector3::zeros();
        velocity[axis] = 1.0;
        let record = machine
            .evaluate(0.0, &Setpoint { velocity, ..*at })
            .unwrap();
        Vector3::from(record.legs.map(|leg| leg.dth1))
    })
}

#[test]
fn another_mounted_tool_is_the_same_scene() {
    let key = |name: &str, settings: &[&str]| {
        let settings: Vec<String> = settings.iter().map(ToString::to_string).collect();
        draft(name, &settings).key
    };
    let own = key("tools", &[]);
    assert_eq!(key("tools", &["mounted=gripper"]), own);
    assert_ne!(key("tools", &["tick_rate_hz=200"]), own);
    assert_eq!(
        key("tools", &["mounted=gripper", "tick_rate_hz=200"]),
        key("tools", &["tick_rate_hz=200"])
    );
    let gripper = draft("tools", &["mounted=gripper".into()]);
    assert_eq!(
        gripper.parameters.platform.tool_point_m,
        Vector2::new(0.03, 0.05)
    );
}

#[test]
fn tools_that_cannot_be_exchanged_are_refused() {
    let text = std::fs::read_to_string(file("tools")).unwrap();
    let refused = |from: &str, to: &str| {
        let text = text.replacen(from, to, 1);
        let error = Scene::parse(&text, &file("tools").display().to_string()).unwrap_err();
        error.to_string()
    };
    for (from, to, told) in [
        (
            "adjustable = true",
            "adjustable = false",
            "tools: an exchanged tool is another platform",
        ),
        (
            "mounted = \"pen\"",
            "mounted = \"saw\"",
            "must be one of \"pen\", \"gripper\"",
        ),
        (
            "name = \"gripper\"",
            "name = \"pen\"",
            "tools[2].name = \"pen\": another of [[tools]] has this name",
        ),
        (
            "mass_kg = 0.35",
            "mass_kg = -1",
            "tools[2].mass_kg = -1: must not be negative",
        ),
        ("point_m = [0.0, 0.03]", "tip_m = 3", "tools[1].tip_m"),
        (
            "[service]",
            "[platform]\nmass_kg = 0.5\ninertia_kgm2 = 0.0025\ntool_point_m = [0.0, 0.1]\n\n[service]",
            "platform.tool_point_m = [0.0, 0.1]: each of [[tools]] has a point_m of its own",
        ),
    ] {
        let error = refused(from, to);
        assert!(error.contains(told), "{error}");
    }
    let thesis = std::fs::read_to_string(file("thesis")).unwrap();
    let error = Scene::parse(&format!("mounted = \"pen\"\n{thesis}"), "thesis.toml").unwrap_err();
    assert!(
        error.to_string().contains("the scene has no [[tools]]"),
        "{error}"
    );
}
