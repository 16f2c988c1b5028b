//! The reference case of the plant: the motion that is known to 21 digits, and the steps at which
//! fixed-step methods lose it.

use trirrr_integrate::stability::choose;
use trirrr_integrate::{Failure, Integrator, Method, Spectrum, System};
use trirrr_plant::control::Continuous;
use trirrr_plant::{Control, Plant};
use trirrr_scene::Scene;

/// Platform, its rates, three currents, two records.
const N: usize = 11;

fn plant() -> (Plant<N>, [f64; N]) {
    let text = include_str!("../../../../scenes/plant-reference.toml");
    let scene = Scene::parse(text, "plant-reference.toml").unwrap();
    let continuous = Continuous::build(&scene, scene.controller.unwrap()).unwrap();
    Plant::build(&scene, Control::Continuous(Box::new(continuous))).unwrap()
}

/// Rows of the reference file: t, then nine state variables.
fn rows() -> Vec<[f64; 10]> {
    let path = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../../tests/reference/fd_continuous_pd.csv"
    );
    let mut reader = csv::Reader::from_path(path).unwrap();
    reader
        .records()
        .map(|record| {
            let record = record.unwrap();
            std::array::from_fn(|i| record[i].parse().unwrap())
        })
        .collect()
}

/// Largest error of pose (m, rad) at the rows up to where the run ends, and how it ends.
fn follow(
    method: Method,
) -> (
    f64,
    Result<(), Failure<impl std::fmt::Display + std::fmt::Debug>>,
) {
    let (mut plant, mut y) = plant();
    let mut integrator = Integrator::new(&plant, method).unwrap();
    let rows = rows();
    assert_eq!(rows.len(), 1201);
    let mut error: f64 = 0.0;
    let mut next = 1;
    let end = integrator.run(&mut plant, 0.0, &mut y, 1.2, |_, step| {
        while let Some(row) = rows.get(next)
            && row[0] <= step.end()
        {
            let state = step.at(row[0]);
            for i in 0..3 {
                error = error.max((state[i] - row[1 + i]).abs());
            }
            next += 1;
        }
    });
    if end.is_ok() {
        assert_eq!(next, 1201, "every row was compared");
    }
    (error, end.map(|_| ()))
}

#[test]
fn adaptive_methods_keep_to_1e_9_at_their_default_tolerance() {
    for method in [
        Method::DormandPrince {
            tolerance: Method::DORMAND_PRINCE_TOLERANCE,
        },
        Method::RadauIia {
            tolerance: Method::RADAU_IIA_TOLERANCE,
        },
    ] {
        let (error, end) = follow(method);
        end.unwrap();
        assert!(error < 1e-9, "{method:?}: {error:e}");
    }
}

#[test]
fn the_default_is_implicit_for_rows_and_explicit_for_samples() {
    let (plant, y) = plant();
    let spectrum = Spectrum::of(&plant, 0.0, &y).unwrap();
    // R/L is 5000 1/s, and stability ends near 3.3 of it: 6.6e-4 s, between a row's millisecond
    // and a sample's tenth of one.
    let choice = choose(&spectrum, 1e-3, None);
    let tolerance = Method::RADAU_IIA_TOLERANCE;
    assert_eq!(choice.method, Method::RadauIia { tolerance });
    assert!(
        (choice.explicit_step_s / 6.6e-4 - 1.0).abs() < 0.05,
        "{choice}"
    );
    let tolerance = Method::DORMAND_PRINCE_TOLERANCE;
    assert_eq!(
        choose(&spectrum, 1e-4, None).method,
        Method::DormandPrince { tolerance }
    );
}

/// The limits that are known of this case: RK4 5.62e-4 s, semi-implicit Euler 4.05e-4 s. A percent
/// below, the motion is followed; a percent above, it is lost: the motors shake between the limits
/// of their voltage. The linearisation agrees to half a percent.
fn check_limit(method: fn(f64) -> Method, known: f64, followed: f64) {
    let (plant, y) = plant();
    let spectrum = Spectrum::of(&plant, 0.0, &y).unwrap();
    let limit = spectrum.longest_step(&method(known), plant.positions());
    assert!(
        (limit / known - 1.0).abs() < 0.005,
        "{limit:e} for {known:e}"
    );
    let (below, end) = follow(method(0.99 * known));
    end.unwrap();
    assert!(below < followed, "{below:e}");
    let (above, end) = follow(method(1.01 * known));
    assert!(above > 1e-3 || end.is_err(), "{above:e}");
}

#[test]
fn rk4_is_stable_to_its_known_limit() {
    // Order 4 of a loop with time constants of 1 / 1000 s: far below what instability leaves.
    check_limit(|step_s| Method::Rk4 { step_s }, 5.62e-4, 1e-8);
}

#[test]
fn semi_implicit_euler_is_stable_to_its_known_limit() {
    // Order 1: half a step of the joints' acceleration times the loop's time constant, some 1e-6.
    check_limit(|step_s| Method::SemiImplicitEuler { step_s }, 4.05e-4, 1e-5);
}
