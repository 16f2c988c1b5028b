//! The scenes that ship: accepted, with what their comments promise.

use nalgebra::Vector3;
use std::ops::RangeInclusive;
use std::path::PathBuf;
use trirrr_core::inverse::Position;
use trirrr_core::machine::{Elbow, Geometry, LinkParameters};
use trirrr_core::number::Number;
use trirrr_core::singularity::Distances;
use trirrr_scene::{BodyTolerances, DriveKind, JobPlayer, NumberType, Scene, Tool};

fn folder() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../scenes")
}

fn shipped(name: &str) -> Scene {
    let file = folder().join(name).with_extension("toml");
    Scene::read(&file).unwrap_or_else(|error| panic!("{error}"))
}

fn all() -> Vec<Scene> {
    all_in(folder())
}

fn all_in(folder: PathBuf) -> Vec<Scene> {
    let mut scenes = Vec::new();
    for entry in std::fs::read_dir(folder).unwrap() {
        let file = entry.unwrap().path();
        if file
            .extension()
            .is_some_and(|extension| extension == "toml")
        {
            scenes.push(Scene::read(&file).unwrap_or_else(|error| panic!("{error}")));
        }
    }
    scenes
}

#[test]
fn every_scene_is_accepted_and_named_after_its_file() {
    let mut names: Vec<String> = all().into_iter().map(|scene| scene.name).collect();
    names.sort();
    for name in [
        "chained",
        "engraving",
        "plotter",
        "thesis",
        "thesis-links",
        "vertical",
    ] {
        assert!(
            names.iter().any(|other| other == name),
            "{name} of {names:?}"
        );
        assert_eq!(shipped(name).name, name);
    }
}

#[test]
fn every_scene_limits_its_motors() {
    let [along_paths, with_inputs] = ["paths", "inputs"].map(|name| all_in(folder().join(name)));
    assert!(!along_paths.is_empty() && !with_inputs.is_empty());
    let others = along_paths.into_iter().chain(with_inputs);
    for scene in all().into_iter().chain(others) {
        assert_eq!(scene.missing_limits(), [], "{}", scene.name);
        // Where no torque is computed, the acceleration is what keeps it within bounds.
        let acceleration = scene.limits.acceleration_rad_s2;
        assert!(scene.torque || acceleration.is_some(), "{}", scene.name);
    }
}

#[test]
fn the_thesis_scene_has_the_thesis_values_bit_for_bit() {
    let scene = shipped("thesis");
    assert_eq!(scene.number, NumberType::F64);
    assert_eq!((scene.tick_rate_hz, scene.ticks()), (100.0, 100));
    let bases = scene
        .parameters
        .legs
        .map(|leg| (leg.base_m.x, leg.base_m.y));
    assert_eq!(bases, [(0.0, 0.433), (0.5, 0.433), (0.25, 0.0)]);
    let degrees = [150.0_f64, 30.0, 270.0];
    for (leg, degrees) in scene.parameters.legs.iter().zip(degrees) {
        assert_eq!((leg.proximal_m, leg.distal_m), (0.2, 0.2));
        assert_eq!(leg.joint_radius_m, 0.02);
        assert_eq!(leg.elbow, Elbow::Positive);
        assert_eq!(leg.proximal, LinkParameters::default());
        assert_eq!(leg.rotor_inertia_kgm2, 0.0);
        assert!((leg.joint_angle_rad - degrees.to_radians()).abs() <= f64::EPSILON);
    }
    let lambda = scene.parameters.legs.map(|leg| leg.joint_angle_rad);
    assert_eq!(
        lambda,
        [2.6179938779914944, 0.5235987755982988, 4.71238898038469]
    );
    assert_eq!(scene.parameters.platform.mass_kg, 0.5);
    assert_eq!(
        scene.parameters.platform.inertia_kgm2,
        0.5 * 0.5 * 0.1 * 0.1
    );
    assert!(scene.parameters.links_are_massless());
    let [only] = scene.job.moves.as_slice() else {
        panic!("one move expected");
    };
    let pi = std::f64::consts::PI;
    assert_eq!((only.from.angle, only.to.angle), (pi / 20.0, pi / 15.0));
    assert_eq!((only.from.position.x, only.from.position.y), (0.21, 0.22));
    assert_eq!((only.to.position.x, only.to.position.y), (0.28, 0.28));
    assert!(only.ends::<f64>().is_rest_to_rest());
}

