//! Every shipped mechanism of one loop over a turn, in f64 and in f32.

use super::agreement::{BRACKET, Jet, Loops, compare_both, crank, drive, slide, turn, v};
use super::compositions;
use core::f64::consts::FRAC_PI_2;
use trirrr_core::number::Number;
use trirrr_linkage::PointMotion;
use trirrr_linkage::closure::ClosureInput;
use trirrr_linkage::closure::Length::{Constant, Driven as DrivenLength, Unknown as UnknownLength};
use trirrr_linkage::closure::Reference::{Driven, Fixed, Unknown};

#[test]
fn four_bar_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 2] {
        let ([_, coupler, rocker], []) = compositions::four_bar(&drive(&inputs[0])).unwrap();
        [turn(&coupler), turn(&rocker)]
    }
    let loops = Loops::with_crank(
        "four-bar",
        &[0.1, 0.35, 0.25, 0.4],
        &[],
        [true, true],
        &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0),
                v(0, Constant(c[2]), Unknown(1), 0.0).reversed(),
                v(0, Constant(c[3]), Fixed, 0.0).reversed(),
            ]
        },
    );
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

fn slider_crank_loops(name: &'static str, lengths: [f64; 3], guide_angle: f64, branch: f64) {
    fn closed<N: Number>(
        lengths: [f64; 3],
        guide_angle: f64,
        branch: f64,
    ) -> impl Fn(&[ClosureInput<N>; 1]) -> [Jet<N>; 2] {
        move |inputs| {
            let drive = drive(&inputs[0]);
            let at = compositions::slider_crank(lengths, guide_angle, branch, &drive);
            let ([_, rod, _], [stroke]) = at.unwrap();
            [turn(&rod), slide(&stroke)]
        }
    }
    let angles = [guide_angle];
    let loops = Loops::with_crank(name, &lengths, &angles, [true, false], &|c| {
        vec![
            v(0, Constant(c[0]), Driven(0), 0.0),
            v(0, Constant(c[1]), Unknown(0), 0.0).reversed(),
            v(0, UnknownLength(1), Fixed, c[3]).reversed(),
            v(0, Constant(c[2]), Fixed, c[3] + FRAC_PI_2).reversed(),
        ]
    });
    compare_both(
        &loops,
        closed::<f64>(lengths, guide_angle, branch),
        closed::<f32>(lengths, guide_angle, branch),
    );
}

#[test]
fn slider_crank_linkage() {
    slider_crank_loops("slider-crank", [0.1, 0.35, 0.05], 0.0, 1.0);
    slider_crank_loops("inclined slider-crank", [0.1, 0.35, 0.05], -0.6, -1.0);
    // A disc of 60 mm radius, 25 mm off centre, and 140 mm from its rim to the pin.
    slider_crank_loops("eccentric disc", [0.025, 0.06 + 0.14, 0.0], 0.0, 1.0);
}

#[test]
fn five_bar_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 2]) -> [Jet<N>; 2] {
        let drives = [drive(&inputs[0]), drive(&inputs[1])];
        let ([_, left, right, _], []) = compositions::five_bar(&drives).unwrap();
        [turn(&left), turn(&right)]
    }
    let loops = Loops {
        name: "five-bar",
        lengths: &[0.05, 0.2, 0.22, 0.04, 0.15],
        fixed_angles: &[],
        terms: &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0),
                v(0, Constant(c[2]), Unknown(1), 0.0).reversed(),
                v(0, Constant(c[3]), Driven(1), 0.0).reversed(),
                v(0, Constant(c[4]), Fixed, 0.0).reversed(),
            ]
        },
        angles: [true, true],
        // The second crank turns twice, backwards, while the first turns once.
        inputs: &|angle| {
            let [first] = crank(angle);
            let second = ClosureInput {
                value: 0.4 - 2.0 * angle,
                rate: -2.6,
                acceleration: 0.9,
            };
            [first, second]
        },
        driven_angles: [true, true],
    };
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn scotch_yoke_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 2] {
        let (_, [yoke, pin]) = compositions::scotch_yoke(&drive(&inputs[0])).unwrap();
        [slide(&yoke), slide(&pin)]
    }
    let slot = [80f64.to_radians()];
    let loops = Loops::with_crank("Scotch yoke", &[0.1], &slot, [false, false], &|c| {
        vec![
            v(0, Constant(c[0]), Driven(0), 0.0),
            v(0, UnknownLength(0), Fixed, 0.0).reversed(),
            v(0, UnknownLength(1), Fixed, c[1]).reversed(),
        ]
    });
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

/// The inverse of the arm while its tool's point runs along a line and the tool turns.
#[test]
fn serial_arm_both_branches() {
    fn closed<N: Number, const LEFT: bool>(inputs: &[ClosureInput<N>; 3]) -> [Jet<N>; 2] {
        let [tool, x, y] = inputs;
        let both = |of: fn(&ClosureInput<N>) -> N| nalgebra::Vector2::new(of(x), of(y));
        let tip = PointMotion {
            position: both(|input| input.value),
            velocity: both(|input| input.rate),
            acceleration: both(|input| input.acceleration),
        };
        let branch = if LEFT { 1.0 } else { -1.0 };
        let arm = compositions::serial_arm_inverse(tip, &drive(tool), branch);
        let ([upper, fore], []) = arm.unwrap();
        [turn(&upper), turn(&fore)]
    }
    let loops = Loops {
        name: "serial arm",
        lengths: &[0.4, 0.3, 0.1],
        fixed_angles: &[],
        terms: &|c| {
            vec![
                v(0, Constant(c[0]), Unknown(0), 0.0),
                v(0, Constant(c[1]), Unknown(1), 0.0),
                v(0, Constant(c[2]), Driven(0), 0.0),
                v(0, DrivenLength(1), Fixed, 0.0).reversed(),
                v(0, DrivenLength(2), Fixed, FRAC_PI_2).reversed(),
            ]
        },
        angles: [true, true],
        inputs: &|angle| {
            let along = |start: f64, rate: f64| ClosureInput {
                value: start + rate * (angle / 6.0),
                rate,
                acceleration: 0.3 * rate,
            };
            let [tool] = crank(angle);
            [tool, along(0.35, -0.2), along(0.2, 0.25)]
        },
        driven_angles: [true, false, false],
    };
    let both = |worst: trirrr_tests::bound::Worst| worst.assert_within("serial arm", BRACKET);
    both(loops.compare(closed::<f64, true>));
    both(loops.compare(closed::<f64, false>));
    both(loops.compare(closed::<f32, true>));
    both(loops.compare(closed::<f32, false>));
}
