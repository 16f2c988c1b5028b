//! Plant of the redundant machines of the repository.

use std::sync::atomic::AtomicBool;
use trirrr_linkage::redundant::scene::RedundantScene;
use trirrr_plant::redundant::{RedundantOutcome, simulate};

const KINDS: [&str; 5] = ["4rrr", "6rrr", "prrr-2rrr", "2prrr-rrr", "3prrr"];

fn scene(kind: &str, settings: &[&str]) -> RedundantScene {
    let file = format!(
        "{}/../../scenes/redundant/{kind}.toml",
        env!("CARGO_MANIFEST_DIR")
    );
    let settings: Vec<_> = settings.iter().map(|it| it.parse().unwrap()).collect();
    RedundantScene::read_set(file, &settings).unwrap_or_else(|error| panic!("{error}"))
}

fn run(scene: &RedundantScene) -> RedundantOutcome {
    let mut rows = 0;
    let outcome = simulate(scene, &AtomicBool::new(false), &mut |_| rows += 1).unwrap();
    assert_eq!(outcome.failure, None, "{}", scene.name);
    assert_eq!(rows, scene.ticks() + 1, "{}", scene.name);
    outcome
}

#[test]
fn loops_hold_every_machine_on_its_path_and_its_energies_close() {
    for kind in KINDS {
        let outcome = run(&scene(kind, &[]));
        // Friction, a load that the model does not know, and torques that are held for a tick.
        let path = outcome.path_error.peak;
        assert!(path > 1e-7 && path < 2e-3, "{kind}: {path} m");
        assert!(outcome.angle_error.peak < 2e-2, "{kind}");
        // Energies come body by body, work from torques and rates: only the integration is between them.
        let size = outcome.work_j.abs() + outcome.stored_j.abs() + outcome.lost_j;
        let error = outcome.balance_error_j().abs() / size;
        assert!(error < 1e-10, "{kind}: {error:e} of {size} J");
        assert!(outcome.lost_j > 0.0);
    }
}

/// With everything known and finer ticks, torques of the model alone keep the machine on its path: forward and inverse
/// dynamics are one machine. The error falls with the length of a tick.
#[test]
fn torques_of_the_model_move_the_model_along_the_path() {
    let known = [
        "plant.kp_nm_rad=0",
        "plant.kd_nm_s_rad=0",
        "plant.slider_kp_n_m=0",
        "plant.slider_kd_n_s_m=0",
        "plant.friction_nm_s_rad=0",
        "plant.slider_friction_n_s_m=0",
        "plant.extra_mass_kg=0",
        "job.move[1].duration_s=0.4",
        "limits.rate_rad_s=100",
        "limits.torque_nm=100",
    ];
    for kind in KINDS {
        let error = |rate: &str| {
            let mut settings = known.to_vec();
            settings.push(rate);
            // No search for the best place: any will do.
            let placed = [
                "machine.leg[1].slider.place=given",
                "machine.leg[2].slider.place=given",
                "machine.leg[3].slider.place=given",
            ];
            match kind {
                "2prrr-rrr" => settings.extend(&placed[..2]),
                "3prrr" => settings.extend(placed),
                _ => {}
            }
            run(&scene(kind, &settings)).path_error.peak
        };
        let (coarse, fine) = (error("tick_rate_hz=500"), error("tick_rate_hz=1000"));
        assert!(
            fine < 5e-3 && fine < 0.6 * coarse,
            "{kind}: {coarse} {fine}"
        );
    }
}

#[test]
fn a_run_that_is_stopped_says_so() {
    let scene = scene("4rrr", &[]);
    let outcome = simulate(&scene, &AtomicBool::new(true), &mut |_| ()).unwrap();
    assert!(outcome.is_stopped && outcome.simulated_s == 0.0);
    let mut plain = scene;
    plain.plant = None;
    assert!(simulate(&plain, &AtomicBool::new(false), &mut |_| ()).is_err());
}
