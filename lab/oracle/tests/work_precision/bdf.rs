//! A plant by diffsol's backward differentiation formulae: other formulae than those of
//! `trirrr_integrate`, another implementation, another control of the error.

use diffsol::{NalgebraLU, NalgebraMat, OdeBuilder, OdeSolverMethod};
use std::cell::RefCell;
use trirrr_integrate::{Matrix, System};
use trirrr_plant::Plant;

/// Error allowed each step, relative to a variable and to its usual size. Not less: angles are
/// rounded to some 1e-16 rad, and what kp and a spring make of that stands in currents and rates.
const TOLERANCE: f64 = 1e-11;

/// States of `plant` at `instants`, which rise, from the state `start` at the time `t`. The plant
/// stays in its mode.
pub(crate) fn solve<const N: usize>(
    plant: &Plant<N>,
    (t, start): (f64, &[f64; N]),
    instants: &[f64],
) -> Vec<[f64; N]> {
    // Energies are recorded only; their scale is infinite, and so is the error that they may have.
    let allowed = plant.scales().map(|scale| TOLERANCE * scale.min(1e20));
    let span = instants.last().map_or(0.0, |last| last - t);
    let state = |x: &[f64]| -> [f64; N] { x.try_into().unwrap() };
    // diffsol asks for the product with one column after the other.
    let jacobian: RefCell<Option<(f64, [f64; N], Matrix<N>)>> = RefCell::new(None);
    let mut problem = OdeBuilder::<NalgebraMat<f64>>::new()
        .t0(t)
        .rtol(TOLERANCE)
        .atol(allowed)
        .h0(1e-7_f64.min(0.1 * span))
        .rhs_implicit(
            |x: &[f64], _: &[f64], t: f64, slope: &mut [f64]| {
                let mut dy = [f64::NAN; N];
                if plant.derivative(t, &state(x), &mut dy).is_err() {
                    dy = [f64::NAN; N];
                }
                slope.copy_from_slice(&dy);
            },
            |x: &[f64], _: &[f64], t: f64, v: &[f64], product: &mut [f64]| {
                let y = state(x);
                let mut kept = jacobian.borrow_mut();
                let known = kept
                    .as_ref()
                    .is_some_and(|(at, of, _)| *at == t && *of == y);
                if !known {
                    let mut found = [[0.0; N]; N];
                    if plant.jacobian(t, &y, &mut found).is_err() {
                        found = [[f64::NAN; N]; N];
                    }
                    *kept = Some((t, y, found));
                }
                let (_, _, matrix) = kept.as_ref().unwrap();
                for (product, row) in product.iter_mut().zip(matrix) {
                    *product = row.iter().zip(v).map(|(entry, v)| entry * v).sum();
                }
            },
        )
        .init(
            |_: &[f64], _: f64, y: &mut [f64]| y.copy_from_slice(start),
            N,
        )
        .build()
        .unwrap();
    // Counted over a whole solve, and a run may take a million steps.
    problem.ode_options.max_nonlinear_solver_failures = 100_000;
    problem.ode_options.max_error_test_failures = 100_000;
    let mut solver = problem.bdf::<NalgebraLU<f64>>().unwrap();
    let (columns, _) = solver.solve_dense(instants).unwrap();
    (0..instants.len())
        .map(|column| std::array::from_fn(|i| columns[(i, column)]))
        .collect()
}
