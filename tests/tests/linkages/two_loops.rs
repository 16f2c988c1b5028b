//! Every shipped mechanism of two loops over a turn, in f64 and in f32.

use super::agreement::{Jet, Loops, compare_both, crank, drive, slide, turn, v};
use core::f64::consts::{FRAC_PI_2, PI};
use trirrr_core::number::Number;
use trirrr_linkage::closure::Input;
use trirrr_linkage::closure::Length::{Constant, Unknown as UnknownLength};
use trirrr_linkage::closure::Reference::{Driven, Fixed, Unknown};
use trirrr_linkage::mechanism::{
    fairbairn, inserter, quick_return, slotted_quick_return, two_loop,
};

#[test]
fn quick_return_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 4] {
        let linkage = quick_return::QuickReturn::new(&quick_return::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [
            turn(&at.lever),
            slide(&at.pin),
            turn(&at.rod),
            slide(&at.stroke),
        ]
    }
    let z = quick_return::SHIPPED;
    let loops = Loops {
        name: "quick return",
        lengths: &[z.crank, z.pivot_depth, z.lever, z.rod, z.guide_height],
        fixed_angles: &[],
        terms: &|c| {
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
        angles: [true, false, true, false],
        inputs: &crank,
        driven_angles: [true],
    };
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn slotted_quick_return_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 4] {
        let dimensions = slotted_quick_return::SHIPPED;
        let linkage = slotted_quick_return::SlottedQuickReturn::new(&dimensions).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [
            turn(&at.lever),
            slide(&at.pin),
            slide(&at.block),
            slide(&at.stroke),
        ]
    }
    let z = slotted_quick_return::SHIPPED;
    let loops = Loops {
        name: "slotted quick return",
        lengths: &[z.crank, z.pivot_depth, z.guide_height, z.joint_height],
        fixed_angles: &[],
        terms: &|c| {
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
        angles: [true, false, false, false],
        inputs: &crank,
        driven_angles: [true],
    };
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn fairbairn_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 4] {
        let linkage = fairbairn::Fairbairn::new(&fairbairn::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [
            turn(&at.rod),
            turn(&at.bridle),
            turn(&at.tracing),
            turn(&at.rocker),
        ]
    }
    let z = fairbairn::SHIPPED;
    let loops = Loops {
        name: "modified Fairbairn guide",
        lengths: &[
            z.crank, z.rod, z.bridle, z.rocker, z.centre.x, z.centre.y, z.pivot.x, z.pivot.y,
        ],
        fixed_angles: &[],
        terms: &|c| {
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
        angles: [true; 4],
        inputs: &crank,
        driven_angles: [true],
    };
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn inserter_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 4] {
        let linkage = inserter::Inserter::new(&inserter::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [
            turn(&at.coupler),
            turn(&at.rocker),
            turn(&at.rod),
            slide(&at.stroke),
        ]
    }
    let z = inserter::SHIPPED;
    let loops = Loops {
        name: "inserter",
        lengths: &[
            z.crank,
            z.coupler,
            z.rocker,
            z.pivot.x,
            z.coupler_point.x,
            z.coupler_point.y,
            z.rod,
            z.guide_height,
        ],
        fixed_angles: &[],
        terms: &|c| {
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
        angles: [true, true, true, false],
        inputs: &crank,
        driven_angles: [true],
    };
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

#[test]
fn two_loop_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 4] {
        let linkage = two_loop::TwoLoop::new(&two_loop::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [
            turn(&at.coupler),
            turn(&at.rocker),
            turn(&at.upper),
            slide(&at.slide),
        ]
    }
    let z = two_loop::SHIPPED;
    let loops = Loops {
        name: "two-loop linkage",
        lengths: &[z.z1, z.z2, z.z3, z.z4, z.z5, z.z6, z.z8, z.z9],
        fixed_angles: &[z.chi, z.beta],
        // The rocker's angle is counted from D, against z4; unknown 2 is phi6 + chi.
        terms: &|c| {
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
        angles: [true, true, true, false],
        inputs: &crank,
        driven_angles: [true],
    };
    compare_both(&loops, closed::<f64>, closed::<f32>);
}
