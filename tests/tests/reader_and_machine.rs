//! The reader of scenes and the service agree about every move: what is read is played, what is not played is
//! not read. Random moves with a limit close to what they need, in every number type.

use proptest::prelude::*;
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use trirrr_client::local::{self, HostNumber, LocalService};
use trirrr_core::model::Dynamic;
use trirrr_core::tick::{Motor, Tick};
// It holds the services of all number types and models: compiled there, they need not be compiled here.
use trirrr_host_sim as _;
use trirrr_protocol::message::{Command, Event, Message, Reply, Request};
use trirrr_scene::{JobPlayer, NumberType, Scene, in_number_type, offer, units};

const THESIS: &str = include_str!("../../scenes/thesis.toml");

/// Keys of `[limits]`, and what they bound.
type Bounded = (&'static str, fn(&Motor<f64>) -> f64);
const LIMITS: [Bounded; 4] = [
    ("rate_rad_s", |motor| motor.rate),
    ("acceleration_rad_s2", |motor| motor.acceleration),
    ("torque_nm", |motor| motor.torque),
    ("power_w", |motor| motor.torque * motor.rate),
];

/// A random move, its limit, and the limit's relative distance from what the move needs.
#[derive(Clone, Debug)]
struct Case {
    poses: [[f64; 3]; 2],
    turns: i32,
    duration_s: f64,
    limit: usize,
    excess: f64,
}

fn cases() -> impl Strategy<Value = Case> {
    let pose = || (0.2..0.3, 0.18..0.3, -0.3..0.5_f64).prop_map(|(x, y, alpha)| [x, y, alpha]);
    let excess = (-7.0..-2.0_f64, any::<bool>())
        .prop_map(|(exponent, more)| 10f64.powf(exponent) * if more { 1.0 } else { -1.0 });
    let turns = prop_oneof![4 => Just(0), 1 => -3..4_i32];
    let moves = ([pose(), pose()], turns, 20..150_u32);
    (moves, 0..LIMITS.len(), excess).prop_map(|((poses, turns, ticks), limit, excess)| Case {
        poses,
        turns,
        duration_s: f64::from(ticks) / 100.0,
        limit,
        excess,
    })
}

/// The thesis machine with the move of `case`, and a line of limits.
fn scene(case: &Case, number: NumberType, limits: &str) -> String {
    let (machine, _) = THESIS.split_once("[job]").expect("a job");
    let (machine, _) = machine.split_once("[limits]").expect("limits");
    let machine = machine.replacen("number = \"f64\"", &format!("number = \"{number}\""), 1);
    let [from, to] = case.poses.map(|[x, y, alpha]| {
        let alpha = alpha + f64::from(case.turns) * std::f64::consts::TAU;
        format!("{{ x_m = {x:?}, y_m = {y:?}, alpha_rad = {alpha:?} }}")
    });
    format!(
        "{machine}[limits]\n{limits}\n[job]\nstart = {from}\n\
         [[job.move]]\nto = {to}\nduration_s = {:?}\n",
        case.duration_s
    )
}

/// `scene` with all motors' `quantity` limited.
fn limited(scene: &Scene, quantity: usize, limit: f64) -> Scene {
    let mut scene = scene.clone();
    let limits = &mut scene.limits;
    *[
        &mut limits.rate_rad_s,
        &mut limits.acceleration_rad_s2,
        &mut limits.torque_nm,
        &mut limits.power_w,
    ][quantity] = Some([limit; 3]);
    scene
}

/// The least limit with which the service plays the job in `f64`, to 1e-9 of it. It lies above the values at
/// the ticks, since a hold anywhere has to keep it, too.
fn needed(scene: &Scene, quantity: usize) -> Option<f64> {
    let (_, of) = LIMITS[quantity];
    let tick = Tick::<Dynamic<f64>>::build(&scene.parameters).ok()?;
    let player = JobPlayer::<f64>::new(&scene.job, scene.period_s());
    let ticks = 0..=player.ticks();
    let values = ticks.filter_map(|at| tick.evaluate(&player.at(at)).ok());
    let values = values.flat_map(|motion| motion.motors.map(|motor| of(&motor).abs()));
    let peak = Some(values.fold(0.0, f64::max)).filter(|most| *most > 1e-6)?;
    let (mut low, mut high) = (0.5 * peak, 100.0 * peak);
    while high > low * (1.0 + 1e-9) {
        let middle = (low * high).sqrt();
        match is_played::<f64>(&limited(scene, quantity, middle)) {
            true => high = middle,
            false => low = middle,
        }
    }
    Some(high)
}

/// Offers the job's moves to the service of the scene. True if it admits them all.
fn is_played<N: HostNumber>(scene: &Scene) -> bool {
    let units = units::<N>(scene).expect("units of a scene that can be read");
    let moves = offer::moves::<N>(scene, &units);
    let offer = |machine: &mut dyn LocalService<N>| {
        let hello = Command::Hello(local::hello::<N>(scene));
        let first = machine.answer(&Request {
            sequence: 0,
            command: hello,
        });
        let Reply::Hello(identity) = first else {
            panic!("{first:?}");
        };
        let mut sequence = identity.next_sequence;
        let enabled = machine.answer(&Request {
            sequence,
            command: Command::Enable,
        });
        assert_eq!(enabled, Reply::Done);
        machine.tick();
        sequence = sequence.wrapping_add(1);
        let taken = moves.iter().all(|each| {
            let command = each.command();
            let reply = machine.answer(&Request { sequence, command });
            sequence = sequence.wrapping_add(1);
            while machine.step() {}
            reply == Reply::Done
        });
        let events = std::iter::from_fn(|| machine.outgoing());
        let refused = events.filter(|message| {
            matches!(message, Message::Event(Event::Verdict(verdict)) if verdict.violation.is_some())
        });
        taken && refused.count() == 0
    };
    local::with_machine::<N, _>(scene, offer).unwrap_or(false)
}

/// Compares reader and machine in `count` random scenes. Both verdicts have to occur.
fn compare(number: NumberType, count: u32) {
    let config = Config {
        cases: count,
        failure_persistence: None,
        ..Config::default()
    };
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[number.name().len() as u8; 32]);
    let mut runner = TestRunner::new_with_rng(config, rng);
    let verdicts = std::cell::Cell::new([0_u32; 2]);
    let checked = runner.run(&cases(), |case| {
        let (key, _) = LIMITS[case.limit];
        let Ok(free) = Scene::parse(&scene(&case, number, ""), "free") else {
            // Out of reach, or near a singularity: no matter of a limit.
            return Ok(());
        };
        let Some(need) = needed(&free, case.limit) else {
            return Ok(());
        };
        let limit = need * (1.0 + case.excess);
        let text = scene(&case, number, &format!("{key} = {limit:?}"));
        let read = Scene::parse(&text, "limited");
        let limited = limited(&free, case.limit, limit);
        let played = in_number_type!(number, N => is_played::<N>(&limited));
        prop_assert_eq!(read.is_ok(), played, "{}{:?}", text, read.err());
        let mut counted = verdicts.get();
        counted[usize::from(played)] += 1;
        verdicts.set(counted);
        Ok(())
    });
    if let Err(failure) = checked {
        panic!("{number}: {failure}");
    }
    let [refused, played] = verdicts.get();
    println!("{number}: {played} moves played, {refused} refused, reader and machine alike");
    assert!(refused > count / 10 && played > count / 10);
}

