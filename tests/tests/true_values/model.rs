//! The independent model against the same files: what the property tests rest on.

use crate::{EXTREME, MOVE, moves};
use trirrr_core::machine::Parameters;
use trirrr_tests::bound::{Worst, error};
use trirrr_tests::double_double::DoubleDouble;
use trirrr_tests::inputs::Inputs;
use trirrr_tests::machines;
use trirrr_tests::results;
use trirrr_tests::scalar::Scalar;
use trirrr_tests::table::{Row, Table};

/// The model's conditions are those of extreme.csv, which were computed from 50 digits and printed
/// with five. (Those of the moves are against the inputs of the move, not of the state.) The file
/// perturbs the mass of all six links together, the model each link's mass, centre and inertia
/// alone: with links its condition of the torque may be larger.
#[test]
fn conditions_of_the_model_are_those_of_the_file() {
    let mut compared = 0;
    for row in Table::read("extreme.csv").rows() {
        let parameters = machines::of_row(row);
        let setpoint = machines::state_of_row::<f64>(row, EXTREME);
        let conditions = results::conditions(&parameters, &setpoint);
        for (name, of_model) in results::names().into_iter().zip(conditions) {
            let column = format!("cond_{}", name.column());
            if row.exact(&column).is_none() {
                continue;
            }
            let of_file = row.number(&column);
            let massless = parameters.links_are_massless() || name.stem != "tau";
            let most = if massless { 1.001 } else { 3.0 };
            assert!(
                (0.999 * of_file..=most * of_file).contains(&of_model),
                "{} {column}: {of_model} for {of_file}",
                row.text("case")
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 72 * 12);
}

/// The independent model, in 31 digits, gives the files' 25: truth of the property tests.
#[test]
fn the_model_gives_the_true_values() {
    let mut worst = Worst::default();
    let mut check =
        |label: &str, row: Row<'_>, parameters: &Parameters, acceleration: [&str; 3]| {
            let setpoint = machines::state_of_row::<f64>(row, acceleration);
            let mut inputs = Inputs::exact(parameters, &setpoint);
            // The files' rods are uniform to all digits, not with inertias rounded to f64.
            for leg in &mut inputs.legs {
                let [half, twelfth] = [0.5, 12.0].map(DoubleDouble::constant);
                (leg.c1, leg.c2) = (leg.l1 * half, leg.l2 * half);
                leg.i1 = leg.m1 * leg.l1 * leg.l1 / twelfth;
                leg.i2 = leg.m2 * leg.l2 * leg.l2 / twelfth;
            }
            // States of extreme.csv are f64 numbers; those of a move have 25 digits of their own.
            let exact = |column: &str| match acceleration {
                EXTREME => DoubleDouble::constant(row.number(column)),
                _ => row.exact(column).expect("a column of the state"),
            };
            inputs.position = [exact("x"), exact("y")];
            inputs.angle = exact("alpha");
            inputs.velocity = [exact("vx"), exact("vy")];
            inputs.angle_rate = exact("valpha");
            inputs.acceleration = [exact(acceleration[0]), exact(acceleration[1])];
            inputs.angle_acceleration = exact(acceleration[2]);
            let kinematics = inputs.kinematics();
            let truth = results::of_model(&kinematics, &inputs.dynamics(&kinematics));
            let conditions = results::conditions(parameters, &setpoint);
            for ((name, found), cond) in results::names().into_iter().zip(truth).zip(conditions) {
                if let Some(of_file) = row.exact(&name.column()) {
                    let nearest = found.value();
                    let error = error(name, nearest, of_file) - found.error_of(nearest);
                    // 25 digits of the result, and as many of the inputs.
                    let bound = 1e-24 * (nearest.abs() + cond);
                    worst.compare(|| format!("{label} {}", name.column()), error, bound);
                }
            }
        };
    for (file, parameters) in moves() {
        for row in Table::read(file).rows() {
            check(
                &format!("{file} t={}", row.text("t")),
                row,
                &parameters,
                MOVE,
            );
        }
    }
    for row in Table::read("extreme.csv").rows() {
        check(row.text("case"), row, &machines::of_row(row), EXTREME);
    }
    worst.assert_within("model", 1e-3..=1.0);
}
