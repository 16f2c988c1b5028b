//! Vector loops with known solutions, and the systems that are refused.

use super::*;
use core::f64::consts::PI;
use trirrr_core::number::Arithmetic;

/// z1 e^(i phi1) + z2 e^(i phi2) + z3 e^(i (phi2 - delta)) - z4 = 0 in phi2 and z2.
fn worked_example<N: Number>() -> [Term<N>; 4] {
    [
        Term::new(0, Length::Constant(0.1), Reference::Driven(0), 0.0),
        Term::new(0, Length::Unknown(1), Reference::Unknown(0), 0.0),
        Term::new(
            0,
            Length::Constant(0.17),
            Reference::Unknown(0),
            -84.0 * (PI / 180.0),
        ),
        Term::new(0, Length::Constant(0.4), Reference::Fixed, 0.0).reversed(),
    ]
}

fn crank<N: Number>(rate: f64, acceleration: f64) -> [ClosureInput<N>; 1] {
    [ClosureInput {
        value: N::from_f64(PI / 3.0),
        rate: N::from_f64(rate),
        acceleration: N::from_f64(acceleration),
    }]
}

// Found independently: with 40 digits in mpmath, phi2 and z2 by its root finder, rates and
// accelerations by differentiating the root.
const PHI2: f64 = 0.245_494_981_327_606_6;
const Z2: f64 = 0.300_688_584_228_405_1;

#[test]
fn closes_the_worked_example() {
    let terms = worked_example::<f64>();
    let closure = Closure::<f64, 2, 1>::new(&terms).unwrap();
    let inputs = crank(2.0, -3.0);
    let at = closure.position(&inputs, [0.2, 0.3]).unwrap();
    let rates = closure.rates(&inputs, &at).unwrap();
    let acc = closure.accelerations(&inputs, &at, &rates).unwrap();
    for (found, true_value) in [
        (at.unknowns[0], PHI2),
        (at.unknowns[1], Z2),
        (rates[0], -0.436_781_884_911_654_4),
        (rates[1], 0.217_554_403_659_960_26),
        (acc[0], 2.053_187_283_912_183),
        (acc[1], -0.223_743_389_602_775_4),
    ] {
        assert!(
            (found - true_value).abs() < 1e-15,
            "{found} for {true_value}"
        );
    }
    assert!(at.residual <= 4.0 * f64::UNIT_ROUNDOFF, "{}", at.residual);
    assert!((3..8).contains(&at.iterations), "{}", at.iterations);
    assert!((1.7..1.9).contains(&at.condition), "{}", at.condition);
}

#[test]
fn closes_it_in_f32() {
    let terms = worked_example::<f32>();
    let closure = Closure::<f32, 2, 1>::new(&terms).unwrap();
    let at = closure.position(&crank(0.0, 0.0), [0.2, 0.3]).unwrap();
    assert!((f64::from(at.unknowns[0]) - PHI2).abs() < 3e-7);
    assert!((f64::from(at.unknowns[1]) - Z2).abs() < 1e-7);
}

#[test]
fn a_guess_on_the_other_side_finds_the_other_branch() {
    let terms = worked_example::<f64>();
    let closure = Closure::<f64, 2, 1>::new(&terms).unwrap();
    let at = closure
        .position(&crank(0.0, 0.0), [0.2 + PI, -0.4])
        .unwrap();
    assert!(at.unknowns[1] < -0.2, "{:?}", at.unknowns);
    assert!(at.residual <= 4.0 * f64::UNIT_ROUNDOFF);
}

#[test]
fn says_that_links_do_not_reach() {
    let bars = |reach: f64| {
        [
            Term::<f64>::new(0, Length::Constant(1.0), Reference::Unknown(0), 0.0),
            Term::new(0, Length::Constant(1.0), Reference::Unknown(1), 0.0),
            Term::new(0, Length::Constant(reach), Reference::Fixed, 0.0).reversed(),
        ]
    };
    let terms = bars(2.5);
    let closure = Closure::<f64, 2, 0>::new(&terms).unwrap();
    match closure.position(&[], [0.5, -0.4]) {
        Err(ClosureStatus::NotConverged {
            iterations,
            residual,
        }) => {
            assert_eq!(iterations, MAX_ITERATIONS);
            assert!(residual > 0.05, "{residual}");
        }
        other => panic!("{other:?}"),
    }
    // Two bars in one line from the start, or at the only place where they reach.
    let parallel = closure.position(&[], [0.0, 0.0]);
    assert_eq!(
        parallel,
        Err(ClosureStatus::SingularJacobian { iterations: 0 })
    );
    let terms = bars(2.0);
    let closure = Closure::<f64, 2, 0>::new(&terms).unwrap();
    // Just reaching: the root is double and the loops close long before it is found. The
    // condition number tells.
    match closure.position(&[], [0.5, -0.4]) {
        Ok(at) => assert!(at.condition > 1e7, "{at:?}"),
        Err(status) => assert!(matches!(status, ClosureStatus::SingularJacobian { .. })),
    }
    let far = closure.position(&[], [f64::MAX, f64::NAN]);
    assert_eq!(far, Err(ClosureStatus::OutOfRange { iterations: 0 }));
}

