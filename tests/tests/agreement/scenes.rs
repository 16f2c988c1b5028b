//! Every tick of every shipped scene, each type from the scene's own numbers; every twentieth in a build without optimisation.

use crate::bounds::Stages;
use crate::format::{Format, job};
use std::fs;
use std::path::Path;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_core::setpoint::Pose;
use trirrr_scene::{JobPlayer, Scene};
use trirrr_tests::inputs::{Input, Quantity};
use trirrr_tests::rounding::Rounding;

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

/// How far the setpoint of a tick in move `index` may be off, besides the rounding of its own values. With the swing
/// w = |h| + T |v0| + T |v1| of an axis, the cubic's coefficients are at most 3 w, in units of the
/// axis, and the fraction of the move s enters with their sum.
///
/// A float rounds each coefficient and product by u of itself: 8 u w in all for the pose; twice
/// that over T for the velocity, which multiplies the coefficients by 2 and 3; 50 u w / T^2 for the
/// acceleration (by 2 and 6).
///
/// Fixed point has s within 0.75 unit, which the derivatives 3 w / 2, 6 w and 12 w of the three
/// multiply, and each coefficient and product within half a unit of the axis: two units of the
/// pose; three over T, ten over T^2 of the others, which have two of their own besides.
///
/// A quintic swings by T^2 |a0| / 2 + T^2 |a1| / 2 besides. Planned ones are short: there the rounding of both poses
/// counts, which a velocity sees with 15 / (8 T) and an acceleration with 5.8 / T^2. In fixed point 3 z m + 6 A n + 2 f + 2 k
/// has up to 30 units, and the derivatives by s are up to 2 w, 12 w and 60 w.
fn of_setpoint(scene: &Scene, index: usize, rounding: Rounding) -> impl Fn(Input) -> f64 {
    let each = scene.job.moves[index];
    let duration = f64::from(each.duration_ticks) * scene.period_s();
    let coordinates = |pose: &Pose<f64>| [pose.position.x, pose.position.y, pose.angle];
    let (from, to) = (coordinates(&each.from), coordinates(&each.to));
    let swing: [f64; 3] = std::array::from_fn(|axis| {
        let velocities = each.start_velocity[axis].abs() + each.end_velocity[axis].abs();
        let bent = each.accelerations.map_or(0.0, |[a0, a1]| {
            0.5 * duration * duration * (a0[axis].abs() + a1[axis].abs())
        });
        (to[axis] - from[axis]).abs() + duration * velocities + bent
    });
    move |input| {
        let (axis, order) = match input.quantity {
            Quantity::Position => (input.component, 0),
            Quantity::Angle => (2, 0),
            Quantity::Velocity => (input.component, 1),
            Quantity::AngleRate => (2, 1),
            Quantity::Acceleration => (input.component, 2),
            Quantity::AngleAcceleration => (2, 2),
            _ => return 0.0,
        };
        let (swing, per) = (swing[axis], duration.powi(order));
        let order = order as usize;
        let is_quintic = each.accelerations.is_some();
        let ends = match is_quintic {
            true => [0.0, 2.0, 6.0][order] * (from[axis].abs() + to[axis].abs()),
            false => 0.0,
        };
        match rounding {
            Rounding::Relative(u) => ([8.0, 16.0, 50.0][order] * swing + ends) * u / per,
            Rounding::Absolute(units) => {
                let own = 2.0 * rounding.half_unit(input.quantity, 0.0);
                let axis_unit = if axis == 2 { 1.0 } else { units.length_m() };
                let (coefficients, derivatives) = match is_quintic {
                    false => ([2.0, 3.0, 10.0], [1.5, 6.0, 12.0]),
                    true => ([4.0, 12.0, 30.0], [2.0, 12.0, 60.0]),
                };
                let coefficients = coefficients[order] * axis_unit;
                let fraction = 0.75 * derivatives[order] * swing;
                2.0 * own + Fixed::UNIT * (coefficients + fraction) / per
            }
        }
    }
}

fn worst<F: Format>() -> Stages {
    let mut worst = Stages::default();
    for scene in shipped() {
        let ((found, units), (reference, _)) = (job::<F>(&scene), job::<f64>(&scene));
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        assert_eq!(found.len(), scene.ticks() as usize + 1);
        for (tick, (found, reference)) in (0..).zip(found.iter().zip(&reference)) {
            if cfg!(debug_assertions) && tick % 20 != 0 {
                continue;
            }
            let place = || format!("{} tick {tick}", scene.name);
            let (Ok(found), Ok(reference)) = (found, reference) else {
                panic!("{}: {found:?} {reference:?}", place());
            };
            let off = of_setpoint(&scene, player.move_at(tick), Rounding::of::<F>(units));
            let bounds = F::bounds(&scene.parameters, &player.at(tick), &units, off);
            let bounds = bounds.unwrap_or_else(|| panic!("{}: no bound", place()));
            worst.compare(place, found, reference, &bounds);
        }
    }
    worst
}

#[test]
fn f32_agrees() {
    let brackets = [(0.35, 0.6), (0.55, 0.85), (0.6, 0.9), (0.55, 0.85)];
    worst::<f32>().assert_within("f32, scenes", brackets);
}

#[test]
fn fixed_agrees() {
    let brackets = [(0.28, 0.45), (0.22, 0.4), (0.23, 0.4), (0.15, 0.3)];
    worst::<Fixed>().assert_within("fixed, scenes", brackets);
}

#[test]
fn micromath_agrees() {
    // The square roots' errors together, beyond their corners, show in an acceleration near zero.
    let brackets = [(0.7, 1.0), (0.8, 1.0), (0.85, 1.1), (0.8, 1.0)];
    worst::<Coarse>().assert_within("micromath, scenes", brackets);
}
