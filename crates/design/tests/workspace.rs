//! Maps against poses that the machine itself evaluates, and areas against integrals.

use nalgebra::Vector3;
use std::path::Path;
use trirrr_core::setpoint::{Pose, Setpoint};
use trirrr_core::units::Units;
use trirrr_design::interval::Interval;
use trirrr_design::modes::{MODES, in_mode, job_in};
use trirrr_design::ratios::Ratios;
use trirrr_design::reactions::along_job;
use trirrr_design::workspace::{CellGrid, Conditions, Workspace};
use trirrr_scene::{Scene, pipeline};

fn scene(name: &str) -> Scene {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scenes");
    Scene::read(folder.join(name)).expect("a scene")
}

/// Numbers from 0 to 1.
fn random(state: &mut u64) -> f64 {
    *state = state
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*state >> 11) as f64 / (1_u64 << 53) as f64
}

/// Every pose of a cell within keeps the conditions, and every pose of one beyond breaks one: so many poses for each of four
/// maps.
fn agree(poses: u32, cells: usize) {
    let scene = scene("engraving.toml");
    let machine = pipeline::of_scene::<f64>(&scene, Units::SI).expect("a machine");
    let mut state = 7;
    for (serial_min, parallel_min, alpha_rad) in [
        (0.0, 0.0, [0.4, 0.4]),
        (0.1, 0.2, [0.4, 0.4]),
        (0.3, 0.3, [0.0, 0.0]),
        (0.1, 0.2, [0.3, 0.5]),
    ] {
        let side = (parallel_min > 0.0).then_some({
            let start = Setpoint {
                pose: scene.job.start,
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
            };
            machine.evaluate(0.0, &start).expect("the start").det_a > 0.0
        });
        let conditions = Conditions {
            serial_min,
            parallel_min,
            side,
            alpha_rad,
        };
        let grid = CellGrid::around(&scene.parameters, cells);
        let map = Workspace::map(&scene.parameters, &conditions, grid);
        let mut counts = [0; 2];
        for _ in 0..poses {
            let [column, row] = grid
                .size
                .map(|cells| (random(&mut state) * cells as f64) as usize);
            let share = map.cells[row * grid.size[0] + column];
            let centre = grid.centre_m(column, row);
            let place = centre.map(|at| at + (random(&mut state) - 0.5) * grid.cell_m);
            let alpha = alpha_rad[0] + random(&mut state) * (alpha_rad[1] - alpha_rad[0]);
            let setpoint = Setpoint {
                pose: Pose::from_f64(place[0], place[1], alpha),
                velocity: Vector3::zeros(),
                acceleration: Vector3::zeros(),
            };
            let keeps = machine.evaluate(0.0, &setpoint).is_ok_and(|record| {
                record.legs.iter().all(|leg| leg.serial >= serial_min)
                    && record.parallel >= parallel_min
                    && side.is_none_or(|side| side == (record.det_a > 0.0))
            });
            if share.within == 1.0 {
                counts[0] += 1;
                assert!(keeps, "{place:?} {alpha} is said to be within");
            }
            if share.within + share.undecided == 0.0 && alpha_rad[0] == alpha_rad[1] {
                counts[1] += 1;
                assert!(!keeps, "{place:?} {alpha} is said to be beyond");
            }
        }
        println!("{poses} poses, {counts:?} of them in cells that are proven within, and beyond");
        assert!(counts[0] > poses / 60, "{counts:?}");
    }
}

#[test]
fn random_poses_agree_with_the_map() {
    agree(60_000, 48);
}

/// `cargo test --release -p trirrr-design --test workspace -- --ignored --nocapture`
#[test]
#[ignore = "long: part of `cargo xtask nightly`"]
fn ten_million_poses_agree_with_the_map() {
    agree(2_500_000, 256);
}

/// Reach of the thesis machine at alpha = pi / 20: the common part of three rings, by midpoints of a fine grid.
#[test]
fn areas_have_bounds_on_both_sides() {
    let scene = scene("thesis.toml");
    let alpha = std::f64::consts::PI / 20.0;
    let conditions = Conditions {
        serial_min: 0.0,
        parallel_min: 0.0,
        side: None,
        alpha_rad: [alpha; 2],
    };
    let grid = CellGrid::around(&scene.parameters, 128);
    let map = Workspace::map(&scene.parameters, &conditions, grid);
    let [low, high] = map.area_m2();
    let fine = CellGrid::around(&scene.parameters, 2_000);
    let mut counted = 0;
    for row in 0..fine.size[1] {
        for column in 0..fine.size[0] {
            let [x, y] = fine.centre_m(column, row);
            counted += u32::from(scene.parameters.legs.iter().all(|leg| {
                let (sin, cos) = (alpha + leg.joint_angle_rad).sin_cos();
                let across = [
                    x + leg.joint_radius_m * cos - leg.base_m.x,
                    y + leg.joint_radius_m * sin - leg.base_m.y,
                ];
                let far = across[0].hypot(across[1]);
                far <= leg.proximal_m + leg.distal_m && far >= (leg.proximal_m - leg.distal_m).abs()
            }));
        }
    }
    let area = f64::from(counted) * fine.cell_m * fine.cell_m;
    assert!(
        low <= area * 1.001 && area <= high * 1.001,
        "{low} {area} {high}"
    );
    assert!(map.undecided() < 0.005, "{}", map.undecided());
    assert!((0.0710..0.0712).contains(&area), "{area}");
}

