//! Every shipped mechanism over a turn, in f64 and in f32.

use super::agreement::{Jet, Loops, crank, drive, slide, turn};
use core::f64::consts::{FRAC_PI_2, PI};
use core::ops::RangeInclusive;
use trirrr_core::linkage::closure::{Input, Length, Reference, Term};
use trirrr_core::linkage::mechanism::{
    fairbairn, five_bar, four_bar, inserter, quick_return, scotch_yoke, serial_arm, slider_crank,
    slotted_quick_return, two_loop,
};
use trirrr_core::linkage::{LinkMotion, PointMotion};
use trirrr_core::number::Number;

use Length::{Constant, Driven as DrivenLength, Unknown as UnknownLength};
use Reference::{Driven, Fixed, Unknown};

/// The loops' own vector: loop, length, reference, offset.
fn v(in_loop: usize, length: Length, reference: Reference, offset: f64) -> Term<f64> {
    Term::new(in_loop, length, reference, offset)
}

/// Compares in both number types; the worst ratio has to lie in the bracket of each.
fn compare_both<const U: usize, const D: usize>(
    loops: &Loops<U, D>,
    wide: (
        impl Fn(&[Input<f64>; D]) -> [Jet<f64>; U],
        RangeInclusive<f64>,
    ),
    narrow: (
        impl Fn(&[Input<f32>; D]) -> [Jet<f32>; U],
        RangeInclusive<f64>,
    ),
) {
    let name = loops.name;
    let worst = loops.compare(wide.0);
    worst.assert_within(&format!("{name}, f64"), wide.1);
    let worst = loops.compare(narrow.0);
    worst.assert_within(&format!("{name}, f32"), narrow.1);
}

/// Below 1 is the requirement; above the lower end the bound is not too wide to find a defect.
const BRACKET: RangeInclusive<f64> = 0.15..=1.0;

/// One function for both number types.
macro_rules! both {
    ($loops:expr, $closed:ident) => {
        compare_both($loops, ($closed::<f64>, BRACKET), ($closed::<f32>, BRACKET))
    };
}

#[test]
fn four_bar_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 2] {
        let linkage = four_bar::FourBar::new(&four_bar::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [turn(&at.coupler), turn(&at.rocker)]
    }
    let z = four_bar::SHIPPED;
    let loops = Loops {
        name: "four-bar",
        lengths: &[z.crank, z.coupler, z.rocker, z.ground],
        fixed_angles: &[],
        terms: &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0),
                v(0, Constant(c[2]), Unknown(1), 0.0).reversed(),
                v(0, Constant(c[3]), Fixed, 0.0).reversed(),
            ]
        },
        angles: [true, true],
        inputs: &crank,
        driven_angles: [true],
    };
    both!(&loops, closed);
}

fn slider_crank_loops(z: slider_crank::Dimensions, name: &'static str) {
    let linkage = slider_crank::SliderCrank::<f64>::new(&z).unwrap();
    let narrow = slider_crank::SliderCrank::<f32>::new(&z).unwrap();
    let loops = Loops {
        name,
        lengths: &[z.crank, z.rod, z.offset],
        fixed_angles: &[z.guide_angle],
        terms: &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, Constant(c[1]), Unknown(0), 0.0).reversed(),
                v(0, UnknownLength(1), Fixed, c[3]).reversed(),
                v(0, Constant(c[2]), Fixed, c[3] + FRAC_PI_2).reversed(),
            ]
        },
        angles: [true, false],
        inputs: &crank,
        driven_angles: [true],
    };
    compare_both(
        &loops,
        (
            |inputs: &[Input<f64>; 1]| {
                let at = linkage.at(&drive(&inputs[0])).unwrap();
                [turn(&at.rod), slide(&at.slide)]
            },
            BRACKET,
        ),
        (
            |inputs: &[Input<f32>; 1]| {
                let at = narrow.at(&drive(&inputs[0])).unwrap();
                [turn(&at.rod), slide(&at.slide)]
            },
            BRACKET,
        ),
    );
}

