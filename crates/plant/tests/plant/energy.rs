//! What mechanics keeps: energy, and the way back.

use crate::reference::run;
use crate::scenes::{edited, parse, shipped, text, without_drives};
use trirrr_integrate::{End, Integrator, Method};
use trirrr_plant::{Control, Plant, PlantEnd};

const TIGHT: Method = Method::DormandPrince { tolerance: 1e-12 };

/// Integrates a plant without commands from `start` to `end` seconds.
fn swing(plant: &mut Plant<8>, state: &mut [f64; 8], end: f64) -> u64 {
    let mut integrator = Integrator::new(plant, TIGHT).unwrap();
    let ended = integrator.advance(plant, 0.0, state, end, |_, _| {});
    assert_eq!(ended, Ok(End::Reached));
    integrator.tally().steps
}

#[test]
fn a_free_swing_keeps_its_energy() {
    // Falling under gravity, with masses everywhere and the tool off centre; then without gravity,
    // set in motion.
    for (name, v, time) in [
        ("vertical", [0.0; 3], 0.12),
        ("vertical", [0.3, 0.2, -1.0], 0.1),
        ("thesis-links", [0.1, 0.2, 3.0], 0.3),
        ("thesis", [0.1, 0.2, 1.0], 0.3),
    ] {
        let scene = without_drives(name);
        let (mut plant, mut state) = Plant::<8>::build(&scene, Control::Held).unwrap();
        state[3..6].copy_from_slice(&v);
        let before = plant.energy(&state).unwrap();
        let start = state;
        let steps = swing(&mut plant, &mut state, time);
        let after = plant.energy(&state).unwrap();
        // What was exchanged: the speed reached, as kinetic energy of the platform alone.
        let speed = state[3].hypot(state[4]);
        let exchanged = 0.5 * scene.parameters.platform.mass_kg * speed * speed;
        let error = (after - before).abs() / exchanged;
        println!(
            "{name}: {steps} steps, {error:.1e} of {exchanged:.3} J, moved to {:?}",
            &state[..3]
        );
        assert!(state[0] - start[0] != 0.0 && exchanged > 1e-4);
        // 1e-12 each step, a few hundred steps, all of one sign at worst.
        assert!(error < 1e-9, "{name}: {error}");
    }
}

#[test]
fn a_swing_runs_backwards_to_where_it_began() {
    let scene = without_drives("vertical");
    let (mut plant, start) = Plant::<8>::build(&scene, Control::Held).unwrap();
    let mut state = start;
    state[3..6].copy_from_slice(&[0.3, 0.2, -1.0]);
    let launched = state;
    swing(&mut plant, &mut state, 0.1);
    let far = (state[0] - start[0]).hypot(state[1] - start[1]);
    assert!(far > 0.01, "{far}");
    for rate in &mut state[3..6] {
        *rate = -*rate;
    }
    swing(&mut plant, &mut state, 0.1);
    for axis in 0..3 {
        // Errors of 1e-12 per step grow with the motion's own divergence, by e in about 0.05 s.
        assert!((state[axis] - launched[axis]).abs() < 1e-10, "{state:?}");
        assert!(
            (state[3 + axis] + launched[3 + axis]).abs() < 1e-8,
            "{state:?}"
        );
    }
}

/// Every part that takes or stores energy at once: gravity, wrench, offset mass, winding, gear,
/// elastic transmission with damping, friction in all joints, Ke that is not Kt.
#[test]
fn the_balance_closes_with_every_part_at_work() {
    let plant = "[plant]\nrecord_s = 0.001\n[plant.friction]\nmotor = { viscous_nm_s_rad = 0.05, coulomb_nm = 0.1 \
                 , stick_rad_s = 0.05 }\nelbow = { viscous_nm_s_rad = 0.01, coulomb_nm = 0.02, \
                 stick_rad_s = 0.05 }\nplatform = { viscous_nm_s_rad = 0.02 }\n[plant.transmission]\n\
                 stiffness_nm_rad = 3000\ndamping_nm_s_rad = 0.5\n";
    let vertical = edited(
        &text("vertical"),
        &[
            (
                "torque_constant_nm_a = 0.06",
                "torque_constant_nm_a = 0.06\nback_emf_constant_v_s_rad = 0.07",
            ),
            (
                "rate_hz = 5000\nkp_nm_rad = 300.0\nkd_nm_s_rad = 6.0\nki_nm_rad_s = 4000.0",
                "rate_hz = 2000\nkp_nm_rad = 400\nkd_nm_s_rad = 4",
            ),
            ("encoder_counts_per_rev = 16384\n", ""),
            ("[limits]", &format!("{plant}\n[limits]")),
        ],
    );
    let (outcome, _) = run(&parse(&vertical));
    assert_eq!(outcome.end, PlantEnd::Complete);
    assert!(outcome.balance.work > 1.0 && outcome.balance.losses > 1.0);
    assert!(outcome.tally.events > 0, "no joint stuck or slipped");
    assert!(
        outcome.balance.error().abs() < 1e-8,
        "{:?}",
        outcome.balance
    );
}

/// Under the loops of a board too: a voltage that jumps 10,000 times a second, by counts of encoders.
#[test]
fn the_balance_of_the_thesis_scene_closes_with_the_default_method() {
    let (outcome, _) = run(&shipped("plant-thesis"));
    assert_eq!(outcome.end, PlantEnd::Complete);
    assert!(outcome.reason.is_some() && outcome.balance.work > 0.0);
    assert!(
        outcome.balance.error().abs() < 1e-6,
        "{:?}",
        outcome.balance
    );
    // One step for each sample is half the time constant of the windings.
    let edits = [("[plant]\n", "[plant]\nmethod = \"rk4\"\nstep_s = 1e-4\n")];
    let (fast, _) = run(&parse(&edited(&text("plant-thesis"), &edits)));
    assert!((1e-4..1e-2).contains(&fast.balance.error().abs()));
}

#[test]
fn parts_that_are_not_named_take_no_part() {
    let dimension = |scene| run(&scene).0.dimension;
    let reference = text("plant-reference");
    assert_eq!(dimension(shipped("plant-reference")), 11);
    let elastic = edited(
        &reference,
        &[(
            "[job]",
            "[plant.transmission]\nstiffness_nm_rad = 5e3\ndamping_nm_s_rad = 1\n[job]",
        )],
    );
    assert_eq!(dimension(parse(&elastic)), 17);
    let start = reference.find("[[drive]]").unwrap();
    let end = reference.find("[plant]").unwrap();
    let ideal = format!("{}{}", &reference[..start], &reference[end..]);
    assert_eq!(dimension(parse(&ideal)), 8);
}
