//! Singularities are located by every method; where its step is too coarse, the energy says so.

use crate::ends::{reference, sampled};
use crate::reference::run;
use trirrr_integrate::{System, jacobian};
use trirrr_plant::watch::{Cause, Ending};
use trirrr_plant::{Outcome, Plant, PlantEnd};
use trirrr_scene::{Method, Scene};

const FALLS: [(&str, &str); 3] = [
    (
        "number = \"f64\"",
        "number = \"f64\"\ngravity_m_s2 = [0.0, -9.81]",
    ),
    ("kp_nm_rad = 2000.0", "kp_nm_rad = 0.0"),
    ("kd_nm_s_rad = 5.0", "kd_nm_s_rad = 0.0"),
];

fn by(mut scene: Scene, method: Method) -> Outcome {
    if let Some(plant) = &mut scene.plant {
        plant.method = method;
    }
    run(&scene).0
}

fn ending(outcome: &Outcome) -> Ending {
    match &outcome.end {
        PlantEnd::Ended(ending) => *ending,
        other => panic!("{other:?}"),
    }
}

/// Both adaptive methods at 1e-12, which agree.
fn known(scene: &Scene) -> Ending {
    let tolerance = Some(1e-12);
    let one = by(scene.clone(), Method::RadauIia { tolerance });
    let two = by(scene.clone(), Method::DormandPrince { tolerance });
    for outcome in [&one, &two] {
        assert!(
            outcome.balance.error().abs() < 1e-10,
            "{:?}",
            outcome.balance
        );
    }
    let (one, two) = (ending(&one), ending(&two));
    assert_eq!(one.cause, two.cause);
    assert!((one.t - two.t).abs() < 1e-11, "{one:?} {two:?}");
    one
}

#[test]
fn a_fall_ends_at_its_first_fold_by_every_method() {
    let scene = reference(&FALLS);
    let fold = known(&scene);
    assert_eq!(fold.cause, Cause::Serial(1));
    for tolerance in [1e-4, 3e-8, 1e-10].map(Some) {
        for method in [
            Method::RadauIia { tolerance },
            Method::DormandPrince { tolerance },
        ] {
            let found = ending(&by(scene.clone(), method));
            assert_eq!(found.cause, fold.cause);
            assert!((found.t - fold.t).abs() < 1e-8, "{method:?}: {found:?}");
        }
    }
    let found = ending(&by(scene.clone(), Method::Rk4 { step_s: 1e-4 }));
    assert!((found.t - fold.t).abs() < 1e-9, "{found:?}");
    // Order 1: the times of semi-implicit Euler are half a step early.
    for step_s in [1e-3, 1e-4, 1e-5] {
        let outcome = by(scene.clone(), Method::SemiImplicitEuler { step_s });
        let PlantEnd::EnergyLost(loss) = &outcome.end else {
            panic!("{:?}", outcome.end);
        };
        println!("{loss}");
        assert!(loss.missing.abs() > loss.allowed && loss.t <= fold.t);
    }
}

#[test]
fn a_fold_between_two_samples_is_located() {
    for rate in [50, 20] {
        let (tick, own) = (
            format!("tick_rate_hz = {rate}"),
            format!("rate_hz = {rate}"),
        );
        let slow = [
            ("tick_rate_hz = 10000", tick.as_str()),
            ("rate_hz = 10000", own.as_str()),
        ];
        let scene = sampled(&[&FALLS[..], &slow].concat());
        let fold = known(&scene);
        assert!(matches!(fold.cause, Cause::Serial(_)));
        let by_default = by(scene, Method::Auto { tolerance: None });
        let found = ending(&by_default);
        assert_eq!(found.cause, fold.cause);
        assert!((found.t - fold.t).abs() < 1e-6, "{found:?} {fold:?}");
        assert!(by_default.balance.stored.is_finite());
    }
}

/// A stick region changes a motion by what a joint creeps in it: the difference shrinks with the region.
#[test]
fn narrow_stick_regions_run_and_agree() {
    let pose = |stick: &str| {
        let friction = format!(
            "[plant.friction]\nmotor = {{ coulomb_nm = 0.5, stick_rad_s = {stick} }}\n\n[controller]"
        );
        let (outcome, rows) = run(&reference(&[("[controller]", &friction)]));
        assert_eq!(outcome.end, PlantEnd::Complete);
        assert!(
            outcome.balance.error().abs() < 1e-10,
            "{:?}",
            outcome.balance
        );
        rows.last().unwrap().pose
    };
    // Narrower ones run too, mostly: where a region is crossed within the resolution of time, luck decides.
    let narrowest = pose("1e-11");
    for (stick, width) in [("1e-5", 1e-5), ("1e-6", 1e-6), ("1e-9", 1e-9)] {
        for (one, other) in pose(stick).iter().zip(narrowest) {
            // A joint creeps for 1.2 s by less than the region's width; the platform turns by up to 50
            // times as much.
            assert!((one - other).abs() < 60.0 * width, "{stick}: {one} {other}");
        }
    }
}

/// Dual numbers through the equations against differences of their values, in both kinds of coordinates.
#[test]
fn the_jacobian_is_that_of_the_equations() {
    fn compare<const N: usize>(scene: &Scene) {
        let control = trirrr_plant::control_of(scene).unwrap();
        let (mut plant, mut y): (Plant<N>, _) = Plant::build(scene, control).unwrap();
        for (i, value) in y[3..].iter_mut().enumerate() {
            *value += 0.1 + 0.01 * i as f64;
        }
        for leading in [false, true] {
            if leading {
                // Leg 3 at 0.1 rad from its full length.
                (y[0], y[1], y[2]) = (0.25, 0.4195, 0.0);
                plant.choose_coordinates(&mut y).unwrap();
                assert_eq!(plant.leading(), Some(2));
            }
            let (mut exact, mut differences) = ([[0.0; N]; N], [[0.0; N]; N]);
            plant.jacobian(0.1, &y, &mut exact).unwrap();
            let derivative = |t, y: &_, dy: &mut _| plant.derivative(t, y, dy);
            jacobian::central(derivative, &plant.scales(), 0.1, &y, &mut differences).unwrap();
            for (row, other) in exact.iter().zip(&differences) {
                let size = row
                    .iter()
                    .fold(1.0, |most: f64, entry| most.max(entry.abs()));
                for (entry, other) in row.iter().zip(other) {
                    // Differences over 6e-6 of a scale miss (6e-6 * 0.4 * 250 * 4)^2 / 6 of a stepper's detent
                    // torque, a sine of 1000 times the joint's angle.
                    assert!(
                        (entry - other).abs() < 1e-5 * size,
                        "{entry} {other} of {size}"
                    );
                }
            }
        }
    }
    let elastic = "[plant.transmission]\nstiffness_nm_rad = 5e3\ndamping_nm_s_rad = 1\n[job]";
    compare::<11>(&reference(&[]));
    compare::<17>(&reference(&[("[job]", elastic)]));
    compare::<8>(&crate::scenes::without_drives("thesis-links"));
    let steppers = crate::ends::steppers(0.2);
    compare::<8>(&steppers);
}