#[test]
fn the_links_scene_differs_from_the_thesis_in_its_links_alone() {
    let (thesis, mut links) = (shipped("thesis"), shipped("thesis-links"));
    let rod = LinkParameters::uniform_rod(0.05, 0.2);
    for leg in &mut links.parameters.legs {
        assert_eq!((leg.proximal, leg.distal), (rod, rod));
        (leg.proximal, leg.distal) = Default::default();
    }
    assert_ne!(links.key, thesis.key);
    links.key = thesis.key;
    links.name = thesis.name.clone();
    links.description = thesis.description.clone();
    assert_eq!(links, thesis);
}

#[test]
fn the_vertical_scene_uses_what_it_says() {
    let scene = shipped("vertical");
    assert_eq!(scene.parameters.gravity_m_s2.y, -9.81);
    assert!(scene.parameters.platform.com_m.y != 0.0);
    let drives = scene.drives.expect("drives");
    assert!(matches!(drives[0].kind, DriveKind::Bldc(_)));
    for leg in &scene.parameters.legs {
        assert_eq!(leg.elbow, Elbow::Negative);
        assert_eq!(leg.rotor_inertia_kgm2, 9.0 * 9.0 * 2.2e-5);
        assert_eq!(leg.distal, LinkParameters::uniform_rod(0.2, 0.36));
    }
    let proximal = scene.parameters.legs.map(|leg| leg.proximal);
    assert_eq!(proximal[0], LinkParameters::uniform_rod(0.25, 0.3));
    assert_eq!(
        proximal[2].com_m, -0.02,
        "the leg's own link overrides the common one"
    );
    assert_eq!(scene.limits.power_w, Some([15.0, 15.0, 10.0]));
}

#[test]
fn the_chain_keeps_its_speed_around_the_outline_and_the_circle() {
    let scene = shipped("chained");
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let stops = |index: &usize| scene.job.moves[*index].end_velocity == Vector3::zeros();
    let stops: Vec<usize> = (0..scene.job.moves.len()).filter(stops).collect();
    let last = scene.job.moves.len() - 1;
    assert_eq!(stops, [10, 11, last], "run-out, across, run-out");
    let ticks = |index: usize| scene.job.moves[index].duration_ticks;
    assert_eq!(
        (ticks(0), ticks(1), ticks(3), ticks(5)),
        (400, 700, 500, 1000),
        "left out"
    );
    let mut counted = 0;
    for tick in 0..=player.ticks() {
        // Everything but the run-ins, the run-outs and the way across.
        if [0, 10, 11, 12, last].contains(&player.move_at(tick)) {
            continue;
        }
        counted += 1;
        let velocity = player.at(tick).velocity;
        let speed = velocity.x.hypot(velocity.y);
        // Straight sides keep it exactly. In the middle of a quarter circle of radius r, with
        // T = 4 tan(22.5 deg) r / v, the cubic's speed is (3/2 h / T - v sqrt(1/2) / 2) along the
        // chord h = sqrt(2) r, that is 0.927 v.
        assert!((0.09..=0.1001).contains(&speed), "{speed} at tick {tick}");
    }
    assert_eq!(counted, 700 + 4 * 331 + 2 * 500 + 1000 + 300 + 8 * 199);
}

