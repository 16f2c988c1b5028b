//! Every tick of every shipped scene, each type from the scene's own numbers.

use crate::bounds::Stages;
use crate::format::{Format, job};
use std::fs;
use std::path::Path;
use trirrr_core::number::Coarse;
use trirrr_core::setpoint::Pose;
use trirrr_scene::{JobPlayer, Scene};
use trirrr_tests::inputs::{Input, Quantity};

/// Every scene of the repository.
fn shipped() -> Vec<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let entries = fs::read_dir(&folder).expect("the folder of scenes");
    let files = entries.map(|entry| entry.expect("an entry").path());
    let scenes: Vec<Scene> = files
        .filter(|file| {
            file.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .map(|file| Scene::read(file).unwrap_or_else(|error| panic!("{error}")))
        .collect();
    assert!(scenes.len() >= 4, "scenes are missing");
    scenes
}

/// How far a setpoint of a cubic may be off in units of the roundoff, besides the rounding of its
/// own value: with the swing w = |h| + T |v0| + T |v1| of an axis, its coefficients are sums of at
/// most 3 h, 3 T v0, 2 T v1 with two roundings each, 8 u w in all for the pose; twice that for the
/// velocity, which multiplies them by 2 and 3, over T; 50 u w / T^2 for the acceleration (2 and 6).
fn of_setpoint(scene: &Scene, tick: u32, unit: f64) -> impl Fn(Input) -> f64 {
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let each = scene.job.moves[player.move_at(tick)];
    let duration = f64::from(each.duration_ticks) * scene.period_s();
    let coordinates = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let (from, to) = (coordinates(&each.from), coordinates(&each.to));
    let swing: [f64; 3] = std::array::from_fn(|axis| {
        let velocities = each.start_velocity[axis].abs() + each.end_velocity[axis].abs();
        (to[axis] - from[axis]).abs() + duration * velocities
    });
    move |input| {
        let (axis, roundings, per) = match input.quantity {
            Quantity::Position => (input.component, 8.0, 1.0),
            Quantity::Angle => (2, 8.0, 1.0),
            Quantity::Velocity => (input.component, 16.0, duration),
            Quantity::AngleRate => (2, 16.0, duration),
            Quantity::Acceleration => (input.component, 50.0, duration * duration),
            Quantity::AngleAcceleration => (2, 50.0, duration * duration),
            _ => return 0.0,
        };
        roundings * unit * swing[axis] / per
    }
}

fn worst<F: Format>(unit: f64) -> Stages {
    let mut worst = Stages::default();
    for scene in shipped() {
        let (found, reference) = (F::job(&scene), job::<f64>(&scene));
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        assert_eq!(found.len(), scene.ticks() as usize + 1);
        for (tick, (found, reference)) in (0..).zip(found.iter().zip(&reference)) {
            let place = || format!("{} tick {tick}", scene.name);
            let (Ok(found), Ok(reference)) = (found, reference) else {
                panic!("{}: {found:?} {reference:?}", place());
            };
            let off = of_setpoint(&scene, tick, unit);
            let bounds = F::bounds(&scene.parameters, &player.at(tick), off);
            let bounds = bounds.unwrap_or_else(|| panic!("{}: no bound", place()));
            worst.compare(place, found, reference, &bounds);
        }
    }
    worst
}

#[test]
fn f32_agrees() {
    let unit = f64::from(f32::EPSILON) / 2.0;
    let brackets = [(0.35, 0.6), (0.55, 0.85), (0.6, 0.9), (0.55, 0.85)];
    worst::<f32>(unit).assert_within("f32, scenes", brackets);
}

#[test]
fn micromath_agrees() {
    let unit = f64::from(f32::EPSILON) / 2.0;
    let brackets = [(0.7, 1.0), (0.8, 1.0), (0.85, 1.0), (0.8, 1.0)];
    worst::<Coarse>(unit).assert_within("micromath, scenes", brackets);
}
