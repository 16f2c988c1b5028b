//! The jobs of the repository's scenes, in every number type and its units.

use crate::dense::{Density, extremes};
use crate::judge::{Setting, judge};
use std::fs;
use std::path::Path;
use trirrr_core::limits::LimitParameters;
use trirrr_core::number::Fixed;
use trirrr_protocol::message::{AnyMove, Bounded};
use trirrr_scene::{Scene, offer, units};
use trirrr_service::ServiceNumber;
use trirrr_service::paces::Ramp;

fn scenes() -> Vec<Scene> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes");
    let files = fs::read_dir(folder).expect("the repository has scenes");
    let scenes: Vec<Scene> = files
        .map(|file| file.expect("a file").path())
        .filter(|file| {
            file.extension()
                .is_some_and(|extension| extension == "toml")
        })
        .map(|file| Scene::read(file).unwrap_or_else(|error| panic!("{error}")))
        .collect();
    assert!(scenes.len() >= 4);
    scenes
}

/// The scene's machine and moves in the units of `N`. A path was planned for the scene's own number type alone.
fn in_units<N: ServiceNumber>(scene: &Scene) -> Option<(Setting, Vec<AnyMove<N>>)> {
    let is_single = size_of::<N>() == size_of::<f32>() && N::PROPAGATES_NON_FINITE;
    if scene.job.path.is_some() && !is_single {
        return None;
    }
    let units = units::<N>(scene).ok()?;
    let setting = Setting {
        parameters: units.parameters(&scene.parameters),
        limits: units.limits(&scene.limits),
        ramp: scene.ramp(),
        period_s: units.time(scene.period_s()),
    };
    Some((setting, offer::moves(scene, &units)))
}

fn jobs_are_admitted<N: ServiceNumber>(least: usize) {
    let mut found = 0;
    for scene in scenes() {
        let Some((setting, moves)) = in_units::<N>(&scene) else {
            continue;
        };
        found += 1;
        for offered in &moves {
            let verdict = judge(&setting, offered).verdict;
            assert_eq!(verdict, Ok(()), "{}: {offered:?}", scene.name);
        }
    }
    assert!(found >= least, "{found} scenes fit the number type");
}

#[test]
fn the_jobs_of_all_scenes_are_admitted() {
    jobs_are_admitted::<f64>(4);
    jobs_are_admitted::<f32>(4);
    jobs_are_admitted::<Fixed>(3);
}

/// Limits a fiftieth above what the tick in `N` reaches are kept, a fiftieth below broken.
fn limits_are_kept<N: ServiceNumber>() {
    let density = Density {
        samples: 2000,
        every_speed: false,
    };
    let mut compared = 0;
    for scene in scenes() {
        let Some((mut setting, moves)) = in_units::<N>(&scene) else {
            continue;
        };
        // The samples know the ramp's own rate.
        setting.ramp = Ramp::fixed(setting.ramp.ticks);
        for offered in moves.iter().take(2) {
            let found = extremes(&setting, offered, density);
            let label = format!("{}: {offered:?} {found:?}", scene.name);
            // The units of fixed point are chosen for normal speed: the ramp of a hold may leave
            // its range, and then there is nothing to compare with.
            if !found.possible && !N::PROPAGATES_NON_FINITE {
                continue;
            }
            assert!(found.possible, "{label}");
            compared += 1;
            let with = |factor: f64, what: Bounded| {
                let values = |values: [f64; 3], of: Bounded| {
                    (what == of).then(|| values.map(|value| value * factor))
                };
                let limits = LimitParameters {
                    rate_rad_s: values(found.rate, Bounded::Rate),
                    acceleration_rad_s2: values(found.acceleration, Bounded::Acceleration),
                    torque_nm: values(found.torque, Bounded::Torque),
                    power_w: values(found.power, Bounded::Power),
                    ..setting.limits
                };
                judge(&Setting { limits, ..setting }, offered).verdict
            };
            for what in [
                Bounded::Rate,
                Bounded::Acceleration,
                Bounded::Torque,
                Bounded::Power,
            ] {
                assert!(with(1.02, what).is_ok(), "{what:?} {label}");
                let violation = with(0.98, what).expect_err("broken");
                assert_eq!(violation.what, what, "{label}");
            }
        }
    }
    assert!(compared >= 2, "{compared}");
}

#[test]
fn limits_about_the_ticks_own_results_are_told_apart() {
    limits_are_kept::<f64>();
    limits_are_kept::<f32>();
    limits_are_kept::<Fixed>();
}
