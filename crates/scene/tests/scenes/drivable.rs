//! What is accepted can be driven: the core gives every tick of it a value, and the machine stays
//! on one side of its parallel singularity. What is refused is refused for a reason that is there.

use crate::common::{THESIS, unlimited};
use proptest::prelude::*;
use trirrr_core::machine::Geometry;
use trirrr_core::model::Dynamic;
use trirrr_core::setpoint::{Hermite, Pose};
use trirrr_core::singularity::{Distances, det_a};
use trirrr_core::tick::Tick;
use trirrr_scene::{JobPlayer, Scene};

/// The thesis machine with another job: two moves, with a velocity (vx, vy, valpha) between them.
fn with_job([start, middle, end]: [[f64; 3]; 3], [vx, vy, valpha]: [f64; 3]) -> String {
    let scene = unlimited();
    let (machine, _) = scene
        .split_once("[job]")
        .expect("the thesis scene has a job");
    let pose =
        |[x, y, alpha]: [f64; 3]| format!("{{ x_m = {x:?}, y_m = {y:?}, alpha_rad = {alpha:?} }}");
    format!(
        "{machine}[job]\nstart = {}\n\
         [[job.move]]\nto = {}\nduration_s = 0.5\n\
         end_velocity = {{ vx_m_s = {vx:?}, vy_m_s = {vy:?}, valpha_rad_s = {valpha:?} }}\n\
         [[job.move]]\nto = {}\nduration_s = 0.5\n",
        pose(start),
        pose(middle),
        pose(end),
    )
}

fn pose() -> impl Strategy<Value = [f64; 3]> {
    (0.1..0.4, 0.15..0.4, -0.9..1.5_f64).prop_map(|(x, y, alpha)| [x, y, alpha])
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    #[test]
    fn accepted_jobs_evaluate_at_every_tick(
        poses in [pose(), pose(), pose()],
        velocity in [-0.3..0.3, -0.3..0.3, -2.0..2.0_f64],
    ) {
        let thesis = Scene::parse(THESIS, "thesis.toml").unwrap();
        let geometry = Geometry::<f64>::build(&thesis.parameters).unwrap();
        let distances = Distances::<f64>::build(&thesis.parameters);
        let limits = thesis.limits;
        // Independent of the scene's own check: samples, on the general cubic.
        let [start, middle, end] = poses.map(|[x, y, alpha]| Pose::<f64>::from_f64(x, y, alpha));
        let (rest, velocity_between) = ([0.0; 3].into(), velocity.into());
        let (ticks, period) = (400, 0.5 / 400.0);
        let moves = [
            Hermite::new(start, rest, middle, velocity_between, ticks, period),
            Hermite::new(middle, velocity_between, end, rest, ticks, period),
        ];
        let mut worst = f64::INFINITY;
        let mut signs = [false; 2];
        for each in &moves {
            for tick in 0..=ticks {
                let Ok(position) = geometry.position(&each.at(tick).pose) else {
                    worst = f64::NEG_INFINITY;
                    continue;
                };
                signs[usize::from(det_a(&position) > 0.0)] = true;
                for distance in distances.serial(&position) {
                    worst = worst.min(distance - limits.serial_distance_min);
                }
                worst = worst.min(distances.parallel(&position) - limits.parallel_distance_min);
            }
        }
        let crosses = signs == [true; 2];

        match Scene::parse(&with_job(poses, velocity), "random.toml") {
            Ok(scene) => {
                prop_assert!(worst >= 0.0 && !crosses, "accepted, but {worst} {crosses}");
                let tick = Tick::<Dynamic<f64>>::build(&scene.parameters).unwrap();
                for setpoint in JobPlayer::<f64>::new(&scene.job, scene.period_s()).setpoints() {
                    let motion = tick.evaluate(&setpoint);
                    prop_assert!(motion.is_ok(), "{setpoint:?}: {motion:?}");
                }
            }
            // Between the samples here a limit can be missed by a little.
            Err(error) => prop_assert!(worst < 0.001 || crosses, "{worst} {crosses}, but {error}"),
        }
    }
}

/// A stop takes its ramp where limits are far, and the way that a constant change of the pace gives. Where they are near, it
/// takes longer, and no longer than the scene allows.
#[test]
fn the_longest_stop_is_known() {
    let stop = |text: &str| {
        let scene = Scene::parse(text, "x.toml").unwrap_or_else(|error| panic!("{error}"));
        scene.longest_stop().expect("an admitted job")
    };
    let far = stop(&unlimited());
    // 0.1 s at 100 Hz are 10 ticks, and 5 ticks of a way whose fastest part is 1.5 times the mean of 0.0922 m/s.
    assert!((far.time_s - 0.1).abs() < 1e-12);
    let mean = (0.07f64).hypot(0.06);
    assert!(
        (0.95..1.03).contains(&(far.way_m / (1.5 * mean * 0.05))),
        "{far}"
    );

    let limited = |service: &str| {
        let tables = format!("torque_nm = 0.06\n[service]\n{service}\n");
        unlimited().replacen("[limits]\n", &format!("[limits]\n{tables}"), 1)
    };
    let near = stop(&limited("hold_ramp_s = 0.05"));
    assert!(near.time_s > 0.1, "{near}");
    let (mut admitted, mut refused) = (0, 0);
    for most in [0.05, 0.06, 0.1, 0.2, 0.5, 1.0] {
        let text = limited(&format!("hold_ramp_s = 0.05\nstop_time_max_s = {most}"));
        match Scene::parse(&text, "x.toml") {
            Ok(scene) => {
                let capped = scene.longest_stop().expect("an admitted job");
                assert!(capped.time_s <= most + 1e-9, "{most}: {capped}");
                admitted += 1;
            }
            Err(_) => refused += 1,
        }
    }
    assert!(admitted > 0 && refused > 0, "{admitted} {refused}");
}

#[test]
fn random_jobs_are_of_both_kinds() {
    // The property above would hold trivially if one outcome never came.
    let good = with_job(
        [[0.21, 0.22, 0.1], [0.25, 0.3, 0.2], [0.28, 0.28, 0.3]],
        [0.1, 0.1, 0.0],
    );
    assert!(Scene::parse(&good, "good.toml").is_ok());
    let bad = with_job(
        [[0.21, 0.22, 0.1], [0.1, 0.15, 0.2], [0.28, 0.28, 0.3]],
        [0.1, 0.1, 0.0],
    );
    assert!(Scene::parse(&bad, "bad.toml").is_err());
}

#[test]
fn shipped_jobs_evaluate_at_every_tick() {
    for text in [
        THESIS,
        include_str!("../../../../scenes/thesis-links.toml"),
        include_str!("../../../../scenes/vertical.toml"),
        include_str!("../../../../scenes/chained.toml"),
    ] {
        let scene = Scene::parse(text, "shipped.toml").unwrap();
        let in_f64 = Tick::<Dynamic<f64>>::build(&scene.parameters).unwrap();
        let in_f32 = Tick::<Dynamic<f32>>::build(&scene.parameters).unwrap();
        let player_f64 = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        let player_f32 = JobPlayer::<f32>::new(&scene.job, scene.period_s());
        for (exact, single) in player_f64.setpoints().zip(player_f32.setpoints()) {
            assert!(in_f64.evaluate(&exact).is_ok(), "{} {exact:?}", scene.name);
            assert!(
                in_f32.evaluate(&single).is_ok(),
                "{} {single:?}",
                scene.name
            );
            let difference = exact.pose.position - single.pose.position.map(f64::from);
            assert!(
                difference.abs().max() < 1e-6,
                "{}: {difference}",
                scene.name
            );
        }
    }
}
