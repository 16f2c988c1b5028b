//! The closed loop of `fd_continuous_pd.csv`: forward dynamics, drives and controller against a
//! solution of 21 digits.

use crate::scenes::{attempt, edited, parse, shipped, text};
use std::path::PathBuf;
use trirrr_plant::table::Row;
use trirrr_plant::{Outcome, PlantEnd};
use trirrr_scene::Scene;

/// Runs a scene's plant.
pub(crate) fn run(scene: &Scene) -> (Outcome, Vec<Row>) {
    let (outcome, rows) = attempt(scene).unwrap_or_else(|refusal| panic!("{refusal}"));
    println!(
        "{}: {:?}, {} steps, {} derivatives, {:.0} times real time, balance {:.1e} of {:.3e} J",
        scene.name,
        outcome.end,
        outcome.tally.steps,
        outcome.tally.derivatives,
        outcome.ratio(),
        outcome.balance.error(),
        outcome.balance.scale,
    );
    (outcome, rows)
}

/// Rows of the reference file, by column.
fn reference() -> Vec<Vec<f64>> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR"))
        .join("../../tests/reference/fd_continuous_pd.csv");
    let mut reader = csv::Reader::from_path(&file).unwrap();
    let header: Vec<String> = reader.headers().unwrap().iter().map(Into::into).collect();
    assert_eq!(header[..10].join(","), "t,x,y,alpha,vx,vy,valpha,i1,i2,i3");
    let number = |field: &str| field.parse().unwrap();
    reader
        .records()
        .map(|record| record.unwrap().iter().map(number).collect())
        .collect()
}

/// Largest differences of pose, rates and currents from the reference file.
fn differences(rows: &[Row]) -> [f64; 3] {
    let reference = reference();
    assert_eq!((rows.len(), reference.len()), (1201, 1201));
    let mut worst = [0.0_f64; 3];
    for (row, truth) in rows.iter().zip(&reference) {
        let values = row.values();
        assert!((values[0] - truth[0]).abs() < 1e-12, "{}", values[0]);
        for column in 1..10 {
            let difference = (values[column] - truth[column]).abs();
            let worst = &mut worst[(column - 1) / 3];
            *worst = worst.max(difference);
        }
    }
    worst
}

#[test]
fn the_reference_case_agrees_to_1e_9_with_the_default_method_and_tolerance() {
    let (outcome, rows) = run(&shipped("plant-reference"));
    assert_eq!(outcome.end, PlantEnd::Complete);
    assert!(outcome.reason.is_some(), "the default chooses");
    let [pose, rates, currents] = differences(&rows);
    println!("pose {pose:.1e} m or rad, rates {rates:.1e}, currents {currents:.1e} A");
    assert!(pose < 1e-9, "{pose}");
    // Rates differ by the same over the loop's fastest time, 1 / 500 s, and currents by kp, in
    // 2000 N m/rad through 0.5 N m/A.
    assert!(rates < 5e-7 && currents < 4e-6, "{rates} {currents}");
    assert!(
        outcome.balance.error().abs() < 1e-8,
        "{:?}",
        outcome.balance
    );
    assert!(outcome.balance.work > 0.0);
}

#[test]
fn a_sampled_controller_differs_from_the_continuous_one_by_its_delay() {
    let (outcome, rows) = run(&shipped("plant-reference-zoh"));
    assert_eq!(outcome.end, PlantEnd::Complete);
    let [pose, ..] = differences(&rows);
    println!("pose {pose:.1e} m or rad");
    // Held for 0.1 ms, a command is 0.05 ms old on average. The machine moves at up to 0.1 m/s: the
    // delay as such would be 5e-6 m; the loop sees it in the velocity of its error only.
    assert!((1e-9..5e-6).contains(&pose), "{pose}");
    assert!(
        outcome.balance.error().abs() < 1e-8,
        "{:?}",
        outcome.balance
    );
}

#[test]
fn a_stiff_winding_under_a_sampled_controller_is_followed_in_few_steps() {
    // L/R is 2e-6 s, and a sample is 50 times that.
    let stiff = |tolerance: &str| {
        let edits = [
            ("inductance_h = 1e-4", "inductance_h = 1e-6"),
            ("settle_s = 0.2", tolerance),
        ];
        run(&parse(&edited(&text("plant-reference-zoh"), &edits)))
    };
    let (by_default, rows) = stiff("settle_s = 0.2");
    assert_eq!(by_default.end, PlantEnd::Complete);
    assert_eq!(by_default.method.name(), "radau-iia");
    assert!(by_default.tally.rejected < 120, "{:?}", by_default.tally);
    assert!(
        by_default.tally.steps < 4 * 12_000,
        "{:?}",
        by_default.tally
    );
    let (tight, exact) = stiff("settle_s = 0.2\ntolerance = 1e-10");
    assert!(tight.tally.steps > by_default.tally.steps);
    let mut worst: f64 = 0.0;
    for (row, exact) in rows.iter().zip(&exact) {
        for (value, exact) in row.pose.iter().zip(exact.pose) {
            worst = worst.max((value - exact).abs());
        }
    }
    println!("pose {worst:.1e} m or rad");
    assert!(worst < 1e-9, "{worst}");
}
