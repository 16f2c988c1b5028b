//! The thesis's own program against the core: what it gets right matches to rounding, what it gets
//! wrong differs exactly as `docs/errata.md` says. Every erratum that is a number has a test with
//! its number; `docs/errata.md` names it.
//!
//! `thesis_octave.csv` is the program as run; [`trirrr_tests::thesis_formula`] are its formulas.

mod driven;
mod fidelity;
mod wrong_formulas;
mod wrong_physics;

use trirrr_core::setpoint::{Pose, RestToRest, Setpoint};
use trirrr_core::tick::Motion;
use trirrr_tests::evaluate::evaluate;
use trirrr_tests::machines;
use trirrr_tests::table::{Row, Table};

/// The program's output, 101 rows.
fn program() -> Table {
    Table::read("thesis_octave.csv")
}

/// The state in a row of the program's output; its numbers are f64 in 17 digits, so exactly.
fn state(row: Row<'_>) -> Setpoint<f64> {
    let three = |columns: [&str; 3]| columns.map(|column| row.number(column)).into();
    Setpoint {
        pose: Pose::from_f64(row.number("xd"), row.number("yd"), row.number("alpha")),
        velocity: three(["vx", "vy", "valpha"]),
        acceleration: three(["ax", "ay", "aalpha"]),
    }
}

/// The core's motion of the thesis machine.
fn motion(setpoint: &Setpoint<f64>) -> Motion<f64> {
    evaluate(&machines::thesis(), setpoint).expect("the move is in reach")
}

/// The thesis's move, by the core.
fn job() -> RestToRest<f64> {
    use core::f64::consts::PI;
    let from = Pose::from_f64(0.21, 0.22, PI / 20.0);
    let to = Pose::from_f64(0.28, 0.28, PI / 15.0);
    RestToRest::new(from, to, 100, 0.01)
}

/// The true torques of the core over the move, one entry for each of the 101 samples.
fn true_torques() -> Vec<[f64; 3]> {
    (0..=100)
        .map(|tick| motion(&job().at(tick)).motors.map(|motor| motor.torque))
        .collect()
}

/// Power that the platform's kinetic energy takes: m v.a + I alphadot alphaddot.
fn kinetic_power(setpoint: &Setpoint<f64>) -> f64 {
    let platform = machines::thesis().platform;
    let (v, a) = (setpoint.velocity, setpoint.acceleration);
    platform.mass_kg * (v.x * a.x + v.y * a.y) + platform.inertia_kgm2 * v.z * a.z
}

/// Largest absolute value of each leg's entry.
fn peaks<'a>(values: impl IntoIterator<Item = &'a [f64; 3]>) -> [f64; 3] {
    values.into_iter().fold([0.0; 3], |peaks, values| {
        core::array::from_fn(|leg| f64::max(peaks[leg], values[leg].abs()))
    })
}

/// Asserts three figures to the digits given.
fn assert_figures(found: [f64; 3], expected: [f64; 3], half_a_digit: f64) {
    for (found, expected) in found.into_iter().zip(expected) {
        assert!(
            (found - expected).abs() <= half_a_digit,
            "{found} for {expected}"
        );
    }
}