#[test]
fn shapes_lie_within() {
    let grid = CellGrid {
        low_m: [1.0, 2.0],
        cell_m: 0.5,
        size: [6, 5],
    };
    let picture = [
        "......", //
        ".####.", ".#####", ".####.", "..#...",
    ];
    let kept: Vec<bool> = picture
        .iter()
        .rev()
        .flat_map(|line| line.bytes().map(|cell| cell == b'#'))
        .collect();
    let rectangle = grid.largest_rectangle(&kept).expect("one");
    assert_eq!(rectangle.low_m, [1.5, 2.5]);
    assert_eq!(rectangle.size_m, [2.0, 1.5]);
    let disc = grid.largest_disc(&kept).expect("one");
    assert_eq!(disc.radius_m, 0.75);
    assert!(grid.largest_disc(&[false; 30]).is_none());
    assert!(grid.largest_rectangle(&[false; 30]).is_none());
}

/// Torques by a force on the platform of a machine without masses, and rates by differences of angles.
#[test]
fn ratios_are_those_of_torques_and_of_differences() {
    let mut scene = scene("thesis.toml");
    let pose = scene.job.start;
    let machine = pipeline::of_scene::<f64>(&scene, Units::SI).expect("a machine");
    let ratios = Ratios::at(&*machine, pose).expect("the start");
    let rest = |pose| Setpoint {
        pose,
        velocity: Vector3::zeros(),
        acceleration: Vector3::zeros(),
    };
    let h = 1e-6;
    for axis in 0..3 {
        let angles = [-h, h].map(|by| {
            let by: Vector3<f64> = Vector3::ith(axis, by);
            let moved = Pose::from_f64(
                pose.position.x + by[0],
                pose.position.y + by[1],
                pose.angle + by[2],
            );
            let record = machine.evaluate(0.0, &rest(moved)).expect("near");
            record.legs.map(|leg| leg.th1)
        });
        for (motor, (before, after)) in angles[0].iter().zip(angles[1]).enumerate() {
            let rate = (after - before) / (2.0 * h);
            assert!((rate - ratios.inverse[(motor, axis)]).abs() < 1e-6 * (1.0 + rate.abs()));
        }
    }
    let mut most: f64 = 0.0;
    for degree in 0..360 {
        let (sin, cos) = f64::from(degree).to_radians().sin_cos();
        scene.parameters.wrench_force_n = [cos, sin].into();
        let loaded = pipeline::of_scene::<f64>(&scene, Units::SI).expect("a machine");
        let record = loaded.evaluate(0.0, &rest(pose)).expect("the start");
        most = record
            .legs
            .iter()
            .map(|leg| leg.torque.abs())
            .fold(most, f64::max);
    }
    assert!(
        (most / ratios.torque_per_force() - 1.0).abs() < 1e-3,
        "{most}"
    );
}

#[test]
fn the_mode_of_the_scene_does_the_job_with_its_figures() {
    let scene = scene("engraving.toml");
    let modes = MODES.map(|elbows| in_mode(&scene, elbows).expect("a machine"));
    assert_eq!(modes.len(), 8);
    let own = modes
        .iter()
        .find(|mode| mode.name() == "+++")
        .expect("the mode");
    assert!(own.is_feasible(), "{own:?}");
    let figures = own.figures.expect("figures");
    // The plan uses its limits of 0.3 N m or 5 rad/s.
    assert!(
        (0.97..=1.0 + 1e-6).contains(&figures.limit_part),
        "{figures:?}"
    );
    assert!(figures.time_at_limits > 0.1);
    for mode in &modes {
        assert!(mode.fault.is_some() || mode.figures.is_some());
        if let Some(fault) = &mode.fault {
            assert!(!fault.reason.is_empty() && fault.t_s >= 0.0);
        }
    }
}

/// A scene for steppers computes no torques in its tick; its design has them.
#[test]
fn torques_are_there_for_scenes_without_them() {
    let scene = scene("plotter.toml");
    assert!(!scene.torque);
    let own = job_in(&scene, 1.0)
        .expect("a machine")
        .figures
        .expect("a job");
    assert!(
        own.torque_peak_nm.iter().all(|torque| *torque > 0.0),
        "{own:?}"
    );
    let forces = along_job(&scene).expect("a job").forces;
    assert!(
        forces
            .as_flattened()
            .iter()
            .all(|force| force.peak_n > force.rms_n && force.rms_n > 0.0)
    );
    // Four times as slow, a sixteenth of the torque: there is no gravity.
    let slow = job_in(&scene, 4.0)
        .expect("a machine")
        .figures
        .expect("a job");
    for (slow, own) in slow.torque_peak_nm.iter().zip(own.torque_peak_nm) {
        assert!((16.0 * slow / own - 1.0).abs() < 1e-9);
    }
}

#[test]
fn intervals_hold_what_they_should() {
    let mut state = 3;
    for _ in 0..10_000 {
        let mut draw = || 4.0 * random(&mut state) - 2.0;
        let (a, b) = (draw(), draw());
        let one = Interval::new(a.min(b), a.max(b));
        let inside = one.low + random(&mut state) * (one.high - one.low);
        let mut draw = || 4.0 * random(&mut state) - 2.0;
        let (c, d) = (draw(), draw());
        let other = Interval::new(c.min(d), c.max(d));
        let also = other.low + random(&mut state) * (other.high - other.low);
        assert!((one + other).contains(inside + also));
        assert!((one - other).contains(inside - also));
        assert!((one * other).contains(inside * also));
        assert!(one.squared().contains(inside * inside));
        assert!(one.abs().contains(inside.abs()));
        assert!(one.squared().sqrt().contains(inside.abs()));
        let [sin, cos] = Interval::sin_cos(one.low, one.high);
        assert!(sin.contains(inside.sin()) && cos.contains(inside.cos()));
        if !other.contains(0.0) {
            assert!(other.reciprocal().contains(1.0 / also));
        }
    }
}
