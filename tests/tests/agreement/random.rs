//! 10,000 random machines in random states, away from singularities.

use crate::bounds::Stages;
use crate::format::Format;
use proptest::prelude::*;
use std::cell::{Cell, RefCell};
use trirrr_core::number::Coarse;
use trirrr_core::status::Status;
use trirrr_tests::evaluate::distances;
use trirrr_tests::motors::motors;
use trirrr_tests::random::{case, for_all};

const CASES: u32 = 10_000;

/// The worst of all cases, and in how many of them there is no motion or no bound: the errors of
/// the type are larger than what is left to where a leg ends.
fn worst<F: Format>() -> (Stages, u32) {
    let worst = RefCell::new(Stages::default());
    let out_of_reach = Cell::new(0);
    let far = case().prop_filter("too near to the parallel singularity", |case| {
        distances(&case.parameters, &case.setpoint.pose).1 > F::LEAST_PARALLEL
    });
    for_all(CASES, far, |case| {
        let parameters = &case.parameters;
        let (found, setpoint) = F::motors(parameters, &case.setpoint);
        let reference = motors::<f64>(parameters, &setpoint);
        let reference = reference.expect("a motion in f64");
        let bounds = F::bounds(parameters, &setpoint, |_| 0.0);
        match (found, bounds) {
            (Ok(found), Some(bounds)) => {
                let place = || format!("{case:?}");
                worst
                    .borrow_mut()
                    .compare(place, &found, &reference, &bounds);
            }
            (Err(Status::Unreachable { .. }), _) | (Ok(_), None) => {
                out_of_reach.set(out_of_reach.get() + 1);
            }
            (Err(status), _) => panic!("{}: {status}: {case:?}", F::NAME),
        }
    });
    (worst.into_inner(), out_of_reach.get())
}

/// A few torques in which larger parts cancel miss 2 u cond, by less than a factor of three.
#[test]
fn f32_agrees() {
    let (worst, out_of_reach) = worst::<f32>();
    assert_eq!(out_of_reach, 0);
    assert!((1..=10).contains(&worst.0[3].beyond), "{:?}", worst.0[3]);
    let brackets = [(0.7, 0.9), (0.7, 0.9), (0.8, 1.0), (2.2, 3.0)];
    worst.assert_within("f32, random machines", brackets);
}

#[test]
fn micromath_agrees() {
    let (worst, out_of_reach) = worst::<Coarse>();
    assert!((200..=400).contains(&out_of_reach), "{out_of_reach}");
    worst.assert_within("micromath, random machines", [(0.9, 1.0); 4]);
}