#[test]
fn the_laser_is_on_where_the_chain_keeps_its_speed_and_nowhere_else() {
    let scene = shipped("chained");
    let last = scene.job.moves.len() - 1;
    for (index, each) in scene.job.moves.iter().enumerate() {
        // Run-ins, run-outs and the way across.
        let on = ![0, 10, 11, 12, last].contains(&index);
        let laser = Tool {
            power: 0.6,
            speed_m_s: 0.1,
        };
        assert_eq!(each.tool, on.then_some(laser), "move {}", index + 1);
    }
}

#[test]
fn the_engraving_keeps_its_feed_and_is_faster_than_the_chain() {
    let scene = shipped("engraving");
    assert!(2 * scene.ticks() < shipped("chained").ticks());
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let speed = |tick| {
        let velocity = player.at(tick).velocity;
        velocity.x.hypot(velocity.y)
    };
    let (on, off): (Vec<u32>, Vec<u32>) =
        (0..=scene.ticks()).partition(|tick| scene.job.moves[player.move_at(*tick)].tool.is_some());
    let fastest = |ticks: &[u32]| ticks.iter().copied().map(speed).fold(0.0, f64::max);
    // The feed and the rounding of poses. Off, the machine moves as fast as the motors allow.
    assert!((0.2495..0.2501).contains(&fastest(&on)), "{}", fastest(&on));
    assert!(fastest(&off) > 0.26, "{}", fastest(&off));
}

#[test]
fn the_plotter_draws_its_square_from_corner_to_corner() {
    let scene = shipped("plotter");
    assert!(scene.homing.is_some() && scene.job.path.is_some());
    let moves = &scene.job.moves;
    let stops = moves.iter().filter(|each| each.end_velocity.amax() == 0.0);
    let mut stops: Vec<_> = stops.map(|each| each.to.position).collect();
    // The pen comes down and goes up where the machine stands.
    let dwells: Vec<_> = moves.iter().filter(|each| each.from == each.to).collect();
    assert_eq!(
        [0, 1].map(|index: usize| (dwells[index].duration_ticks, dwells[index].tool.is_some())),
        [(50, true), (50, false)]
    );
    stops.dedup();
    let corners = [(0.23, 0.24), (0.27, 0.24), (0.27, 0.28), (0.23, 0.28)];
    let expected = [&corners[..], &[corners[0], (0.22, 0.24)]].concat();
    assert_eq!(stops.len(), expected.len(), "{stops:?}");
    for (stop, (x, y)) in stops.iter().zip(expected) {
        assert!(
            (stop.x - x).abs() < 1e-7 && (stop.y - y).abs() < 1e-7,
            "{stop}"
        );
    }
    let down = moves.iter().filter(|each| each.tool.is_some());
    let drawn: f64 = down
        .map(|each| each.to.position - each.from.position)
        .map(|way| way.x.hypot(way.y))
        .sum();
    assert!((drawn - 0.16).abs() < 1e-6, "{drawn}");
}

#[test]
fn every_job_starts_and_ends_at_rest_and_chains_exactly() {
    for scene in all() {
        let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
        assert_eq!(player.setpoints().count(), scene.ticks() as usize + 1);
        let (first, last) = (player.at(0), player.at(scene.ticks()));
        let moves = &scene.job.moves;
        assert_eq!(first.pose, scene.job.start, "{}", scene.name);
        assert_eq!(last.pose, moves[moves.len() - 1].to, "{}", scene.name);
        assert_eq!(first.velocity, Vector3::zeros(), "{}", scene.name);
        assert_eq!(last.velocity, Vector3::zeros(), "{}", scene.name);
        assert_eq!(player.at(u32::MAX), last, "beyond the end is the end");
        for pair in moves.windows(2) {
            assert_eq!(pair[0].to, pair[1].from);
            assert_eq!(pair[0].end_velocity, pair[1].start_velocity);
        }
        let mut tick = 0;
        for (index, each) in moves.iter().enumerate() {
            assert_eq!(player.move_at(tick), index);
            let setpoint = player.at(tick);
            assert_eq!(setpoint.pose, each.from, "{} tick {tick}", scene.name);
            let error = (setpoint.velocity - each.start_velocity).abs().max();
            assert!(error <= 1e-12, "{} tick {tick}: {error}", scene.name);
            tick += each.duration_ticks;
            if index > 0 {
                // From a tick before to a tick after a boundary the pose moves on by two ticks'
                // velocity, within the second-order term.
                let boundary = tick - each.duration_ticks;
                let (before, after) = (player.at(boundary - 1), player.at(boundary + 1));
                let period = scene.period_s();
                let travelled = (after.pose.position - before.pose.position) / (2.0 * period);
                // A quintic's acceleration is a cubic: four ticks say how large it can be between them.
                let largest = |ticks: RangeInclusive<u32>| -> f64 {
                    let sizes = ticks.map(|tick| player.at(tick).acceleration.abs().max());
                    sizes.fold(0.0, f64::max)
                };
                let acceleration = largest(boundary.saturating_sub(3)..=boundary)
                    + largest(boundary..=boundary + 3);
                let error = (travelled - each.start_velocity.xy()).abs().max();
                assert!(
                    error <= acceleration * period + 1e-12,
                    "{} {error}",
                    scene.name
                );
            }
        }
    }
}

