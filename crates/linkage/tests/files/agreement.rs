//! The files and the core's own mechanisms describe the same machines: their links move alike.

use crate::{link, point, shipped};
use nalgebra::Vector2;
use trirrr_linkage::assur::{Linkage, track};
use trirrr_linkage::mechanism::{
    fairbairn, five_bar, four_bar, inserter, quick_return, scotch_yoke, serial_arm, slider_crank,
    slotted_quick_return, two_loop,
};
use trirrr_linkage::{Drive, LinkMotion};

/// A link of the file, its motion in the core, and points of it: name and place in the core's
/// frame.
type Same<'a> = (&'a str, LinkMotion<f64>, Vec<(&'a str, [f64; 2])>);

fn agree<'a>(linkage: &Linkage, core: impl Fn(&[Drive<f64>]) -> Vec<Same<'a>>) {
    let track = track(linkage);
    assert_eq!(track.stop, None);
    for position in &track.positions {
        let drives: Vec<_> = linkage
            .drives
            .iter()
            .map(|drive| {
                let [angle, rate, acceleration] = drive.at(position.t);
                Drive {
                    angle,
                    rate,
                    acceleration,
                }
            })
            .collect();
        for (name, motion, points) in core(&drives) {
            let state = &position.states[link(linkage, name)].motion;
            let near = |a: f64, b: f64, what: &str| {
                let off = (a - b).abs();
                let bound = 2e-13 * (1.0 + b.abs());
                assert!(off <= bound, "{name} {what}: {a} for {b} at {}", position.t);
            };
            near(state.rate, motion.rate, "rate");
            near(state.acceleration, motion.acceleration, "acceleration");
            for (point_name, [x, y]) in points {
                let ours = position.point(linkage, point(linkage, name, point_name));
                let core = motion.point(Vector2::new(x, y));
                for axis in 0..2 {
                    near(ours.position[axis], core.position[axis], point_name);
                    near(ours.velocity[axis], core.velocity[axis], point_name);
                    near(ours.acceleration[axis], core.acceleration[axis], point_name);
                }
            }
        }
    }
}

#[test]
fn four_bar_with_a_coupler_point() {
    let core = four_bar::FourBar::<f64>::new(&four_bar::SHIPPED).unwrap();
    agree(&shipped("four-bar"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("crank", m.crank, vec![("A", [0.1, 0.0])]),
            (
                "coupler",
                m.coupler,
                vec![("A", [0.0; 2]), ("B", [0.35, 0.0]), ("P", [0.2, 0.12])],
            ),
            (
                "rocker",
                m.rocker,
                vec![("C", [0.0; 2]), ("B", [0.25, 0.0])],
            ),
        ]
    });
}

#[test]
fn slider_cranks() {
    let central = slider_crank::Dimensions {
        offset: 0.0,
        ..slider_crank::SHIPPED
    };
    let core = slider_crank::SliderCrank::<f64>::new(&central).unwrap();
    agree(&shipped("slider-crank"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("crank", m.crank, vec![("A", [0.1, 0.0])]),
            (
                "rod",
                m.rod,
                vec![("B", [0.0; 2]), ("A", [0.35, 0.0]), ("G", [0.2, 0.0])],
            ),
            ("slider", m.slider, vec![("B", [0.0; 2])]),
        ]
    });
    let disc = slider_crank::Dimensions {
        offset: 0.02,
        ..slider_crank::SHIPPED_DISC.dimensions().unwrap()
    };
    let core = slider_crank::SliderCrank::<f64>::new(&disc).unwrap();
    agree(&shipped("slider-crank-eccentric"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            (
                "disc",
                m.crank,
                vec![("A", [0.025, 0.0]), ("K", [0.025, 0.06])],
            ),
            ("rod", m.rod, vec![("B", [0.0; 2]), ("A", [0.2, 0.0])]),
            ("slider", m.slider, vec![("B", [0.0; 2])]),
        ]
    });
}

#[test]
fn five_bar_with_two_drives() {
    let core = five_bar::FiveBar::<f64>::new(&five_bar::SHIPPED).unwrap();
    agree(&shipped("five-bar"), |drives| {
        let m = core.at(&drives[0], &drives[1]).unwrap();
        vec![
            ("left-crank", m.left_crank, vec![("A", [0.05, 0.0])]),
            ("left-link", m.left_link, vec![("B", [0.2, 0.0])]),
            (
                "right-link",
                m.right_link,
                vec![("D", [0.0; 2]), ("B", [0.22, 0.0])],
            ),
            ("right-crank", m.right_crank, vec![("D", [0.04, 0.0])]),
        ]
    });
}