/// A slide that is driven: two bars between its ends.
#[test]
fn drives_a_length() {
    let terms = [
        Term::<f64>::new(0, Length::Constant(3.0), Reference::Unknown(0), 0.0),
        Term::new(0, Length::Constant(4.0), Reference::Unknown(1), 0.0),
        Term::new(0, Length::Driven(0), Reference::Fixed, 0.0).reversed(),
    ];
    let closure = Closure::<f64, 2, 1>::new(&terms).unwrap();
    let at_length = |value: f64| {
        let inputs = [ClosureInput {
            value,
            rate: 0.5,
            acceleration: 0.25,
        }];
        let at = closure.position(&inputs, [0.9, -0.6]).unwrap();
        let rates = closure.rates(&inputs, &at).unwrap();
        let acc = closure.accelerations(&inputs, &at, &rates).unwrap();
        (at.unknowns, rates, acc)
    };
    // The slide at time t is 5 + t / 2 + t^2 / 8, its rate 1 / 2 + t / 4; at time 0:
    let (_, rates, acc) = at_length(5.0);
    let h = 1e-4;
    let (before, ..) = at_length(5.0 - h / 2.0 + h * h / 8.0);
    let (now, ..) = at_length(5.0);
    let (after, ..) = at_length(5.0 + h / 2.0 + h * h / 8.0);
    for i in 0..2 {
        let rate = (after[i] - before[i]) / (2.0 * h);
        let acceleration = (after[i] - 2.0 * now[i] + before[i]) / (h * h);
        assert!((rates[i] - rate).abs() < 1e-8, "{} {rate}", rates[i]);
        assert!(
            (acc[i] - acceleration).abs() < 1e-6,
            "{} {acceleration}",
            acc[i]
        );
    }
}

#[test]
fn refuses_systems_that_are_not_well_formed() {
    let new = |terms: &[Term<f64>]| Closure::<f64, 2, 1>::new(terms).map(|_| ());
    let term = |length, reference| Term::<f64>::new(0, length, reference, 0.0);
    let [crank, slider, ..] = worked_example();
    assert_eq!(new(&[crank, slider]), Ok(()));
    assert_eq!(
        new(&[crank]),
        Err(ClosureError::UnusedUnknown { unknown: 0 })
    );
    let second_loop = Term::new(1, Length::Unknown(1), Reference::Fixed, 0.0);
    assert_eq!(
        new(&[slider, second_loop]),
        Err(ClosureError::NoSuchLoop {
            term: 1,
            in_loop: 1
        })
    );
    let beyond = term(Length::Constant(1.0), Reference::Unknown(2));
    assert_eq!(
        new(&[slider, beyond]),
        Err(ClosureError::NoSuchUnknown {
            term: 1,
            unknown: 2
        })
    );
    let beyond = term(Length::Driven(1), Reference::Fixed);
    assert_eq!(
        new(&[slider, beyond]),
        Err(ClosureError::NoSuchInput { term: 1, input: 1 })
    );
    let mixed = term(Length::Unknown(0), Reference::Fixed);
    assert_eq!(
        new(&[slider, mixed]),
        Err(ClosureError::MixedUnknown { unknown: 0 })
    );
    let endless = term(Length::Constant(f64::INFINITY), Reference::Fixed);
    assert_eq!(
        new(&[slider, endless]),
        Err(ClosureError::NotFinite { term: 1 })
    );
    let odd = Closure::<f64, 3, 1>::new(&[slider]).map(|_| ());
    assert_eq!(odd, Err(ClosureError::OddUnknowns { unknowns: 3 }));
}