/// Worst serial and parallel distance over all ticks.
fn margins<N: Number>(scene: &Scene) -> (f64, f64) {
    let geometry = Geometry::<N>::build(&scene.parameters).unwrap();
    let distances = Distances::<N>::build(&scene.parameters);
    let player = JobPlayer::<N>::new(&scene.job, scene.period_s());
    let mut least = (f64::INFINITY, f64::INFINITY);
    for setpoint in player.setpoints() {
        let position: Position<N> = geometry.position(&setpoint.pose).unwrap();
        for distance in distances.serial(&position) {
            least.0 = least.0.min(distance.to_f64());
        }
        least.1 = least.1.min(distances.parallel(&position).to_f64());
    }
    least
}

#[test]
fn every_job_stays_well_away_from_singularity_in_f32_too() {
    for scene in all() {
        let (serial, parallel) = margins::<f64>(&scene);
        println!("{}: serial {serial:.3}, parallel {parallel:.3}", scene.name);
        assert!(
            serial > 0.3 && parallel > 0.3,
            "{}: {serial} {parallel}",
            scene.name
        );
        let (serial_f32, parallel_f32) = margins::<f32>(&scene);
        assert!((serial - serial_f32).abs() < 1e-3, "{}", scene.name);
        assert!((parallel - parallel_f32).abs() < 1e-3, "{}", scene.name);
    }
}

#[test]
fn tolerances_are_read_and_a_step_of_the_drive_is_known() {
    let plotter = shipped("plotter");
    let tolerances = plotter.tolerances.expect("tolerances");
    assert_eq!(tolerances.distal_m, [1e-4; 3]);
    assert_eq!(tolerances.joint_m, [5e-5; 3]);
    assert_eq!(tolerances.links, BodyTolerances::default());
    // 200 steps of 16 microsteps behind a gear of 5: 16,000 a turn.
    let half = std::f64::consts::PI / 16_000.0;
    for motor in plotter.motor_resolution_rad() {
        assert!((motor - half).abs() < 1e-18, "{motor}");
    }
    assert_eq!(
        shipped("thesis").motor_resolution_rad(),
        [0.0; 3],
        "no encoder is described"
    );
    let vertical = shipped("vertical");
    let tolerances = vertical.tolerances.expect("tolerances");
    assert_eq!(tolerances.platform.mass_fraction, 0.01);
    assert_eq!((tolerances.force_n, tolerances.torque_nm), (0.2, 0.005));
    let drives = vertical.drives.unwrap();
    let counts = f64::from(drives[0].encoder_counts_per_rev.unwrap()) * drives[0].gear_ratio;
    let half = std::f64::consts::PI / counts;
    assert!((vertical.motor_resolution_rad()[0] - half).abs() < 1e-18);
    assert_eq!(shipped("thesis").tolerances, None);
}
