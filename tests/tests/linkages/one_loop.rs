//! Every shipped mechanism of one loop over a turn, in f64 and in f32.

use super::agreement::{BRACKET, Jet, Loops, compare_both, crank, drive, slide, turn, v};
use core::f64::consts::FRAC_PI_2;
use trirrr_core::number::Number;
use trirrr_linkage::closure::Input;
use trirrr_linkage::closure::Length::{Constant, Driven as DrivenLength, Unknown as UnknownLength};
use trirrr_linkage::closure::Reference::{Driven, Fixed, Unknown};
use trirrr_linkage::mechanism::{five_bar, four_bar, scotch_yoke, serial_arm, slider_crank};
use trirrr_linkage::{LinkMotion, PointMotion};

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
    compare_both(&loops, closed::<f64>, closed::<f32>);
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
        |inputs| {
            let at = linkage.at(&drive(&inputs[0])).unwrap();
            [turn(&at.rod), slide(&at.slide)]
        },
        |inputs| {
            let at = narrow.at(&drive(&inputs[0])).unwrap();
            [turn(&at.rod), slide(&at.slide)]
        },
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
    compare_both(&loops, closed::<f64>, closed::<f32>);
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
    compare_both(&loops, closed::<f64>, closed::<f32>);
}

/// The inverse of the arm while its tool's point runs along a line and the tool turns.
#[test]
fn serial_arm_both_branches() {
    fn closed<N: Number, const BRANCH: usize>(inputs: &[Input<N>; 3]) -> [Jet<N>; 2] {
        use trirrr_linkage::mechanism::serial_arm::SerialArm;
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
