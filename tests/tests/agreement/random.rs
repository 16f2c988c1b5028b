//! 10,000 random machines in random states, a tenth of them in a build without optimisation, away from singularities.

use crate::bounds::Stages;
use crate::format::{Format, results};
use proptest::prelude::*;
use std::cell::RefCell;
use trirrr_core::number::{Coarse, Fixed};
use trirrr_tests::evaluate::distances;
use trirrr_tests::motors::motors;
use trirrr_tests::random::{case, for_all, share};

const CASES: u32 = 10_000;

/// The worst of all cases; in how many of them there is no bound, or a leg does not reach: the
/// errors of the type are larger than what is left to where a leg ends; and how many do not fit
/// the type.
struct Found {
    worst: Stages,
    out_of_reach: u32,
    unfit: u32,
}

fn compare<F: Format>() -> Found {
    let found = RefCell::new(Found {
        worst: Stages::default(),
        out_of_reach: 0,
        unfit: 0,
    });
    let far = case().prop_filter("too near to a singularity", |case| {
        let (serial, parallel) = distances(&case.parameters, &case.setpoint.pose);
        let [least_serial, least_parallel] = F::LEAST;
        parallel > least_parallel && serial.iter().all(|&distance| distance > least_serial)
    });
    for_all(CASES, far, |case| {
        let parameters = &case.parameters;
        let (results, setpoint, units) = results::<F>(parameters, &case.setpoint);
        let mut found = found.borrow_mut();
        if let Err(reason) = &results {
            match reason.split_once(':') {
                Some(("unreachable", _)) => found.out_of_reach += 1,
                Some(("does not fit", _)) => found.unfit += 1,
                _ => panic!("{}: {reason}: {case:?}", F::NAME),
            }
            return;
        }
        let reference = motors::<f64>(parameters, &setpoint).expect("a motion in f64");
        match (results, F::bounds(parameters, &setpoint, &units, |_| 0.0)) {
            (Ok(results), Some(bounds)) => {
                let place = || format!("{case:?}");
                found.worst.compare(place, &results, &reference, &bounds);
            }
            _ => found.out_of_reach += 1,
        }
    });
    found.into_inner()
}

/// A few torques in which larger parts cancel miss 2 u cond, by less than a factor of three.
#[test]
fn f32_agrees() {
    let found = compare::<f32>();
    assert_eq!((found.out_of_reach, found.unfit), (0, 0));
    let beyond = found.worst.0[3].beyond;
    // A share of the cases may have none of them.
    assert!(
        beyond <= 10 && (beyond > 0 || cfg!(debug_assertions)),
        "{beyond}"
    );
    let least_torque = if cfg!(debug_assertions) { 1.4 } else { 2.2 };
    let brackets = [(0.7, 1.0), (0.6, 0.9), (0.8, 1.0), (least_torque, 3.0)];
    found.worst.assert_within("f32, random machines", brackets);
}

/// Every machine fits, and no rounding is worse than the sum of all of them says.
#[test]
fn fixed_agrees() {
    let found = compare::<Fixed>();
    assert_eq!((found.out_of_reach, found.unfit), (0, 0));
    let brackets = [(0.55, 1.0), (0.4, 0.8), (0.45, 0.9), (0.25, 0.6)];
    found
        .worst
        .assert_within("fixed, random machines", brackets);
}

#[test]
fn micromath_agrees() {
    let found = compare::<Coarse>();
    assert!(
        (share(200)..=share(400)).contains(&found.out_of_reach),
        "{}",
        found.out_of_reach
    );
    assert_eq!(found.unfit, 0);
    let brackets = [(0.9, 1.0); 4];
    found
        .worst
        .assert_within("micromath, random machines", brackets);
}
