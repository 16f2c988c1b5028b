//! Machines off the usual shapes: links of very unequal lengths, and equal links folded onto the base
//! joint in motion. The motors' results against the independent model, in units of 2 u cond.

use super::truth::rounded;
use proptest::strategy::Strategy;
use std::cell::RefCell;
use trirrr_core::number::Number;
use trirrr_tests::bound::{Worst, error};
use trirrr_tests::evaluate::evaluate;
use trirrr_tests::random::{Case, Shorter, folded_case, for_all, unequal_case};
use trirrr_tests::results;

/// Worst error of the motors' angles, rates, accelerations and torques.
fn worst<N: Number>(cases: impl Strategy<Value = Case>) -> Worst {
    let worst = RefCell::new(Worst::default());
    for_all(400, cases, |case| {
        let (parameters, setpoint) = (&case.parameters, rounded::<N>(&case.setpoint));
        // In f32 the rounding of the pose takes a few of the short links out of reach.
        let Ok(motion) = evaluate(parameters, &setpoint) else {
            return;
        };
        let found = results::of_core(parameters, &setpoint, &motion).expect("finite results");
        let truth = results::truth(parameters, &setpoint);
        let conditions = results::isotropic_conditions(parameters, &setpoint);
        let listed = results::names().into_iter().zip(found).zip(truth);
        for (((name, found), truth), cond) in listed.zip(conditions) {
            if ["th1", "dth1", "ddth1", "tau"].contains(&name.stem) {
                worst.borrow_mut().compare(
                    || format!("{} of {case:?}", name.column()),
                    error(name, found, truth),
                    2.0 * N::UNIT_ROUNDOFF.to_f64() * cond,
                );
            }
        }
    });
    worst.into_inner()
}

#[test]
fn a_short_proximal_link_loses_no_digits() {
    for decades in [1.0, 2.5, 4.0] {
        let cases = || unequal_case(Shorter::Proximal, decades..decades + 0.5);
        let what = format!("1 : 10^{decades}");
        worst::<f64>(cases()).assert_within(&what, 0.3..=1.3);
        worst::<f32>(cases()).assert_within(&what, 0.3..=1.3);
    }
}

/// The distal link is a difference that keeps the absolute error of the proximal one. A result misses
/// 2 u cond where cond is small by coincidence: the links at right angles.
#[test]
fn a_short_distal_link_rarely_loses_digits() {
    let check = |what: &str, worst: Worst| {
        worst.assert_within(what, 1.0..=100.0);
        assert!(
            worst.beyond * 200 < worst.compared,
            "{what}: {}",
            worst.beyond
        );
    };
    for decades in [1.5, 3.0] {
        let cases = || unequal_case(Shorter::Distal, decades..decades + 0.5);
        check(&format!("10^{decades} : 1, f64"), worst::<f64>(cases()));
        check(&format!("10^{decades} : 1, f32"), worst::<f32>(cases()));
    }
}

/// The reaction of a distal link is a difference of two accelerations' parts that is small where the
/// platform joint is near the link's centre of percussion.
#[test]
fn a_leg_folded_onto_its_base_joint_loses_digits_of_torques_only() {
    for decades in [1.0, 4.0, 8.0, 12.0] {
        let massless = || folded_case(decades..decades + 1.0, false);
        let what = format!("folded but for 10^-{decades}");
        worst::<f64>(massless()).assert_within(&what, 0.3..=1.3);
        let heavy = worst::<f64>(folded_case(decades..decades + 1.0, true));
        heavy.assert_within(&what, 0.3..=200.0);
        assert!(
            heavy.beyond * 100 < heavy.compared,
            "{what}: {}",
            heavy.beyond
        );
    }
}