#[test]
fn slider_crank_linkage() {
    slider_crank_loops(slider_crank::SHIPPED, "slider-crank");
    let inclined = slider_crank::Dimensions {
        guide_angle: -0.6,
        branch: -1.0,
        ..slider_crank::SHIPPED
    };
    slider_crank_loops(inclined, "inclined slider-crank");
    let disc = slider_crank::SHIPPED_DISC.dimensions().unwrap();
    slider_crank_loops(disc, "eccentric disc");
}

#[test]
fn five_bar_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 2]) -> [Jet<N>; 2] {
        let linkage = five_bar::FiveBar::new(&five_bar::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0]), &drive(&inputs[1])).unwrap();
        [turn(&at.left_link), turn(&at.right_link)]
    }
    let z = five_bar::SHIPPED;
    let loops = Loops {
        name: "five-bar",
        lengths: &[
            z.left_crank,
            z.left_link,
            z.right_link,
            z.right_crank,
            z.ground,
        ],
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
            let second = Input {
                value: 0.4 - 2.0 * angle,
                rate: -2.6,
                acceleration: 0.9,
            };
            [first, second]
        },
        driven_angles: [true, true],
    };
    both!(&loops, closed);
}

#[test]
fn scotch_yoke_linkage() {
    fn closed<N: Number>(inputs: &[Input<N>; 1]) -> [Jet<N>; 2] {
        let linkage = scotch_yoke::ScotchYoke::new(&scotch_yoke::SHIPPED).unwrap();
        let at = linkage.at(&drive(&inputs[0])).unwrap();
        [slide(&at.slide), slide(&at.pin)]
    }
    let z = scotch_yoke::SHIPPED;
    let loops = Loops {
        name: "Scotch yoke",
        lengths: &[z.crank],
        fixed_angles: &[z.slot_angle],
        terms: &|c| {
            vec![
                v(0, Constant(c[0]), Driven(0), 0.0),
                v(0, UnknownLength(0), Fixed, 0.0).reversed(),
                v(0, UnknownLength(1), Fixed, c[1]).reversed(),
            ]
        },
        angles: [false, false],
        inputs: &crank,
        driven_angles: [true],
    };
    both!(&loops, closed);
}

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
    both!(&loops, closed);
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
    both!(&loops, closed);
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
    both!(&loops, closed);
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
    both!(&loops, closed);
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
    both!(&loops, closed);
}

/// The inverse of the arm while its tool's point runs along a line and the tool turns.
#[test]
fn serial_arm_both_branches() {
    fn closed<N: Number, const BRANCH: usize>(inputs: &[Input<N>; 3]) -> [Jet<N>; 2] {
        use trirrr_core::linkage::mechanism::serial_arm::SerialArm;
        let arm = SerialArm::<N>::new(&serial_arm::SHIPPED).unwrap();
        let [tool, x, y] = inputs;
        let both = |of: fn(&Input<N>) -> N| nalgebra::Vector2::new(of(x), of(y));
        let tip = PointMotion {
            position: both(|input| input.value),
            velocity: both(|input| input.rate),
            acceleration: both(|input| input.acceleration),
        };
        let at = arm.inverse(&tip, &drive(tool)).unwrap()[BRANCH];
        let links: [LinkMotion<N>; 2] = [at.upper, at.fore];
        [turn(&links[0]), turn(&links[1])]
    }
    let z = serial_arm::SHIPPED;
    let loops = Loops {
        name: "serial arm",
        lengths: &[z.upper, z.fore, z.tool],
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
            let along = |start: f64, rate: f64| Input {
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
    both(loops.compare(closed::<f64, 0>));
    both(loops.compare(closed::<f64, 1>));
    both(loops.compare(closed::<f32, 0>));
    both(loops.compare(closed::<f32, 1>));
}
