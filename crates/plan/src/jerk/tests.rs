//! A motion whose least time is known.

use super::*;
use crate::passes::{controllable, duration, fastest};
use crate::rows::{Limited, Row, Rows};
use trirrr_service::admission::ModelLine;

/// Least time from rest to rest over `way` with limits of acceleration and jerk.
fn least_time(way: f64, acceleration: f64, jerk: f64) -> f64 {
    let ramp = acceleration / jerk;
    match way >= 2.0 * acceleration * ramp * ramp {
        true => ramp + (ramp * ramp + 4.0 * way / acceleration).sqrt(),
        false => (32.0 * way / jerk).cbrt(),
    }
}

/// A motor that turns evenly along the path: the S-curve in closed form.
#[test]
fn a_straight_way_takes_hardly_more_than_the_least_time() {
    let (way, acceleration) = (1.0, 20.0);
    let constant = |constant| ModelLine {
        constant,
        slope: 0.0,
        error: 0.0,
    };
    let count = 200;
    let mark = |index: usize| {
        let sin = (core::f64::consts::FRAC_PI_2 * index as f64 / count as f64).sin();
        way * sin * sin
    };
    let cells: Vec<Cell<f64>> = (0..count)
        .map(|index| {
            let mut rows = Rows::new();
            rows.push(Row {
                what: Limited::Acceleration(0),
                acceleration: Some(constant(1.0)),
                square: constant(0.0),
                rest: constant(0.0),
                limit: acceleration,
            });
            Cell::new(mark(index + 1) - mark(index), rows)
        })
        .collect();
    for jerk in [50.0, 200.0, 500.0, 2000.0, 10_000.0] {
        let limits = JerkLimits {
            limits: [jerk, f64::MAX, f64::MAX],
            turning: vec![[[1.0, 0.0], [0.0; 2], [0.0; 2]]; count],
            jumps: vec![[0.0; 3]; count],
            step_s: 0.003,
            cell_s: 0.003,
        };
        let mut squares = vec![0.0; count + 1];
        controllable(&cells, 0.0, &mut squares);
        fastest(&cells, 0.0, &mut squares);
        let without = duration(&cells, &squares);
        limit(&cells, &limits, &mut squares);
        let found = duration(&cells, &squares);
        let least = least_time(way, acceleration, jerk);
        println!(
            "jerk {jerk}: {found:.5} s, least {least:.5} s, {:.4}; without {without:.5} s",
            found / least
        );
        assert!(
            found > least * 0.995 && found < 1.02 * least,
            "{found} {least}"
        );
    }
}
