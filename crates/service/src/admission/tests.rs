//! The life of a judgement; what it finds is tested against dense samples in the package `tests`.

use super::*;
use crate::pace::Ramp;
use trirrr_core::limits::LimitParameters;
use trirrr_core::machine::example;
use trirrr_core::model::Dynamic;
use trirrr_protocol::message::{Bounded, LeastDuration};

fn thesis_move(ticks: u32) -> Move<f32> {
    Move {
        number: 0,
        from: Pose::from_f64(0.21, 0.22, 0.157_079_632_679_489_66),
        to: Pose::from_f64(0.28, 0.28, 0.209_439_510_239_319_53),
        start_velocity: [0.0; 3],
        end_velocity: [0.0; 3],
        ticks,
        tool_power: 0.0,
        tool_speed: 0.0,
    }
}

fn with_torque(limit_nm: f64) -> Admission<Dynamic<f32>> {
    let limits = LimitParameters {
        torque_nm: Some([limit_nm; 3]),
        ..LimitParameters::default()
    };
    let limits = Limits::build(&limits).expect("good limits");
    Admission::build(&example(), limits, Ramp::within(50, None), 0.01).expect("a good machine")
}

fn judged(admission: &mut Admission<Dynamic<f32>>, offered: &Move<f32>) -> Verdict<f32> {
    admission.offer(offered);
    // More than any search takes.
    for _ in 0..100_000 {
        if admission.step() != Verdict::Undecided {
            break;
        }
    }
    admission.verdict()
}

/// Without a limit on the motors rates and accelerations are computed all the same where they could leave the range.
#[test]
fn motors_out_of_range_are_refused_without_a_limit() {
    let limits = Limits::build(&LimitParameters::default()).expect("good limits");
    // A tick in which 50 mm ask for accelerations near the greatest that there is.
    let mut admission: Admission<Dynamic<f32>> =
        Admission::build(&example(), limits, Ramp::within(50, None), 6e-20)
            .expect("a good machine");
    let to = |dx: f64| Pose::from_f64(0.21 + dx, 0.22, 0.157_079_632_679_489_66);
    let offered = |dx| Move {
        to: to(dx),
        ..thesis_move(1)
    };
    let Verdict::Refused(violation) = judged(&mut admission, &offered(0.05)) else {
        panic!("{:?}", admission.verdict());
    };
    assert_eq!(violation.what, Bounded::Range);
    assert_eq!(judged(&mut admission, &offered(0.001)), Verdict::Admitted);
}

/// On a machine of more than 8 m of links no size is so small that it need not be looked at.
#[test]
fn no_motion_of_a_large_machine_is_moderate() {
    let moderate = |length_m: f64| {
        let mut parameters = example();
        for leg in &mut parameters.legs {
            (leg.proximal_m, leg.distal_m) = (length_m, length_m);
        }
        let limits = Limits::build(&LimitParameters::default()).expect("good limits");
        let path = Path::<Dynamic<f32>>::build(&parameters, limits, Ramp::within(50, None), 0.01);
        path.expect("a good machine").moderate
    };
    assert_eq!([1.2, 1.5].map(moderate), [1_048_576.0, 0.0]);
}

#[test]
fn a_verdict_stays_until_the_next_move_is_offered() {
    let mut admission = with_torque(0.2);
    assert_eq!(admission.step(), Verdict::Nothing);
    admission.offer(&thesis_move(100));
    assert_eq!(admission.verdict(), Verdict::Undecided);
    assert_eq!(judged(&mut admission, &thesis_move(100)), Verdict::Admitted);
    assert_eq!(admission.step(), Verdict::Admitted);
    admission.offer(&thesis_move(10));
    assert_eq!(admission.verdict(), Verdict::Undecided);
    // One that replaces another is judged from its start.
    admission.step();
    assert_eq!(judged(&mut admission, &thesis_move(100)), Verdict::Admitted);
}

#[test]
fn a_refusal_names_a_duration_that_is_admitted() {
    // The move needs 0.0297 N m at its ends.
    let mut admission = with_torque(0.015);
    let Verdict::Refused(violation) = judged(&mut admission, &thesis_move(100)) else {
        panic!("{:?}", admission.verdict());
    };
    assert_eq!(violation.what, Bounded::Torque);
    assert_eq!((violation.index, violation.at), (Some(2), 0.0));
    assert!((violation.value - 0.02975).abs() < 1e-4, "{violation:?}");
    let LeastDuration { enough, too_short } = violation.shortest.expect("slower would do");
    assert!(violation.certain && (100..enough).contains(&too_short));
    let offered = thesis_move(enough);
    assert_eq!(judged(&mut admission, &offered), Verdict::Admitted);
    let offered = thesis_move(enough - 1);
    assert!(matches!(
        judged(&mut admission, &offered),
        Verdict::Refused(_)
    ));
}
