//! The kinematics in `fd_continuous_pd.csv`, a closed-loop run of the machine: motor angles and
//! rates of the states it passes through, and the motor angles of the setpoints it follows.
//!
//! The states lie off the commanded path, at 1201 instants that no other file has. Its angles and
//! rates have 17 digits: half a unit in the last place of the truth is granted for that.

use trirrr_core::number::Arithmetic;
use trirrr_core::setpoint::{Pose, RestToRest, Setpoint};
use trirrr_tests::bound::{Worst, error};
use trirrr_tests::evaluate::evaluate;
use trirrr_tests::machines;
use trirrr_tests::results;
use trirrr_tests::table::{Row, Table};

const FILE: &str = "fd_continuous_pd.csv";

/// Compares motor angles, and rates where the file has them, with the columns `<stem>1` to
/// `<stem>3`.
fn compare(worst: &mut Worst, row: Row<'_>, setpoint: &Setpoint<f64>, stems: &[(&str, &str)]) {
    let parameters = machines::thesis();
    let motion = evaluate(&parameters, setpoint).expect("a motion");
    let found = results::of_core(&parameters, setpoint, &motion).expect("finite results");
    let conditions = results::conditions(&parameters, setpoint);
    for ((name, found), cond) in results::names().into_iter().zip(found).zip(conditions) {
        let Some((_, column)) = stems.iter().find(|(stem, _)| *stem == name.stem) else {
            continue;
        };
        let column = format!("{column}{}", name.leg.expect("a motor") + 1);
        let truth = row.exact(&column).expect("a number");
        let printed = f64::UNIT_ROUNDOFF * row.number(&column).abs();
        worst.compare(
            || format!("t={} {column}", row.text("t")),
            error(name, found, truth),
            2.0 * f64::UNIT_ROUNDOFF * cond + printed,
        );
    }
}

#[test]
fn states_have_the_motor_angles_and_rates_of_the_closed_loop_run() {
    let mut worst = Worst::default();
    let table = Table::read(FILE);
    assert_eq!(table.rows().len(), 1201);
    for row in table.rows() {
        // The file has no accelerations, and angles and rates do not depend on them.
        let state = machines::state_of_row(row, ["vx", "vy", "valpha"]);
        compare(
            &mut worst,
            row,
            &state,
            &[("th1", "th1_"), ("dth1", "dth1_")],
        );
    }
    worst.assert_within("closed loop, states", 0.4..=1.0);
}

#[test]
fn setpoints_have_the_motor_angles_of_the_closed_loop_run() {
    use core::f64::consts::PI;
    let from = Pose::<f64>::from_f64(0.21, 0.22, PI / 20.0);
    let to = Pose::from_f64(0.28, 0.28, PI / 15.0);
    let job = RestToRest::new(from, to, 1000, 0.001);
    let mut worst = Worst::default();
    for (tick, row) in (0..).zip(Table::read(FILE).rows()) {
        // After a second the job stands at its end, and so does the file.
        compare(&mut worst, row, &job.at(tick), &[("th1", "thref_")]);
    }
    worst.assert_within("closed loop, setpoints", 0.2..=1.0);
}
