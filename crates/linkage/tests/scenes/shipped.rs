//! The scenes of the repository.

use super::{KINDS, parsed, text};
use trirrr_linkage::redundant::scene::{RedundantPlayer, columns, row};
use trirrr_scene::{MachineKind, Scene};

#[test]
fn every_shipped_scene_is_accepted_and_plays_at_every_tick() {
    for kind in KINDS {
        let scene = parsed(&text(kind)).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!((scene.name.as_str(), scene.kind.name()), (kind, kind));
        assert_eq!(scene.legs.len(), scene.kind.legs());
        let sliders = scene.sliders.iter().flatten().count();
        assert_eq!(sliders, scene.kind.sliders());
        let machine = scene.pipeline().unwrap();
        let player = RedundantPlayer::new(&scene);
        for tick in 0..=scene.ticks() {
            let record = player.record(&*machine, tick).unwrap();
            let values = row(&record);
            assert_eq!(values.len(), columns(&scene).len());
            assert!(values.iter().all(|value| value.is_finite()), "{kind}");
        }
    }
}

#[test]
fn a_placed_slider_is_further_from_singularities_than_one_in_the_middle() {
    for kind in ["2prrr-rrr", "3prrr"] {
        let scene = parsed(&text(kind)).unwrap();
        let placement = scene.placement.expect(kind);
        let before = placement.before.expect("the thesis machine does the job");
        assert!(placement.after > 1.05 * before, "{kind}: {placement:?}");
        for slider in scene.sliders.iter().flatten() {
            let travel = slider.travel;
            assert!((travel.low_m..=travel.high_m).contains(&slider.position_m));
        }
    }
}

#[test]
fn preload_makes_the_norm_larger_and_moves_nothing() {
    let preloaded = parsed(&text("4rrr")).unwrap();
    let mut plain = preloaded.clone();
    plain.preload_nm = vec![0.0; 4];
    let machine = preloaded.pipeline().unwrap();
    let (with, without) = (
        RedundantPlayer::new(&preloaded),
        RedundantPlayer::new(&plain),
    );
    for tick in [0, 50, 200] {
        let (with, without) = (
            with.record(&*machine, tick).unwrap(),
            without.record(&*machine, tick).unwrap(),
        );
        assert!(with.torque_norm() > without.torque_norm() + 0.01);
        assert_eq!(with.least_norm(), without.torque_norm());
        for (with, without) in with.legs.iter().zip(&without.legs) {
            assert_eq!(with.leg.dth1, without.leg.dth1);
        }
    }
}

#[test]
fn a_moving_slider_has_the_rates_of_its_positions() {
    let scene = parsed(&text("prrr-2rrr")).unwrap();
    let player = RedundantPlayer::new(&scene);
    let period = scene.period_s();
    let leg = 2;
    assert_eq!(player.sliders(0)[leg].position, -0.03);
    assert_eq!(player.sliders(scene.ticks())[leg].position, 0.04);
    for tick in 1..scene.ticks() {
        let [before, at, after] = [tick - 1, tick, tick + 1].map(|tick| player.sliders(tick)[leg]);
        // A cubic: the third derivative leaves an error of h^2 / 6 of it.
        let third = 12.0 * 0.07;
        let velocity = (after.position - before.position) / (2.0 * period);
        assert!((velocity - at.velocity).abs() < third * period * period / 6.0 * 1.001);
        let acceleration = (after.velocity - before.velocity) / (2.0 * period);
        assert!((acceleration - at.acceleration).abs() < 1e-12);
    }
}

#[test]
fn the_reader_of_the_3_rrr_says_what_can_be_done_with_a_redundant_machine() {
    for kind in KINDS {
        let error = Scene::parse(&text(kind), "s.toml").expect_err(kind);
        let said = error.to_string();
        assert!(said.contains(&format!("kind = \"{kind}\"")), "{said}");
        assert!(said.contains("`trirrr run` and `trirrr check`"), "{said}");
        assert_eq!(said.lines().count(), 1, "{said}");
    }
    let thesis = include_str!("../../../../scenes/thesis.toml");
    let scene = Scene::parse(&format!("kind = \"3rrr\"\n{thesis}"), "s.toml");
    assert!(scene.is_ok());
    let error = parsed(&format!("kind = \"3rrr\"\n{thesis}")).expect_err("no redundant one");
    assert!(
        error.to_string().contains("is no redundant machine"),
        "{error}"
    );
}

#[test]
fn the_kind_of_a_file_is_known_before_the_scene_is_read() {
    let folder = format!("{}/../../scenes", env!("CARGO_MANIFEST_DIR"));
    let kind = |name: &str, set: &[&str]| {
        let settings: Vec<_> = set.iter().map(|it| it.parse().unwrap()).collect();
        MachineKind::of_file(format!("{folder}/{name}.toml").as_ref(), &settings)
    };
    assert_eq!(kind("thesis", &[]), MachineKind::ThreeRrr);
    assert_eq!(kind("missing", &[]), MachineKind::ThreeRrr);
    assert_eq!(kind("redundant/6rrr", &[]), MachineKind::SixRrr);
    assert_eq!(kind("redundant/6rrr", &["kind=4rrr"]), MachineKind::FourRrr);
}