#[test]
fn quick_returns() {
    let core = quick_return::QuickReturn::<f64>::new(&quick_return::SHIPPED).unwrap();
    agree(&shipped("quick-return"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("lever", m.lever, vec![("Q", [0.0; 2]), ("E", [0.5, 0.0])]),
            ("rod", m.rod, vec![("R", [0.0; 2]), ("E", [0.3, 0.0])]),
            ("ram", m.ram, vec![("R", [0.0; 2])]),
        ]
    });
    let core = slotted_quick_return::SlottedQuickReturn::<f64>::new(&slotted_quick_return::SHIPPED);
    let core = core.unwrap();
    agree(&shipped("quick-return-slotted"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("lever", m.lever, vec![("Q", [0.0; 2])]),
            ("ram", m.ram, vec![("R", [0.0; 2]), ("S", [0.0, -0.03])]),
        ]
    });
}

#[test]
fn scotch_yoke_with_a_leaning_slot() {
    let core = scotch_yoke::ScotchYoke::<f64>::new(&scotch_yoke::SHIPPED).unwrap();
    agree(&shipped("scotch-yoke"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("crank", m.crank, vec![("A", [0.1, 0.0])]),
            ("yoke", m.yoke, vec![("Y", [0.0; 2])]),
        ]
    });
}

#[test]
fn fairbairn_and_inserter() {
    let core = fairbairn::Fairbairn::<f64>::new(&fairbairn::SHIPPED).unwrap();
    agree(&shipped("fairbairn"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("rod", m.rod, vec![("A", [0.0; 2]), ("M", [0.3, 0.0])]),
            ("bridle", m.bridle, vec![("M", [0.2, 0.0])]),
            (
                "tracing",
                m.tracing,
                vec![("T", [-0.2, 0.0]), ("N", [0.2, 0.0])],
            ),
            ("rocker", m.rocker, vec![("G", [0.0; 2]), ("N", [0.8, 0.0])]),
        ]
    });
    let core = inserter::Inserter::<f64>::new(&inserter::SHIPPED).unwrap();
    agree(&shipped("inserter"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            ("coupler", m.coupler, vec![("P", [0.15, 0.12])]),
            ("rocker", m.rocker, vec![("B", [0.14, 0.0])]),
            ("rod", m.rod, vec![("S", [0.0; 2]), ("P", [0.3, 0.0])]),
            ("pusher", m.pusher, vec![("S", [0.0; 2])]),
        ]
    });
}

#[test]
fn two_loops() {
    let core = two_loop::TwoLoop::<f64>::new(&two_loop::SHIPPED).unwrap();
    agree(&shipped("two-loop"), |drives| {
        let m = core.at(&drives[0]).unwrap();
        vec![
            (
                "coupler",
                m.coupler,
                vec![("P", [0.2, 0.0]), ("B", [0.35, 0.0])],
            ),
            ("rocker", m.rocker, vec![("B", [0.3, 0.0])]),
            ("upper", m.upper, vec![("P", [0.0; 2])]),
            ("lower", m.lower, vec![("Q", [0.0; 2])]),
        ]
    });
}

#[test]
fn serial_arm_by_relative_angles() {
    let core = serial_arm::SerialArm::<f64>::new(&serial_arm::SHIPPED).unwrap();
    agree(&shipped("serial-arm"), |drives| {
        let mut absolute = [drives[0]; 3];
        for i in 1..3 {
            let before = absolute[i - 1];
            absolute[i] = Drive {
                angle: before.angle + drives[i].angle,
                rate: before.rate + drives[i].rate,
                acceleration: before.acceleration + drives[i].acceleration,
            };
        }
        let m = core.forward(&absolute);
        vec![
            ("upper", m.upper, vec![("E", [0.4, 0.0])]),
            ("fore", m.fore, vec![("W", [0.3, 0.0])]),
            ("tool", m.tool, vec![("T", [0.1, 0.0])]),
        ]
    });
}
