//! The thesis machine and move against limits set a little above and below what it needs.

use super::*;
use crate::limits::LimitParameters;
use crate::machine::example;
use crate::message::Bounded;
use std::vec::Vec;

const TICKS: u32 = 100;
const PERIOD_S: f64 = 0.01;
const RAMP_TICKS: u16 = 10;

fn thesis_move<N: Number>(ticks: u32) -> Move<N> {
    Move {
        number: 0,
        from: Pose::from_f64(0.21, 0.22, 0.157_079_632_679_489_66),
        to: Pose::from_f64(0.28, 0.28, 0.209_439_510_239_319_53),
        start_velocity: [N::ZERO; 3],
        end_velocity: [N::ZERO; 3],
        ticks,
        tool_power: N::ZERO,
        tool_speed: N::ZERO,
    }
}

fn judge<N: Number>(limits: &LimitParameters, offered: &Move<N>) -> (Verdict<N>, u32) {
    let limits = Limits::build(limits).expect("good limits");
    let mut admission =
        Admission::<N>::build(&example(), limits, RAMP_TICKS, PERIOD_S).expect("a good machine");
    admission.offer(offered);
    let mut steps = 0;
    loop {
        steps += 1;
        match admission.step() {
            Verdict::Undecided => {}
            verdict => return (verdict, steps),
        }
    }
}

fn refusal<N: Number>(limits: &LimitParameters, offered: &Move<N>) -> Violation<N> {
    match judge(limits, offered).0 {
        Verdict::Refused(violation) => violation,
        other => panic!("{other:?}"),
    }
}

#[test]
fn the_thesis_move_is_admitted() {
    let (verdict, steps) = judge::<f64>(&LimitParameters::default(), &thesis_move(TICKS));
    std::println!("{verdict:?} in {steps}");
    assert_eq!(verdict, Verdict::Admitted);
    let limits = LimitParameters {
        torque_nm: Some([0.005; 3]),
        ..LimitParameters::default()
    };
    let violation = refusal::<f64>(&limits, &thesis_move(TICKS));
    std::println!("{violation:?}");
    assert_eq!(violation.what, Bounded::Torque);
    let violation = refusal::<f32>(&limits, &thesis_move(TICKS));
    std::println!("{violation:?}");
    let shortest: Vec<_> = [violation.shortest.expect("a duration")]
        .into_iter()
        .collect();
    assert_eq!(
        judge::<f32>(&limits, &thesis_move(shortest[0])).0,
        Verdict::Admitted
    );
}
