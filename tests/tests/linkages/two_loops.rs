//! Every shipped mechanism of two loops over a turn, in f64 and in f32.

use super::agreement::{Jet, Loops, compare_both, drive, slide, turn, v};
use super::compositions;
use core::f64::consts::{FRAC_PI_2, PI};
use trirrr_core::number::Number;
use trirrr_linkage::closure::ClosureInput;
use trirrr_linkage::closure::Length::{Constant, Unknown as UnknownLength};
use trirrr_linkage::closure::Reference::{Driven, Fixed, Unknown};

#[test]
fn quick_return_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 4] {
        let ([_, lever, rod, _], [pin, stroke]) =
            compositions::quick_return(&drive(&inputs[0])).unwrap();
        [turn(&lever), slide(&pin), turn(&rod), slide(&stroke)]
    }
    let loops = Loops::with_crank(
        "quick return",
        &[0.1, 0.25, 0.5, 0.3, 0.23],
        &[],
        [true, false, true, false],
        &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Fixed, FRAC_PI_2),
                v(0, UnknownLength(1), Unknown(0), 0.0).reversed(),
                v(1, Constant(c[2]), Unknown(0), 0.0),
                v(1, Constant(c[1]), Fixed, FRAC_PI_2).reversed(),
                v(1, Constant(c[3]), Unknown(2), 0.0).reversed(),
                v(1, UnknownLength(3), Fixed, 0.0).reversed(),
                v(1, Constant(c[4]), Fixed, FRAC_PI_2).reversed(),
            ]
        },
    );
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn slotted_quick_return_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 4] {
        let ([_, lever, _], [pin, block, stroke]) =
            compositions::slotted_quick_return(&drive(&inputs[0])).unwrap();
        [turn(&lever), slide(&pin), slide(&block), slide(&stroke)]
    }
    let loops = Loops::with_crank(
        "slotted quick return",
        &[0.1, 0.25, 0.2, 0.03],
        &[],
        [true, false, false, false],
        &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Fixed, FRAC_PI_2),
                v(0, UnknownLength(1), Unknown(0), 0.0).reversed(),
                v(1, UnknownLength(2), Unknown(0), 0.0),
                v(1, Constant(c[1]), Fixed, FRAC_PI_2).reversed(),
                v(1, UnknownLength(3), Fixed, 0.0).reversed(),
                v(1, Constant(c[2]), Fixed, FRAC_PI_2).reversed(),
                v(1, Constant(c[3]), Fixed, FRAC_PI_2).reversed(),
            ]
        },
    );
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn fairbairn_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 4] {
        let ([_, links @ ..], []) = compositions::fairbairn(&drive(&inputs[0])).unwrap();
        links.map(|link| turn(&link))
    }
    let loops = Loops::with_crank(
        "modified Fairbairn guide",
        &[0.05, 0.3, 0.2, 0.8, 0.33, -0.13, 0.32, -0.8],
        &[],
        [true; 4],
        &|c| {
            vec![
                v(0, Constant(c[4]), Fixed, 0.0),
                v(0, Constant(c[5]), Fixed, FRAC_PI_2),
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0),
                v(0, Constant(c[2]), Unknown(1), 0.0).reversed(),
                v(1, Constant(c[2]), Unknown(1), 0.0),
                v(1, Constant(c[2]), Unknown(2), 0.0),
                v(1, Constant(c[3]), Unknown(3), 0.0).reversed(),
                v(1, Constant(c[6]), Fixed, 0.0).reversed(),
                v(1, Constant(c[7]), Fixed, FRAC_PI_2).reversed(),
            ]
        },
    );
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn inserter_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 4] {
        let ([_, coupler, rocker, rod, _], [stroke]) =
            compositions::inserter(&drive(&inputs[0])).unwrap();
        [turn(&coupler), turn(&rocker), turn(&rod), slide(&stroke)]
    }
    let loops = Loops::with_crank(
        "inserter",
        &[0.06, 0.2, 0.14, 0.22, 0.15, 0.12, 0.3, 0.2],
        &[],
        [true, true, true, false],
        &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0),
                v(0, Constant(c[2]), Unknown(1), 0.0).reversed(),
                v(0, Constant(c[3]), Fixed, 0.0).reversed(),
                v(1, Constant(c[0]), Driven(0), 0.0),
                v(1, Constant(c[4]), Unknown(0), 0.0),
                v(1, Constant(c[5]), Unknown(0), FRAC_PI_2),
                v(1, Constant(c[6]), Unknown(2), 0.0).reversed(),
                v(1, UnknownLength(3), Fixed, 0.0).reversed(),
                v(1, Constant(c[7]), Fixed, FRAC_PI_2).reversed(),
            ]
        },
    );
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn two_loop_linkage() {
    fn closed<N: Number>(inputs: &[ClosureInput<N>; 1]) -> [Jet<N>; 4] {
        let ([_, coupler, rocker, upper, _], [telescope]) =
            compositions::two_loop(&drive(&inputs[0])).unwrap();
        [
            turn(&coupler),
            turn(&rocker),
            turn(&upper),
            slide(&telescope),
        ]
    }
    let arms = [80f64.to_radians(), 100f64.to_radians()];
    // The rocker's angle is counted from D, against z4; unknown 2 is phi6 + chi.
    let loops = Loops::with_crank(
        "two-loop linkage",
        &[0.1, 0.2, 0.15, 0.3, 0.4, 0.05, 0.08, 0.25],
        &arms,
        [true, true, true, false],
        &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0),
                v(0, Constant(c[2]), Unknown(0), 0.0),
                v(0, Constant(c[3]), Unknown(1), 0.0).reversed(),
                v(0, Constant(c[4]), Fixed, 0.0).reversed(),
                v(1, Constant(c[5]), Unknown(2), -c[8]),
                v(1, UnknownLength(3), Unknown(2), PI),
                v(1, Constant(c[6]), Unknown(2), PI - c[9]),
                v(1, Constant(c[7]), Fixed, 0.0).reversed(),
                v(1, Constant(c[3]), Unknown(1), 0.0),
                v(1, Constant(c[2]), Unknown(0), 0.0).reversed(),
            ]
        },
    );
    compare_both(&loops, closed::<f64>, closed::<f32>);
}