#[test]
fn they_agree_near_limits() {
    for number in NumberType::ALL {
        compare(number, 100);
    }
}

#[test]
#[ignore = "minutes; cargo xtask nightly runs it"]
fn they_agree_near_limits_in_five_thousand_scenes_of_each_type() {
    for number in NumberType::ALL {
        compare(number, 5000);
    }
}

/// More than half a turn: its radians are beyond the range of fixed point, its turns are not.
#[test]
fn fixed_point_takes_any_alpha_that_its_turns_hold() {
    for turns in [1, -1, 3, 1000, -100_000] {
        let case = Case {
            poses: [[0.21, 0.22, 0.157], [0.28, 0.28, 0.209]],
            turns,
            duration_s: 1.0,
            limit: 0,
            excess: 0.0,
        };
        let text = scene(&case, NumberType::Fixed, "");
        let scene = Scene::parse(&text, "turned").unwrap_or_else(|error| panic!("{error}"));
        assert!(
            in_number_type!(scene.number, N => is_played::<N>(&scene)),
            "{turns} turns"
        );
    }
}

/// A float loses the digits of an angle with every turn: the refusal names alpha.
#[test]
fn too_many_turns_for_a_float_are_a_matter_of_alpha() {
    let case = Case {
        poses: [[0.21, 0.22, 0.157], [0.28, 0.28, 0.209]],
        turns: 270,
        duration_s: 1.0,
        limit: 0,
        excess: 0.0,
    };
    let text = scene(&case, NumberType::F32, "");
    let error = Scene::parse(&text, "turned").expect_err("270 turns in f32");
    let said = error.to_string();
    assert!(said.contains("alpha would be 1697 rad"), "{said}");
    assert!(!said.contains("leg"), "{said}");
}
