//! Order of convergence, and of the dense output, on a problem with a solution in closed form.

use crate::problems::Oscillator;
use trirrr_integrate::{Dense, Integrator, Method};

/// Span of the runs in s: not a multiple of the period, so that no error cancels.
const SPAN: f64 = 5.0;

/// Largest error at the end, and largest error of the dense output anywhere.
fn errors(method: Method) -> (f64, f64) {
    let mut system = Oscillator;
    let mut integrator = Integrator::new(&system, method).unwrap();
    let mut y = Oscillator::START;
    let off = |t: f64, y: [f64; 3]| {
        let truth = Oscillator::solution(t);
        (0..3).fold(0.0, |most: f64, i| most.max((y[i] - truth[i]).abs()))
    };
    let mut dense_error: f64 = 0.0;
    let observe = |_: &Oscillator, step: &Dense<3>| {
        for part in 1..8 {
            let t = step.start() + f64::from(part) / 8.0 * (step.end() - step.start());
            dense_error = dense_error.max(off(t, step.at(t)));
        }
    };
    integrator
        .run(&mut system, 0.0, &mut y, SPAN, observe)
        .unwrap();
    (off(SPAN, y), dense_error)
}

/// Halving the step divides the error by 2^order: the exponent from two steps is the order up to
/// the next term of the expansion, here within 0.25.
fn check_order(method: fn(f64) -> Method, step_s: f64, order: f64, dense_order: f64) {
    let (coarse, coarse_dense) = errors(method(step_s));
    let (fine, fine_dense) = errors(method(0.5 * step_s));
    let found = (coarse / fine).log2();
    assert!((found - order).abs() < 0.25, "order {found}");
    let found = (coarse_dense / fine_dense).log2();
    assert!(
        (found - dense_order).abs() < 0.3,
        "order of the dense output {found}"
    );
}

#[test]
fn semi_implicit_euler_is_of_order_1() {
    check_order(
        |step_s| Method::SemiImplicitEuler { step_s },
        1.0 / 1024.0,
        1.0,
        1.0,
    );
}

#[test]
fn rk4_is_of_order_4_and_so_is_its_dense_output() {
    // The interpolant is of order 3, its error of order h^4 like what has added up by then.
    check_order(|step_s| Method::Rk4 { step_s }, 1.0 / 64.0, 4.0, 4.0);
}

/// Steps are chosen from the tolerance: the error per derivative falls with the order.
fn order_by_work(method: fn(f64) -> Method, coarse: f64, fine: f64) -> f64 {
    let work = |tolerance: f64| {
        let mut system = Oscillator;
        let mut integrator = Integrator::new(&system, method(tolerance)).unwrap();
        let mut y = Oscillator::START;
        integrator
            .run(&mut system, 0.0, &mut y, SPAN, |_, _| {})
            .unwrap();
        (errors(method(tolerance)).0, integrator.tally().steps as f64)
    };
    let (coarse, fine) = (work(coarse), work(fine));
    (coarse.0 / fine.0).ln() / (fine.1 / coarse.1).ln()
}

#[test]
fn dormand_prince_is_of_order_5() {
    let order = order_by_work(|tolerance| Method::DormandPrince { tolerance }, 1e-6, 1e-11);
    assert!((4.7..5.6).contains(&order), "order {order}");
}

#[test]
fn radau_iia_is_of_order_5() {
    let order = order_by_work(|tolerance| Method::RadauIia { tolerance }, 1e-7, 1e-11);
    assert!((4.6..5.4).contains(&order), "order {order}");
}

#[test]
fn adaptive_methods_keep_the_error_near_the_tolerance() {
    // Steps of a smooth problem over SPAN: some tens to a thousand, each with an error up to the
    // tolerance, and the global error their sum. Below by the safety factors of the control.
    for tolerance in [1e-4, 1e-6, 1e-8, 1e-10] {
        for method in [
            Method::DormandPrince { tolerance },
            Method::RadauIia { tolerance },
        ] {
            let (error, dense_error) = errors(method);
            assert!(
                (1e-3 * tolerance..100.0 * tolerance).contains(&error),
                "{method:?}: error {error:e}"
            );
            assert!(
                dense_error < 1e3 * tolerance.powf(0.8),
                "{method:?}: {dense_error:e}"
            );
        }
    }
}
